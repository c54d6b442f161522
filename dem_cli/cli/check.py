"""`dem check`: validate a case and print its model; nothing is solved."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING

import click

from dem_cli.cli.options import case_argument, load, overrides_option, warn

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dem_cli.assembly.applied_loads import AppliedLoad
    from dem_cli.case.schema import Case
    from dem_cli.model.model import Model


@click.command("check", short_help="Validate a case and print its model; solve nothing.")
@case_argument
@overrides_option
def command(case: str, overrides: tuple[str, ...]) -> None:
    """Validate CASE and print its model: blocks, joints, mass, time step and estimated cost."""
    from dem_cli import api
    from dem_cli.pipeline.monitor_names import check_quantities, monitor_names

    loaded = load(case, overrides)
    made = api.build_assembly(loaded)
    model = made.model
    with loaded.located():
        check_quantities(loaded.case, monitor_names(loaded.case.monitor))
    warn(loaded)
    found = rows(loaded.case, model, made.loads)
    if loaded.case.sweep is not None:
        from dem_cli.cli.sweep import planned

        plan = planned(loaded)
        found.append(("sweep", f"{len(plan.runs):,} runs of `dem sweep` over {', '.join(plan.keys)}"))
    if find_spec("dem_cli.analyses.estimate"):
        with loaded.located():
            found += import_module("dem_cli.analyses.estimate").describe(loaded.case, model)
    width = max(len(label) for label, _ in found)
    click.echo(loaded.case.title)
    click.echo("\n".join(f"  {label:<{width}}  {text}" for label, text in found))


def rows(case: Case, model: Model, applied: Sequence[AppliedLoad] = ()) -> list[tuple[str, str]]:
    """What the case is made of: label and text of each line."""
    from dem_cli.output.paraview.vertices import rest_vertices

    free = ~model.fixed
    corners = rest_vertices(model)
    size = " × ".join(f"{length:.4g} m" for length in corners.max(axis=0) - corners.min(axis=0))
    loads = [f"{sum(load.kind == kind for load in case.load)} {kind}" for kind in ("dead", "live")]
    return [
        ("analysis", case.analysis.kind),
        *_imports(case),
        ("blocks", f"{model.n_blocks:,} ({model.fixed.sum():,} fixed), {len(model.vertices):,} corners"),
        ("size", size),
        ("mass", f"{model.masses[free].sum():.6g} kg (free blocks), {len(case.materials)} material(s)"),
        ("joint laws", ", ".join(f"{name} ({joint.law})" for name, joint in case.joints.items())),
        *_drawn(case),
        *([("imperfections", _imperfections(case))] if case.imperfection else []),
        ("point loads", ", ".join(loads) if case.load else "none"),
        *((str(load.path[0]), _surface_load(load)) for load in applied if load.path[0] != "load"),
    ]


def _surface_load(load: AppliedLoad) -> str:
    """Where a pressure or a fill acts, its resultant and the middle of its forces."""
    parts = (", ".join(f"{x + 0.0:.4g}" for x in vector) for vector in (load.resultant, load.centre.round(9)))
    resultant, centre = parts
    n_blocks = len(set(load.blocks.tolist()))
    blocks = f"{n_blocks:,} block{'s' if n_blocks > 1 else ''}"
    kind = "dead" if load.dead else "live"
    return f"{kind}, on {load.area:.4g} m2 of {blocks}: [{resultant}] N in all, their middle at [{centre}] m"


def _drawn(case: Case) -> list[tuple[str, str]]:
    """What structures have drawn at random."""
    from dem_cli.structures.registry import generated_figures

    return [
        (f"{table.id} {label}", text) for table in case.structure for label, text in generated_figures(table, case.seed)
    ]


def _imports(case: Case) -> list[tuple[str, str]]:
    """How files of other programs were read."""
    from dem_cli.structures.imported import Import, imported

    tables = [table for table in case.structure if isinstance(table, Import)]
    notes = [(f"{table.id}: " if len(tables) > 1 else "", note) for table in tables for note in imported(table).notes]
    return [("import" if k == 0 else "", name + note) for k, (name, note) in enumerate(notes)]


def _imperfections(case: Case) -> str:
    """How many tables, and what they are drawn from."""
    count = len(case.imperfection)
    return f"{count} {'table' if count == 1 else 'tables'}; what is random is drawn from seed {case.seed}"
