"""Calibrate the joint profile to measured failure load and displacement: `dem calibrate`."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from dem_cli.app.calibrate.comparison import OK, TrialAnswer
from dem_cli.app.cli.options import case_argument, load, overrides_option, warn
from dem_cli.app.cli.words import console
from dem_cli.app.cli.workers import side_by_side
from dem_cli.app.pipeline.batches import usable_cores
from dem_cli.core.records.ports import Observer
from dem_cli.errors import CaseError, CaseProblem, DemError, OutputError, SolverError, UsageError
from dem_cli.interrupts import Interrupts
from dem_cli.version import __version__

if TYPE_CHECKING:
    from dem_cli.app.calibrate.table import NamedShape
    from dem_cli.app.calibrate.trials import CalibrationTrial
    from dem_cli.case.reader import LoadedCase
    from dem_cli.core.records.history_rows import HistoryRow
    from dem_cli.results.output.folder import OutputFolder

CALIBRATED_CASE, TRIALS_TABLE, TRIALS_PICTURE = "calibrated.toml", "calibration.csv", "calibration.png"


@click.command("calibrate", short_help="Find the joint profile that comes closest to a test.")
@case_argument
@overrides_option
@click.option(
    "-o", "--output", type=click.Path(path_type=Path), metavar="DIR", help="Default: results/NAME-calibration."
)
@click.option("-j", "--jobs", type=click.IntRange(min=1), metavar="N", help="Runs side by side; default: all cores.")
@click.option("--json", "as_json", is_flag=True, help="Print the summary as one JSON object.")
@click.option("-q", "--quiet", is_flag=True, help="No progress and no remarks.")
@click.option("--force", is_flag=True, help="Write among files that dem did not write; those stay.")
def command(
    case: str, overrides: Sequence[str], output: Path | None, jobs: int | None, as_json: bool, quiet: bool, force: bool
) -> int:
    """Try the profiles in [calibration] of CASE; the closest to the measured values is written as a case.

    Every shape with every aperture is one run up to failure.
    """
    from dem_cli.app.calibrate.trials import trials
    from dem_cli.results.output.folder import OutputFolder
    from dem_cli.results.output.summary import to_json

    started = time.perf_counter()
    loaded = load(case, overrides)
    check(loaded)
    plan = trials(loaded.case)
    check_trials(loaded, plan)
    if not quiet:
        warn(loaded)
    with (
        Interrupts(),
        OutputFolder(output or Path("results") / f"{loaded.name}-calibration", force=force) as folder,
    ):
        found = solve_all(plan, min(jobs or usable_cores(), len(plan)), quiet)
        summary = summarised(loaded, plan, found) | {"wall_seconds": time.perf_counter() - started}
        write(folder, summary, plan, quiet)
        place = folder.commit()
    console.show(to_json(summary).rstrip() if as_json else answer(summary, place))
    return 0


def check(loaded: LoadedCase) -> None:
    """Raise UsageError for a case without calibration or failure load, CaseError for an unknown joint."""
    case = loaded.case
    if case.calibration is None:
        raise UsageError(f"{loaded.path}: has no [calibration]: what was measured, and the profiles to try")
    if case.analysis.kind != "pushover":
        raise UsageError(
            f"a calibration compares failure loads, and analysis.kind = '{case.analysis.kind}' has none; "
            "add --set analysis.kind=pushover (and its pattern)"
        )
    joint = case.calibration.joint
    if joint and joint not in case.joints:
        from dem_cli.case.wording import unknown_name

        problem = CaseProblem(("calibration", "joint"), unknown_name("joint", joint, list(case.joints)))
        raise CaseError([problem], loaded.render)


def check_trials(loaded: LoadedCase, plan: Sequence[CalibrationTrial]) -> None:
    """Build all models, so that errors in them and in the measured point are reported before anything is solved."""
    from dem_cli.app import api
    from dem_cli.case.reader import LoadedCase as Loaded

    for trial in plan:
        built = Loaded(trial.case, loaded)
        try:
            api.build_model(built)
        except CaseError as error:
            problems = [blamed(problem, loaded, trial) for problem in error.problems]
            raise CaseError(problems, loaded.render) from None
        loaded.warnings += [line for line in built.warnings if line not in loaded.warnings]


def blamed(problem: CaseProblem, loaded: LoadedCase, trial: CalibrationTrial) -> CaseProblem:
    """Move a problem of a trial to its place in the case file."""
    path, calibration = problem.path, loaded.case.calibration
    if path[:2] == ("monitor", len(loaded.case.monitor)):
        return CaseProblem(("calibration", *path[2:]), problem.message)
    if trial.shape is not None and path[2:] == ("profile", "aperture"):
        number = calibration.apertures.index(trial.aperture)
        return CaseProblem(("calibration", "apertures", number), f"with shape '{trial.shape.name}', {problem.message}")
    return problem


def solve_all(plan: Sequence[CalibrationTrial], jobs: int, quiet: bool) -> list[TrialAnswer]:
    """Solve all trials."""
    from dem_cli.case.writer import case_text

    found: dict[int, TrialAnswer] = {}
    texts = [case_text(trial.case) for trial in plan]
    with console.Progress(quiet) as bar:
        bar.update(f"{len(plan)} runs, {jobs} side by side", 0.0, 0.0, 0.0)
        for i, one in side_by_side(solved, texts, jobs):
            found[i] = one
            bar.update(plan[i].name, one.failure_load or 0.0, one.displacement or 0.0, len(found) / len(plan))
    return [found[i] for i in range(len(plan))]


class RowKeeper(Observer):
    """Observer that keeps the rows of the history."""

    def __init__(self) -> None:
        self.rows: list[HistoryRow] = []

    def row(self, row: HistoryRow) -> None:
        """Append a row."""
        self.rows.append(row)


def solved(text: str) -> TrialAnswer:
    """Solve one trial up to failure, from the text of its case, so that it can run in another process.

    Raises KeyboardInterrupt where it was stopped.
    """
    from dem_cli.analyses.solve import solve
    from dem_cli.app import api
    from dem_cli.case.reader import CaseSource, LoadedCase, parse_toml, validate

    source = CaseSource(Path(CALIBRATED_CASE), text)
    loaded = LoadedCase(validate(parse_toml(source.path, text), api.make_case_model(), source), source)
    case = loaded.case
    only_failure = case.analysis.model_copy(update={"follow": 0.0, "limit": False})
    observer = RowKeeper()
    try:
        model = api.build_model(loaded)
        summary = solve(case.model_copy(update={"analysis": only_failure}), model, observer).summary
    except DemError as error:  # as text: it may not survive the way between processes
        return TrialAnswer(f"not converged: {error}")
    if summary["status"] == "interrupted":
        raise KeyboardInterrupt
    return TrialAnswer(
        summary["status"],
        summary.get("failure_load"),
        tuple(summary.get("failure_load_bracket") or (None, None)),
        before_failure(observer.rows, summary, case.analysis.resolution),
        summary["solve_seconds"],
        tuple(summary["warnings"]),
    )


def before_failure(rows: Sequence[HistoryRow], summary: dict[str, Any], resolution: float) -> float | None:
    """Return the measured displacement at the highest load in equilibrium [m].

    Where the geometry of the start was kept, a mechanism rests wherever it is left: there it is the smallest of all
    that are at this load within the resolution.
    """
    load = summary.get("failure_load")
    slack = resolution * abs(load or 0.0) if summary.get("kinematics") == "fixed" else 0.0
    held = [abs(r.monitors[-1]) for r in rows if r.stage == "loading" and load is not None and r.load >= load - slack]
    return min(held, default=None)


def summarised(loaded: LoadedCase, plan: Sequence[CalibrationTrial], found: Sequence[TrialAnswer]) -> dict[str, Any]:
    """Create summary.json. Raises SolverError where no profile has a failure load."""
    from dem_cli.app.calibrate.comparison import closest, rows
    from dem_cli.results.output.summary import ordered

    case, measured = loaded.case, loaded.case.calibration
    table = rows(measured, plan, found)
    best = closest(table)
    if best is None:
        raise SolverError(f"no profile has a failure load; {plan[1].name}: {found[1].status}")
    unanswered = [f"{trial.name}: {one.status}" for trial, one in zip(plan, found) if one.status != OK]
    return ordered(
        {
            "title": case.title or loaded.name,
            "kind": "calibration",
            "version": __version__,
            "status": OK,
            "joint": measured.joint or case.default_joint,
            "measured": {
                "failure_load": measured.failure_load,
                "displacement": measured.displacement,
                "of": measured.block or list(measured.point),
                "component": measured.component,
            },
            "closest": table[best],
            "trials": table,
            "shapes": {shape.name: polygon_of(shape, case.seed) for shape in measured.shapes},
            "solve_seconds": sum(one.seconds for one in found),
            "warnings": [*loaded.warnings, *unanswered],
        }
    )


def polygon_of(shape: NamedShape, seed: int) -> dict[str, list[float]]:
    """Return the vertices of a shape, drawn at random if needed: places along the joint and rises, as shares."""
    from dem_cli.core.contact.layout import PointLayout, draw
    from dem_cli.core.laws.profile import Profile

    profile = Profile(**shape.model_dump(exclude={"name"}), aperture=1.0)
    places, rises, _ = draw(PointLayout(seed=seed, **profile.ranges)._replace(keep="aperture"), (0,), 1.0)
    return {"places": places.tolist(), "rises": rises.tolist()}


def write(folder: OutputFolder, summary: dict[str, Any], plan: Sequence[CalibrationTrial], quiet: bool) -> None:
    """Write summary, table, the case with the closest profile, and the picture."""
    from dem_cli.app.calibrate.comparison import as_csv
    from dem_cli.case.writer import case_text
    from dem_cli.results.output.folder import write_error
    from dem_cli.results.output.summary import write_summary

    best = summary["trials"].index(summary["closest"])
    try:
        (folder.path / TRIALS_TABLE).write_text(as_csv(summary["trials"]), encoding="utf-8", newline="\n")
        (folder.path / CALIBRATED_CASE).write_text(case_text(plan[best].case), encoding="utf-8", newline="\n")
        write_summary(folder.path, summary)
    except OSError as error:
        raise write_error(error, folder.final) from None
    try:
        from dem_cli.results.post.calibration import draw_calibration

        draw_calibration(summary, folder.path / TRIALS_PICTURE)
    except (DemError, OSError) as error:
        if isinstance(error, OutputError):
            raise
        console.note(f"no picture: {error}", quiet)


def answer(summary: dict[str, Any], folder: Path) -> str:
    """Format the table of all profiles, and the list of written files."""
    from dem_cli.app.calibrate.comparison import as_text
    from dem_cli.app.cli.run import file_names, shown

    lines = [f"{summary['title']}: profiles of joint '{summary['joint']}'", *as_text(summary)]
    lines += [f"  warning: {warning}" for warning in summary["warnings"]]
    return "\n".join([*lines, f"  written to {shown(folder)} ({', '.join(file_names(folder))})"])
