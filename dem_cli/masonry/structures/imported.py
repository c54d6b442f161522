"""Import structures of other programs: meshes (STL, OBJ, PLY, compas JSON), drawings (DXF, SVG), a block per solid."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from difflib import get_close_matches
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field, ValidationInfo, field_validator, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, NonNegative, Positive, StructureBase
from dem_cli.case.named_file import absolute_path, is_file, missing_file
from dem_cli.core.arithmetic.products import norm
from dem_cli.core.model.blocks import Block
from dem_cli.masonry.imports.contents import UNITS, Contents, FileBody, FileProblem, unit_of
from dem_cli.masonry.imports.formats import FORMATS, format_of, read
from dem_cli.masonry.structures.patterns.drawn_once import drawn_once

SHOWN = 6  # names in a message


class Layer(CaseModel):
    """structure.layers.NAME: what becomes of a layer of a drawing, or of what a mesh calls its material."""

    material: str = Field("", description="a name in [materials]; default: that of the structure", examples=["stone"])
    fixed: bool = Field(False, description="its blocks cannot move (base, support)", examples=[True])
    thickness: Positive | None = Field(
        None, description="depth out of plane [m]; default: that of the structure", examples=[0.3]
    )
    skip: bool = Field(False, description="it is left out", examples=[True])


PLAIN = Layer.model_validate({})


class Import(StructureBase):
    """Blocks from a file of another program. Local origin: that of the file; a drawing lies in the plane of the case,
    in 3D it stands upright, with half of the thickness to either side.

    Block names: "<id>-<name in the file>", "<id>-<name>-<number>" where several have that name, "<id>-<number>" where
    they have none; outlines without a name are called as their layer. Names in the file that all begin with "<id>-"
    are taken as they are.
    """

    kind: Literal["import"] = "import"
    file: Annotated[str, Field(min_length=1)] = Field(
        description="STL, OBJ, PLY or compas JSON (solids, 3D), DXF or SVG (closed outlines); relative paths start at "
        "the case file",
        examples=["facade.dxf"],
    )
    unit: Literal["m", "dm", "cm", "mm", "in", "ft"] | None = Field(
        None, description="of lengths in the file; default: what the file says (DXF), else m", examples=["mm"]
    )
    scale: Positive = Field(1.0, description="factor on all lengths, beside unit [-]", examples=[0.5])
    up: Literal["z", "y"] = Field("z", description="axis of the file that is the vertical; many programs have y")
    fixed: tuple[str, ...] = Field(
        (),
        description="blocks that cannot move: names in the file or of blocks, or patterns such as 'ground*'",
        examples=[["ground*"]],
    )
    fixed_below: float | None = Field(
        None,
        description="blocks that lie wholly at or below this level of the file, in metres, cannot move [m]",
        examples=[0.0],
    )
    layers: dict[str, Layer] = Field(
        {},
        description="by names in the file: layers (DXF), groups (SVG) or materials (OBJ, compas); default: all alike",
        examples=[{"stone": {"material": "stone"}, "ground": {"fixed": True}}],
    )
    materials: Literal["structure", "file"] = Field(
        "structure",
        description="file: blocks are of the material that is called as their layer or material in the file",
        examples=["file"],
    )
    names: Literal["file", "numbers"] = Field(
        "file", description="of blocks: those in the file, or numbers in its order", examples=["numbers"]
    )
    shells: Literal["blocks", "parts"] | None = Field(
        None,
        description="what several solids of one name are: blocks, or convex parts of one block; default: parts where "
        "`dem build` wrote them as such (OBJ, compas JSON), else blocks",
        examples=["parts"],
    )
    concave: Literal["refuse", "decompose"] = Field(
        "refuse", description="decompose: what is not convex becomes convex parts, exactly, that move as one"
    )
    snap: NonNegative | None = Field(
        None,
        description="faces of neighbours so far from one plane are put onto one [m]; 0: nothing is moved; default: "
        "1e-6 of the size of it all, what files round off",
        examples=[0.001],
    )
    chords: Annotated[int, Field(ge=1, le=100)] | None = Field(
        None, description="straight pieces of each curve of a drawing; default: curves are refused", examples=[1]
    )
    thickness: Positive | None = Field(
        None, description="depth of what a drawing shows out of its plane [m]; default: 1", examples=[0.4]
    )

    @field_validator("file")
    @classmethod
    def _absolute(cls, file: str, info: ValidationInfo) -> str:
        return absolute_path(file, info)

    @model_validator(mode="after")
    def _readable(self, info: ValidationInfo) -> Import:
        found = format_of(self.file)
        if found is None:
            suffix = Path(self.file).suffix or Path(self.file).name
            raise KeyProblem(f"'{suffix}' is not read; the file ends in one of {', '.join(FORMATS)}", "file")
        if not is_file(Path(self.file)):
            raise KeyProblem(missing_file(Path(self.file), "a drawing or mesh"), "file")
        suffix = Path(self.file).suffix.lower()
        if not found.flat and (info.context or {}).get("dimension") == 2:
            raise KeyProblem(f"{suffix} files hold solids; give dimension = 3", "file")
        for key in ("chords", "thickness") if not found.flat else ("up",):
            if key in self.model_fields_set:
                holds = "outlines in a plane" if found.flat else "solids"
                raise KeyProblem(f"not used with {suffix}, which holds {holds}", key)
        for name, layer in self.layers.items():
            if layer.thickness is not None and not found.flat:
                raise KeyProblem(f"not used with {suffix}, which holds solids", "layers", name, "thickness")
        return self


class ImportedStructure(NamedTuple):
    """Imported blocks of a file, with notes on how they were read."""

    blocks: list[Block]
    notes: list[str]
    divided: dict[str, int]  # names of several solids for which `shells` is not given, and how many


def build(table: Import) -> list[Block]:
    """Import the blocks of a file in local coordinates, in its order."""
    return imported(table).blocks


def unsaid(table: Import) -> list[tuple[str, str]]:
    """Report the unset key `shells` where names of the file have several solids each."""
    found = imported(table).divided
    if not found:
        return []
    name, count = next(iter(found.items()))
    more = f" (so do {len(found) - 1} more names)" if len(found) > 1 else ""
    message = f"'{name}' has {count} solids{more}: they are blocks of their own; shells = 'parts' makes one block of "
    return [("shells", message + "those of a name, shells = 'blocks' says that they are meant")]


@drawn_once
def imported(table: Import) -> ImportedStructure:
    """Import the blocks of a file in local coordinates, in its order, with notes. Raises KeyProblem."""
    from dem_cli.masonry.imports.solids import solids_of

    try:
        skipped = {name for name, layer in table.layers.items() if layer.skip}
        contents = _kept(table, read(table.file, table.chords, skip=skipped), skipped)
        factor = table.scale * UNITS[unit_of(contents, table.unit)]
        solids, notes = solids_of(_named(contents.bodies), factor, table)
    except FileProblem as error:
        raise KeyProblem(f"{Path(table.file).name}: {error}", "file") from None
    blocks = _blocks(table, solids)
    notes = [_counts(table, contents, blocks), *notes]
    notes += [f"left out: {', '.join(contents.left_out)}"] if contents.left_out else []
    notes += [f"the file says {name or 'a material'}: {rho:g} kg/m3" for name, rho in contents.densities.items()]
    return ImportedStructure(blocks, notes, _divided(table, solids))


def _named(bodies: Sequence[FileBody]) -> list[FileBody]:
    """Name unnamed outlines after their layer."""
    return [body if body.name or body.faces else body._replace(name=body.layer) for body in bodies]


def _kept(table: Import, contents: Contents, skipped: set[str]) -> Contents:
    """Remove the skipped layers. Raises KeyProblem for unknown layers, and for those the case does not mention."""
    if not table.layers:
        return contents
    found = Counter(body.layer for body in contents.bodies)
    unread = skipped & set(contents.layers)  # a drawing is read without them
    for name in table.layers:
        if name not in found and name not in unread:
            close = get_close_matches(name, [layer for layer in found if layer], 1)
            hint = f", did you mean '{close[0]}'?" if close else f" (it has: {_listed(found)})"
            raise KeyProblem(f"no blocks on '{name}' in the file{hint}", "layers", name)
    untold = [layer for layer in found if layer not in table.layers]
    if untold:
        what = f"'{untold[0]}'" if untold[0] else "no layer"
        raise KeyProblem(
            f"nothing is said of {found[untold[0]]} blocks on {what}; name it here, or with skip = true", "layers"
        )
    words = [f"{found[name]} blocks on '{name}'" for name in table.layers if name in skipped - unread]
    bodies = [body for body in contents.bodies if body.layer not in skipped]
    if not bodies:
        raise KeyProblem("every layer is skipped", "layers")
    return contents._replace(bodies=bodies, left_out=[*contents.left_out, *words])


def _blocks(table: Import, solids: Sequence[Any]) -> list[Block]:
    names = local_names(table, [solid.name for solid in solids])
    fixed = _fixed(table, solids, names)
    groups: dict[str, list[int]] = {}
    for k, solid in enumerate(solids):
        together = table.shells == "parts" or (table.shells is None and solid.compound)
        groups.setdefault(solid.name if together and solid.name else f"\0{k}", []).append(k)
    chosen = list(groups.values())
    names = local_names(table, [solids[own[0]].name for own in chosen])
    blocks = []
    for name, own in zip(names, chosen, strict=True):
        layer = table.layers.get(solids[own[0]].layer, PLAIN)
        material = layer.material or (solids[own[0]].layer if table.materials == "file" else "")
        thickness = layer.thickness or table.thickness or 1.0
        parts = tuple(part for k in own for part in solids[k].parts)
        blocks.append(Block(name, parts, material, thickness, fixed=any(fixed[k] for k in own)))
    return blocks


def _divided(table: Import, solids: Sequence[Any]) -> dict[str, int]:
    """Count the solids of names that have several blocks; layers, and one name for all, do not count."""
    found = format_of(table.file)
    drawing = found is not None and found.flat
    named = [solid for solid in solids if not solid.compound and not (drawing and solid.name == solid.layer)]
    counts = Counter(solid.name for solid in named)
    if table.shells is not None or (len(counts) == 1 and not any(solid.compound for solid in solids)):
        return {}
    return {name: count for name, count in counts.items() if name and count > 1}


def local_names(table: Import, given: Sequence[str]) -> list[str]:
    """Return unique names of blocks without the id of the structure."""
    if table.names == "numbers" or not any(given):
        return [str(k + 1) for k in range(len(given))]
    prefix = f"{table.id}-"
    if table.id and all(name.startswith(prefix) and len(name) > len(prefix) for name in given):
        given = [name.removeprefix(prefix) for name in given]
    given = ["-".join(name.split()) for name in given]
    counts, seen, taken = Counter(given), Counter[str](), set(given)
    found = []
    for name in given:
        if counts[name] == 1 and name:
            found.append(name)
            continue
        while True:
            seen[name] += 1
            numbered = f"{name}-{seen[name]}" if name else str(seen[name])
            if numbered not in taken:
                break
        found.append(numbered)
    return found


def _fixed(table: Import, solids: Sequence[Any], names: Sequence[str]) -> list[bool]:
    """Determine which solids are fixed: by the file, their layer, a name or pattern, or their level."""
    found = [
        solid.fixed or table.layers.get(solid.layer, PLAIN).fixed or _below(table, solid.parts) for solid in solids
    ]
    for i, pattern in enumerate(table.fixed):
        plain = pattern.replace("[", "[[]")  # * and ? alone stand for letters
        hit = [
            k
            for k, (solid, name) in enumerate(zip(solids, names, strict=True))
            if any(fnmatchcase(one, plain) for one in (solid.name, name, f"{table.id}-{name}"))
        ]
        if not hit:
            close = get_close_matches(pattern, names, 1)
            hint = f", did you mean '{close[0]}'?" if close else f" (blocks: {_listed(names)})"
            raise KeyProblem(f"no block is called '{pattern}'{hint}", "fixed", i)
        for k in hit:
            found[k] = True
    return found


def _below(table: Import, parts: Sequence[Any]) -> bool:
    if table.fixed_below is None:
        return False
    corners = np.concatenate([getattr(part, "vertices", part) for part in parts])
    size = float(norm(np.ptp(corners, axis=0)))
    return bool(corners[:, -1].max() <= table.fixed_below + 1e-6 * size)


def _counts(table: Import, contents: Contents, blocks: Sequence[Block]) -> str:
    found = format_of(table.file)
    assert found is not None
    layers = Counter(body.layer for body in contents.bodies if body.layer)
    by_layer = f" ({', '.join(f'{n} on {name}' for name, n in layers.items())})" if layers else ""
    parts = sum(len(block.parts) for block in blocks)
    convex = f" of {parts:,} convex parts" if parts > len(blocks) else ""
    bodies = f"{len(contents.bodies):,} {found.what}" if len(contents.bodies) > 1 else f"one of its {found.what}"
    read_as = f"{len(blocks):,} blocks{convex} from {bodies}{by_layer}, lengths in {unit_of(contents, table.unit)}"
    return read_as + (f" times {table.scale:g}" if table.scale != 1.0 else "")


def _listed(names: Sequence[str] | Counter[str]) -> str:
    shown = [f"'{name}'" for name in list(names)[:SHOWN]]
    return ", ".join(shown) + (f" and {len(names) - SHOWN} more" if len(names) > SHOWN else "")
