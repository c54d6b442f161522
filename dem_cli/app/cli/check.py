"""Validate a case and print its model without solving it: `dem check`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from dem_cli.app.cli.options import STDIN, azimuth_option, case_argument, elevation_option, load, overrides_option, warn
from dem_cli.errors import UsageError, printable

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np

    from dem_cli.case.schema import Case
    from dem_cli.core.model.model import Model
    from dem_cli.masonry.assembly.point_forces import AppliedLoad
    from dem_cli.results.post.scene.axonometry import Standpoint

Done = TypeVar("Done")
FEW_CORNERS = {2: 1500, 3: 128}  # of blocks, by dimension: up to here Python takes less than numba does to load, 0.4 s
FEW_NEIGHBOURS = 8  # pairs of parts that are near each other, per part: a wall has three


@click.command("check", short_help="Validate a case and print its model; solve nothing.")
@case_argument
@overrides_option
@click.option("--plot", is_flag=True, help="A picture of the model as well: blocks, supports, loads; CASE.png.")
@click.option("-o", "--output", metavar="FILE", type=click.Path(path_type=Path), help="The picture: .png, .svg, .pdf.")
@azimuth_option
@elevation_option
def command(
    case: str,
    overrides: tuple[str, ...],
    plot: bool,
    output: Path | None,
    azimuth: float | None,
    elevation: float | None,
) -> None:
    """Validate CASE and print its model: blocks, joints, mass, time step and estimated cost."""
    from dem_cli.app import api
    from dem_cli.app.pipeline.monitor_names import check_quantities, monitor_names

    loaded = load(case, overrides)
    made = api.laid(loaded)
    model = made.model
    at_once(model, lambda: api.examine(loaded, made))
    with loaded.located():
        check_quantities(loaded.case, monitor_names(loaded.case.monitor))
    warn(loaded)
    found = rows(loaded.case, model, made.loads)
    if loaded.case.sweep is not None:
        from dem_cli.app.cli.sweep import planned

        plan = planned(loaded)
        found.append(("sweep", f"{len(plan.runs):,} runs of `dem sweep` over {', '.join(plan.keys)}"))
    from dem_cli.analyses.estimate import describe

    with loaded.located():
        found += at_once(model, lambda: describe(loaded.case, model))
    width = max(len(label) for label, _ in found)
    click.echo(loaded.case.title)
    click.echo("\n".join(f"  {label:<{width}}  {text}" for label, text in found))
    if plot or output is not None:
        from dem_cli.results.post.scene.axonometry import Standpoint

        name = Path("model.toml") if case == STDIN else Path(case)
        path = output or name.with_suffix(".png")
        draw(loaded.case, model, dict(found), path, Standpoint(None, azimuth, elevation))
        click.echo(printable(str(path)))
    elif azimuth is not None or elevation is not None:
        raise UsageError("--azimuth and --elevation are for --plot")


def at_once(model: Model, work: Callable[[], Done]) -> Done:
    """Call `work`; for few blocks without compiling, which takes longer to load than the work itself."""
    from dem_cli.core.kernels.jit import uncompiled

    if len(model.vertices) <= FEW_CORNERS[model.dimension] and _pairs(model) <= FEW_NEIGHBOURS * model.n_parts:
        try:
            with uncompiled():
                return work()
        except (ArithmeticError, ValueError):  # which compiled code does not raise
            pass
    return work()


def _pairs(model: Model) -> int:
    """Count the pairs of parts near each other, the cost of the checks.

    Of few parts: it takes memory by the square of their number.
    """
    import numpy as np

    from dem_cli.core.contact.gaps import notice_reach
    from dem_cli.core.model.places import undeformed

    corners, starts = undeformed(model), model.part_starts[:-1]
    low = np.minimum.reduceat(corners, starts, axis=0) - notice_reach(model)
    high = np.maximum.reduceat(corners, starts, axis=0)
    near = ((low[:, None] <= high) & (low <= high[:, None])).all(axis=2)
    return int(near.sum() - len(starts)) // 2


def draw(case: Case, model: Model, found: dict[str, str], path: Path, asked: Standpoint) -> None:
    """Draw the picture of a model before a run."""
    from dem_cli.results.output.folder import write_error
    from dem_cli.results.post.chart import check_format
    from dem_cli.results.post.scene.model_picture import ModelFacts, draw_model

    check_format(path)
    lines = [f"blocks {found['blocks']}", f"size {found['size']}, mass {found['mass']}"]
    lines += [f"joints {found['joints']}"] if "joints" in found else []
    pattern = getattr(case.analysis, "pattern", None)
    pushed = unit(case.analysis.direction) if pattern in ("mass", "tilt") else None
    shaken = unit(case.motion[0].direction) if case.motion else None
    facts = ModelFacts(case.title, lines, case.gravity, pushed, shaken, marks(case, model))
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        draw_model(model, facts, path, asked)
    except OSError as error:
        raise write_error(error, path) from None


def marks(case: Case, model: Model) -> list[tuple[str, np.ndarray]]:
    """Return names and places of the monitors of blocks and points."""
    import numpy as np

    from dem_cli.app.pipeline.monitor_names import monitor_names

    found = []
    for name, monitor in zip(monitor_names(case.monitor), case.monitor):
        if monitor.point is not None:
            found.append((name, np.array(monitor.point)))
        elif monitor.between is None:
            blocks = model.chosen(monitor.selected, False)
            found.append((name, np.average(model.centroids[blocks], axis=0, weights=model.masses[blocks])))
    return found


def unit(direction: Sequence[float]) -> np.ndarray:
    """Normalise a direction to length one, (d,)."""
    import numpy as np

    return np.array(direction, float) / np.hypot.reduce(np.array(direction, float))


def rows(case: Case, model: Model, applied: Sequence[AppliedLoad] = ()) -> list[tuple[str, str]]:
    """Describe the case: label and text of each line."""
    from dem_cli.results.output.paraview.vertices import size_in_words

    free = ~model.fixed
    loads = [f"{sum(load.kind == kind for load in case.load)} {kind}" for kind in ("dead", "live")]
    return [
        ("analysis", case.analysis.kind),
        *_imports(case),
        ("blocks", f"{model.n_blocks:,} ({model.fixed.sum():,} fixed), {len(model.vertices):,} corners"),
        ("size", f"{size_in_words(model)} (free blocks)"),
        ("mass", f"{model.masses[free].sum():.6g} kg (free blocks), {len(case.materials)} material(s)"),
        ("joint laws", ", ".join(f"{name} ({joint.law})" for name, joint in case.joints.items())),
        *_drawn(case),
        *([("imperfections", _imperfections(case))] if case.imperfection else []),
        ("point loads", ", ".join(loads) if case.load else "none"),
        *((str(load.path[0]), _surface_load(load)) for load in applied if load.path[0] != "load"),
    ]


def _surface_load(load: AppliedLoad) -> str:
    """Describe the place, resultant and centre of a pressure or fill."""
    parts = (", ".join(f"{x + 0.0:.4g}" for x in vector) for vector in (load.resultant, load.centre.round(9)))
    resultant, centre = parts
    n_blocks = len(set(load.blocks.tolist()))
    blocks = f"{n_blocks:,} block{'s' if n_blocks > 1 else ''}"
    kind = "dead" if load.dead else "live"
    return f"{kind}, on {load.area:.4g} m2 of {blocks}: [{resultant}] N in all, their middle at [{centre}] m"


def _drawn(case: Case) -> list[tuple[str, str]]:
    """Describe the random parameters of structures."""
    from dem_cli.masonry.structures.registry import generated_figures

    return [
        (f"{table.id} {label}", text) for table in case.structure for label, text in generated_figures(table, case.seed)
    ]


def _imports(case: Case) -> list[tuple[str, str]]:
    """Describe how files of other programs and outlines of walls were read."""
    files = {table.id: _notes(table) for table in case.structure if table.kind == "import"}
    outlines = {table.id: table.outline.drawn.notes for table in case.structure if getattr(table, "outline", None)}
    rows = []
    for label, read in (("import", files), ("outline", outlines)):
        notes = [(f"{name}: " if len(read) > 1 else "") + note for name, own in read.items() for note in own]
        rows += [(label if k == 0 else "", note) for k, note in enumerate(notes)]
    return rows


def _notes(table: Any) -> tuple[str, ...]:
    """Return the notes on how a file of another program was read."""
    from dem_cli.masonry.structures.imported import imported

    return tuple(imported(table).notes)


def _imperfections(case: Case) -> str:
    """Describe the number of imperfection tables and their random seed."""
    count = len(case.imperfection)
    return f"{count} {'table' if count == 1 else 'tables'}; what is random is drawn from seed {case.seed}"
