"""Compute the failure load of a case by rigid-block limit analysis, without time stepping: `dem limit`."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from dem_cli.app.cli.options import case_argument, load, overrides_option
from dem_cli.app.cli.words import console
from dem_cli.errors import UsageError
from dem_cli.version import __version__

if TYPE_CHECKING:
    from dem_cli.case.reader import LoadedCase
    from dem_cli.core.limit.analysis import LimitLoads
    from dem_cli.core.limit.snapshot import Collapse
    from dem_cli.core.model.model import Model
    from dem_cli.core.records.frames import Frame


@click.command("limit", short_help="Failure load by rigid-block limit analysis.")
@case_argument
@overrides_option
@click.option("-o", "--output", type=click.Path(path_type=Path), metavar="DIR", help="Write results, for dem plot too.")
@click.option("--json", "as_json", is_flag=True, help="Print the summary as one JSON object.")
@click.option(
    "--heads",
    type=click.Choice(["frictional", "frictionless"]),
    default="frictional",
    show_default=True,
    help="Joints steeper than 45°; the thesis's Table 5-3 has them without friction.",
)
@click.option("--associated-only", is_flag=True, help="Leave out the load of joints that do not dilate.")
@click.option("--lower", is_flag=True, help="Also a load below which no joints that do not dilate collapse.")
@click.option(
    "--least", is_flag=True, help="Also the least load of all collapse states of such joints; small structures."
)
@click.option("-q", "--quiet", is_flag=True, help="No progress.")
@click.option("--force", is_flag=True, help="Write among files that dem did not write; those stay.")
def command(
    case: str,
    overrides: Sequence[str],
    output: Path | None,
    as_json: bool,
    heads: str,
    associated_only: bool,
    lower: bool,
    least: bool,
    quiet: bool,
    force: bool,
) -> int:
    """Failure load of CASE by limit analysis of its rigid blocks, as they stand at the start, and bounds of it."""
    from dem_cli.app import api
    from dem_cli.core.engine.properties import joint_properties, law_of
    from dem_cli.core.limit.analysis import LEAST, LOWER, limit_loads, require_scalable, taken_as_plane
    from dem_cli.masonry.assembly.solver_request import solver_request
    from dem_cli.results.output.summary import to_json

    started = time.perf_counter()
    loaded = load(case, overrides)
    require_multiplier(loaded)
    model = api.build_model(loaded)
    request = solver_request(loaded.case)
    properties, law = joint_properties(request, model), law_of(request)
    if loaded.case.analysis.pattern == "tilt":
        require_scalable(model, properties, law)
    if note := taken_as_plane(properties):
        loaded.warnings.append(note)
    bounds = [name for name, wanted in ((LOWER, lower), (LEAST, least)) if wanted]
    with console.Progress(quiet) as bar:
        find = partial(
            limit_loads, model, properties, law, heads == "frictionless", associated_only, bounds,
            lambda load, reached: bar.update("no dilation", load, 0.0, None),
        )  # fmt: skip
        found, note = loads_of_start(model, find)
    loaded.warnings += [note] if note else []
    summary = summarised(loaded, model, found, heads) | {"wall_seconds": time.perf_counter() - started}
    if output is not None:
        write(loaded, model, found, summary, output, force)
    console.show(to_json(summary).rstrip() if as_json else console.limit_answer(summary, output))
    return code(summary, loaded)


def loads_of_start(model: Model, find: Callable[..., LimitLoads]) -> tuple[LimitLoads, str | None]:
    """Run limit analysis by `find(settings=...)`; returns the loads and a remark about initial gaps.

    They stay open, unless nothing carries the dead loads then: those that close like joints are taken as closed.
    """
    from dem_cli.core.limit.analysis import closing_gaps, gaps_left_open
    from dem_cli.core.limit.associated import FALLS
    from dem_cli.core.limit.settings import LimitSettings

    found = find()
    if found.associated.status == FALLS and (closing := closing_gaps(model)) is not None:
        near, note = closing
        closed = find(settings=LimitSettings(touching=near))
        if closed.associated.status != FALLS:
            return closed, note
    return found, gaps_left_open(model)


def code(summary: dict[str, Any], loaded: LoadedCase) -> int:
    """Return the exit code as for `dem run`; references count only as far as they expect a collapse."""
    from dem_cli.results.output.reference import unexpected_fall
    from dem_cli.results.output.summary import exit_code

    fell = exit_code(summary) == 1
    expected = not unexpected_fall(summary, [{"quantity": one.path} for one in loaded.case.reference])
    return 0 if fell and expected else exit_code(summary)


def require_multiplier(loaded: LoadedCase) -> None:
    """Raise UsageError for a kind of analysis that has no live loads."""
    kind = loaded.case.analysis.kind
    if kind != "pushover":
        raise UsageError(
            f"limit analysis looks for the multiplier of live loads, and analysis.kind = '{kind}' has none; "
            "add --set analysis.kind=pushover (and its pattern)"
        )


def summarised(loaded: LoadedCase, model: Model, found: LimitLoads, heads: str) -> dict[str, Any]:
    """Create summary.json for kind "limit"."""
    from dem_cli.analyses.hand_check import hand_check
    from dem_cli.results.output.summary import ordered

    check = hand_check(loaded.case)
    limits = found.summary() | {"heads": heads}
    return ordered(
        {
            "title": loaded.case.title or loaded.name,
            "kind": "limit",
            "version": __version__,
            "status": status(found),
            "limit_analysis": limits if check is None else limits | {"rigid_wall": check},
            "blocks": model.n_blocks,
            "joints": len(found.structure.joints.blocks),
            "contacts": len(found.friction),
            "solve_seconds": found.seconds + (found.path_seconds or 0.0),
            "warnings": loaded.warnings,
        }
    )


def status(found: LimitLoads) -> str:
    """Return the overall status: that of the first load that was not found."""
    from dem_cli.core.limit.associated import LOCKED, OK

    path = found.non_associated
    return path.status if found.associated.status in (OK, LOCKED) and path is not None else found.associated.status


def frames(loaded: LoadedCase, found: LimitLoads) -> list[Frame]:
    """Create the frames of the collapse mechanisms that were found."""
    from dem_cli.core.limit.associated import OK
    from dem_cli.core.limit.snapshot import Collapse, frame

    states, load = [], found.associated
    if load.status == OK and load.multiplier is not None:
        states.append(
            Collapse("associated", load.multiplier, load.normal, load.shear, load.velocities, load.iterations)
        )
    if (end := end_of_path(found)) is not None:
        states.append(end)
    return [frame(found.structure, state, loaded.case.analysis.pattern == "tilt") for state in states]


def end_of_path(found: LimitLoads) -> Collapse | None:
    """Return the collapse mechanism of joints that do not dilate; None where it was not found or sought."""
    from dem_cli.core.contact.corner_forces import at_corners
    from dem_cli.core.limit.associated import OK
    from dem_cli.core.limit.snapshot import Collapse

    path = found.non_associated
    if path is None or path.status != OK:
        return None
    if path.load is None or path.normal is None or path.shear is None or path.mechanism is None:
        return None
    shear = at_corners(found.structure.joints, path.normal, path.shear)
    return Collapse("non-associated", path.load, path.normal, shear, path.mechanism, path.factorisations)


def write(
    loaded: LoadedCase, model: Model, found: LimitLoads, summary: dict[str, Any], output: Path, force: bool
) -> None:
    """Write summary.json, results.h5, the ParaView files and case.toml to the folder `output`, all or none."""
    from dem_cli.case.writer import case_text
    from dem_cli.core.contact.drawn_joints import DrawnJoints
    from dem_cli.results.output.folder import OutputFolder
    from dem_cli.results.output.provenance import provenance
    from dem_cli.results.output.store import ResultWriter

    with OutputFolder(output, force=force) as folder:
        writer = ResultWriter(folder.path, model, case_text(loaded.case), provenance(), kind="limit", name=output)
        writer.follow(DrawnJoints)
        try:
            for snapshot in frames(loaded, found):
                writer.frame(snapshot)
            writer.close(summary)
        finally:
            writer.abandon()
        folder.commit()
