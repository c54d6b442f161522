"""Measure, write and draw the ground motions of a case: `dem motion`."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from dem_cli.app.cli.options import case_argument, load, overrides_option, warn
from dem_cli.app.cli.words import console
from dem_cli.errors import CaseError, DemError, UsageError
from dem_cli.version import __version__

if TYPE_CHECKING:
    from dem_cli.case.reader import LoadedCase
    from dem_cli.core.motion.eurocode import TargetSpectrum
    from dem_cli.core.motion.eurocode_suites import Clause
    from dem_cli.core.motion.intensity_measures import SpectrumFit
    from dem_cli.core.motion.motion import Motion

RECORDS, SPECTRA, MOTION_PICTURE = "records", "spectra.png", "motion.png"
MOTION_COLUMNS = ("time [s]", "acceleration [m/s2]", "velocity [m/s]", "displacement [m]")
SHAKEN_KINDS = ("time-history", "fragility")  # kinds of runs that motions go into
HEADINGS = ("record", "duration", "acceleration", "velocity", "displacement", "Arias", "5–95 %", "spectrum/target")


class RecordGroup(NamedTuple):
    """Ground motion records of one [motion] table."""

    motions: list[Motion]
    target: TargetSpectrum | None  # what they were made to fit
    fit: SpectrumFit | None
    chosen: int  # which of them a time history uses
    clauses: Sequence[Clause] = ()  # of Eurocode 8, for suites made to fit a spectrum


@click.command("motion", short_help="Measure, write and draw the ground motions of a case.")
@case_argument
@overrides_option
@click.option("-o", "--output", type=click.Path(path_type=Path), metavar="DIR", help="Default: results/NAME-motion.")
@click.option("--json", "as_json", is_flag=True, help="Print the summary as one JSON object.")
@click.option("--force", is_flag=True, help="Write among files that dem did not write; those stay.")
def command(case: str, overrides: Sequence[str], output: Path | None, as_json: bool, force: bool) -> None:
    """Measure the motions in [motion] of CASE: all records of a suite, and how they fit their spectrum.

    Each is written as CSV (time, acceleration, velocity, displacement) and drawn, with its response spectrum.
    """
    from dem_cli.app import api
    from dem_cli.results.output.folder import OutputFolder
    from dem_cli.results.output.summary import to_json

    loaded = load(case, overrides)
    api.build_model(loaded)  # supports that do not exist, records that cannot be used
    warn(loaded)
    groups = groups_of(loaded)
    summary = summarised(loaded, groups)
    with OutputFolder(output or Path("results") / f"{loaded.name}-motion", force=force) as folder:
        write(folder, groups, summary)
        place = folder.commit()
    console.show(to_json(summary).rstrip() if as_json else answer(summary, place))


def groups_of(loaded: LoadedCase, compare: bool = True) -> list[RecordGroup]:
    """Create the records of every table. Raises UsageError for a case without motion, CaseError on a bad record."""
    from dem_cli.core.motion.intensity_measures import fit
    from dem_cli.masonry.assembly.ground_motions import suites_of

    tables = [table for table in loaded.case.motion if table.kind != "none"]
    if not tables:
        raise UsageError(f"{loaded.path}: has no [motion] that moves anything")
    try:
        suites = suites_of(loaded.case)
    except CaseError as error:
        raise CaseError(error.problems, loaded.render) from None
    groups = []
    for table, motions in zip(tables, suites):
        target = compared = None
        judged: Sequence[Clause] = ()
        if table.kind == "artificial":
            target = table.target.scaled(abs(table.scale))
            compared = fit(motions, target, table.first_period) if compare else None
            judged = table.judged(motions) if compare else ()
        groups.append(RecordGroup(motions, target, compared, getattr(table, "number", 1) - 1, judged))
    return groups


def summarised(loaded: LoadedCase, groups: Sequence[RecordGroup]) -> dict[str, Any]:
    """Create summary.json."""
    from dem_cli.core.motion.eurocode_suites import meets, verdict
    from dem_cli.core.motion.intensity_measures import strength
    from dem_cli.results.output.summary import ordered

    records, fits = [], []
    for i, group in enumerate(groups):
        for k, motion in enumerate(group.motions):
            row: dict[str, Any] = {"name": motion.name, "file": f"{RECORDS}/{file_name(groups, i, k)}"}
            row |= strength(motion)._asdict()
            if group.fit is not None:
                ratios = group.fit.ratios[k]
                row |= {"least_ratio": ratios.min(), "mean_ratio": ratios.mean()}
            records.append(row)
        if group.fit is not None and group.target is not None:
            fits.append(
                {
                    "target": group.target.title,
                    "records": len(group.motions),
                    "periods": [group.fit.periods[0], group.fit.periods[-1]],
                    "mean_peak_ratio": group.fit.mean_peak,
                    "least_mean_ratio": group.fit.least_mean,
                    "meets_eurocode_8": meets(group.clauses),
                    "clauses": {clause.number: clause.met for clause in group.clauses},
                    "verdict": verdict(group.clauses),
                }
            )
    return ordered(
        {
            "title": loaded.case.title,
            "kind": "motion",
            "version": __version__,
            "status": "ok",
            "motions": records,
            "suites": fits,
            "warnings": loaded.warnings,
        }
    )


def file_name(groups: Sequence[RecordGroup], i_group: int, k: int) -> str:
    """Return the file name of a record, `artificial-3.csv`, with the number of its table where there are several."""
    name = re.sub(r"[^\w.]+", "-", groups[i_group].motions[k].name).strip("-") or "motion"
    return f"{i_group + 1}-{name}.csv" if len(groups) > 1 else f"{name}.csv"


def write(folder: Any, groups: Sequence[RecordGroup], summary: dict[str, Any]) -> None:
    """Write CSV files, pictures and summary."""
    from dem_cli.results.output.folder import write_error
    from dem_cli.results.output.summary import write_summary

    try:
        (folder.path / RECORDS).mkdir()
        for i, group in enumerate(groups):
            for k, motion in enumerate(group.motions):
                text = as_csv(motion)
                path = folder.path / RECORDS / file_name(groups, i, k)
                path.write_text(text, encoding="utf-8", newline="\n")
        write_summary(folder.path, summary)
        draw(folder.path, groups, summary["title"])
    except OSError as error:
        raise write_error(error, folder.final) from None


def draw(folder: Path, groups: Sequence[RecordGroup], title: str) -> None:
    """Draw both pictures, or print a remark without matplotlib."""
    from dem_cli.results.post.spectra import MotionSuite, draw_motions, draw_spectra

    suites = [MotionSuite(group.motions, group.target, group.chosen) for group in groups]
    try:
        draw_spectra(suites, folder / SPECTRA, title)
        draw_motions(suites, folder / MOTION_PICTURE, title)
    except DemError as error:
        console.note(f"no picture: {error}")


def draw_spectra_of_run(folder: Path, output: Path) -> list[Path]:
    """Draw spectra.png of the ground motion of a run; nothing where there is none, or a record is gone."""
    from dem_cli.results.output.reader import read

    kind = read(folder).kind
    return draw_spectra_of_case(folder / "case.toml", kind, output) if kind in SHAKEN_KINDS else []


def draw_spectra_of_case(path: Path, kind: str, output: Path) -> list[Path]:
    """Draw spectra.png of a case: of a fragility study the whole suite, otherwise the record in use."""
    from dem_cli.app import api
    from dem_cli.results.post.spectra import MotionSuite, draw_spectra

    try:
        loaded = api.load_case(path)
        if all(table.kind == "none" for table in loaded.case.motion):
            return []
        groups = groups_of(loaded, compare=False)
    except DemError as error:
        console.note(f"no {SPECTRA}: {error}")
        return []
    suites = [
        MotionSuite(group.motions if kind == "fragility" else [group.motions[group.chosen]], group.target)
        for group in groups
    ]
    draw_spectra(suites, output / SPECTRA, loaded.case.title)
    return [output / SPECTRA]


def as_csv(motion: Motion) -> str:
    """Format the samples exactly as CSV that can be read again (`column = 2`)."""
    times = motion.samples()
    columns = (times, motion.acceleration(times), motion.velocity(times), motion.displacement(times))
    lines = [",".join(map(repr, row)) for row in zip(*(column.tolist() for column in columns))]
    return "\n".join([",".join(MOTION_COLUMNS), *lines, ""])


def answer(summary: dict[str, Any], folder: Path) -> str:
    """Format the table of all records, the clauses that a suite meets, and the list of written files."""
    from dem_cli.app.cli.run import file_names, shown

    rows = [HEADINGS, *(cells(record) for record in summary["motions"])]
    if not summary["suites"]:
        rows = [row[:-1] for row in rows]
    widths = [max(map(len, column)) for column in zip(*rows)]
    lines = [summary["title"]]
    for row in rows:
        lines.append("  " + "  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]))
    for fit in summary["suites"]:
        low, high = fit["periods"]
        lines.append(
            f"  {fit['target']}: mean of {fit['records']} is at least {fit['least_mean_ratio']:.3f} of it "
            f"({low:.3g} to {high:.3g} s), mean peak {fit['mean_peak_ratio']:.3f} of the ground acceleration: "
            f"{fit['verdict']}"
        )
    return "\n".join([*lines, f"  written to {shown(folder)} ({', '.join(file_names(folder))})"])


def cells(record: dict[str, Any]) -> tuple[str, ...]:
    """Format one line of the table."""
    ratio = f"≥ {record['least_ratio']:.2f}, mean {record['mean_ratio']:.2f}" if "least_ratio" in record else "–"
    return (
        record["name"],
        f"{record['duration']:.3g} s",
        f"{record['acceleration']:.3g} m/s2",
        f"{record['velocity']:.3g} m/s",
        console.metres(record["displacement"]),
        f"{record['arias']:.3g} m/s",
        f"{record['significant']:.3g} s",
        ratio,
    )
