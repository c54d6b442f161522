"""docs/results.md: every dataset and attribute of results.h5 and of the files for ParaView, from their declarations."""

from __future__ import annotations

from collections.abc import Mapping

from dem_cli.results.output.layout import GROUPS, WORDS, Described
from dem_cli.results.output.paraview.described_fields import STEP_FIELDS, VTK_FILES
from studies.template import table as markdown

INTRODUCTION = """# Results: every dataset of the files

What a run leaves and what it is for: [read the answer](guide/answer.md). This page is the layout of the binary files,
for those who read them with other programs; from Python, [`dem_cli.open`](python.md) gives the same by name.

Every dataset of `results.h5` (HDF5) explains itself by attributes: `meaning`, `units` (SI; `1` for pure numbers and
numbers of things), `columns`, the names along its last axis, and `DIMENSION_LABELS`, what each axis counts. Blocks,
joints, parts and materials are numbered from 0. In 2D x points to the right, y upwards, and angles are
counter-clockwise; in 3D x and y are horizontal, z points upwards, and what is another thing there stands behind “3D:”.

```python
import h5py

with h5py.File("results/wall_21/results.h5") as file:
    stress = file["dem/joints/normal_stress"]
    print(stress.attrs["meaning"], stress.attrs["units"], stress.shape)
```

Datasets may be added in any version; `format` goes up when one is taken away ([versions](versions.md)).

Made from the program's own declarations by `scripts/docs --write`; do not edit."""
PARAVIEW = """## For ParaView and pyvista

Three files in the VTKHDF format, which ParaView 5.12 and newer and pyvista open by name, one step per frame: seconds
in a time history, else the number of the frame. Values are float32 or whole numbers; `meaning` and `units` stand at
each field. `/VTKHDF` of `results.h5` is a link to that of `blocks.vtkhdf`. For older ParaView `dem export DIR --pvd`.
In 3D blocks are solid cells, which a clip cuts and filters measure: hexahedra, wedges, tetrahedra, pyramids and prisms
of five and six sides as such, other shapes as convex point sets, whose faces ParaView shows in triangles.

```python
import pyvista

reader = pyvista.get_reader("results/wall_21/joints.vtkhdf")
reader.reader.UpdateInformation()
reader.reader.SetStep(reader.reader.GetNumberOfSteps() - 1)  # the last frame; without this the first one
reader.read().plot(scalars="crack_width", line_width=5)
```"""
HEAD, FIELD_HEAD = ("dataset", "axes", "columns", "units", "meaning"), ("field", "units", "meaning")


def text() -> str:
    """The whole page."""
    parts = [INTRODUCTION]
    for path, group in GROUPS.items():
        parts += [f"## `{path}`", f"{group.about[0].upper()}{group.about[1:]}."]
        if group.attributes:
            parts.append(markdown(("attribute", "meaning"), [(f"`{n}`", m) for n, m in group.attributes.items()]))
        if group.datasets:
            parts.append(markdown(HEAD, [row(name, said) for name, said in group.datasets.items()]))
    parts.append(PARAVIEW)
    for name, (about, fields) in VTK_FILES.items():
        parts += [f"### `{name}`", f"{about[0].upper()}{about[1:]}.", _fields(fields)]
    parts += ["### Fields of all three", _fields(STEP_FIELDS)]
    return "\n\n".join(parts) + "\n"


def row(name: str, said: Described) -> tuple[str, ...]:
    """A line of the table of a group."""
    plane, space = _cells(said), _cells(said.of(3))
    axes, columns, unit, meaning = (_both(*pair) for pair in zip(plane, space, strict=True))
    return (f"`{name}`", axes, columns, unit, _alone(said, meaning))


def _cells(said: Described) -> tuple[str, ...]:
    return (" × ".join(said.axes), ", ".join(said.columns), units(said), said.meaning.replace("|", "\\|"))


def _both(plane: str, space: str) -> str:
    """What differs in space stands behind what holds in the plane."""
    return plane if plane == space else f"{plane}; 3D: {space}"


def units(said: Described) -> str:
    """Units of a dataset, once or of each column."""
    if said.units == WORDS and isinstance(said.units, str):
        return "text"
    return said.units if isinstance(said.units, str) else ", ".join(said.units) or "of each"


def _fields(fields: Mapping[str, Described]) -> str:
    return markdown(
        FIELD_HEAD,
        [
            (f"`{name}`", _both(units(said), units(said.of(3))), _alone(said, _both(said.meaning, said.of(3).meaning)))
            for name, said in fields.items()
        ],
    )


def _alone(said: Described, meaning: str) -> str:
    """The meaning of what is there in space alone says so."""
    return f"3D: {meaning}" if said.spatial else meaning
