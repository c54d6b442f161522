"""Terminal output of `dem run`: progress on stderr, the answer on stdout."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, TextIO

from dem_cli.app.cli.words.curve import curve_rows
from dem_cli.app.cli.words.fragility import fragility_rows
from dem_cli.app.cli.words.limit_loads import limit_rows
from dem_cli.app.cli.words.modes import mode_rows
from dem_cli.app.cli.words.numbers import load_text, metres, seconds
from dem_cli.app.cli.words.pace import Pace
from dem_cli.app.cli.words.safety import safety_rows
from dem_cli.app.cli.words.sureness import sureness_rows
from dem_cli.errors import printable
from dem_cli.results.output.ending import ending_words, last_words, unfound_load

_FIRST_BAR = 0.5  # s of run before a bar appears: short runs stay silent and need no rich
_BAR_EVERY = 0.1  # s
_LINE_EVERY = 10.0  # s
_ELSEWHERE = 0.1  # of the wall time, by which CPU time differs where both are named
_COMPILING = "compiling"  # begins the name of the stage


class Progress:
    """Progress of a run: a bar on a terminal, otherwise a plain line every 10 s; nothing when `quiet`."""

    def __init__(self, quiet: bool = False, stream: TextIO | None = None):
        self.quiet = quiet
        self.stream = stream or sys.stderr
        self.on_terminal = self.stream.isatty()
        self.start = time.monotonic()
        self._next = self.start + (_FIRST_BAR if self.on_terminal else _LINE_EVERY)
        self._pace = Pace()
        self._bar: Any = None
        self._compiles = False  # that was said

    def update(self, stage: str, load: float, displacement: float, fraction: float | None) -> None:
        """Update the progress; cheap enough to be called often."""
        now = time.monotonic()
        self._pace.look(now, stage, fraction)
        if not self.quiet and stage.startswith(_COMPILING):  # said at once: it takes seconds
            self.stop()
            if not self._compiles:
                print(stage, file=self.stream, flush=True)
            self._compiles = True
        elif not self.quiet and now >= self._next:
            self._next = now + (_BAR_EVERY if self.on_terminal else _LINE_EVERY)
            self._say(now, stage, load, displacement, fraction)

    def _say(self, now: float, stage: str, load: float, displacement: float, fraction: float | None) -> None:
        drive = f"base {load:+.3f} g" if stage == "shaking" else f"load {load:.4f}"
        where = "" if math.isnan(load) else f"{drive}, displacement {metres(displacement)}"  # many runs: none of them
        if self.on_terminal:
            self._draw(stage, where, fraction)
        else:
            said = [where, "" if fraction is None else f"{100 * fraction:.0f} %", self._left()]
            said += [] if said[-1] else [f"{seconds(now - self.start)} so far"]
            print(f"{stage}: {', '.join(filter(None, said))}", file=self.stream, flush=True)

    def _left(self) -> str:
        """Format the remaining time of the stage, where it is known."""
        left = self._pace.left()
        return "" if left is None else f"about {seconds(left)} left"

    def _draw(self, stage: str, where: str, fraction: float | None) -> None:
        if self._bar is None:
            self._bar = _new_bar(self.stream)
            self._task = self._bar.add_task(stage, total=None, where=where, left="")
            self._bar.start()
        total, said = None if fraction is None else 1.0, {"where": where, "left": self._left()}
        self._bar.update(self._task, description=stage, total=total, completed=fraction or 0.0, **said)

    def stop(self) -> None:
        """Remove the progress bar."""
        if self._bar is not None:
            self._bar.stop()
            self._bar = None

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.stop()


def _new_bar(stream: TextIO) -> Any:
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar

    columns = (
        TextColumn("{task.description:<8}"),
        BarColumn(bar_width=24),
        TextColumn("{task.fields[where]}"),
        TimeElapsedColumn(),
        TextColumn("so far  {task.fields[left]}"),
    )
    return Bar(*columns, console=Console(file=stream), transient=True)


MOST_PEAKS = 8  # of monitors, a line each
MOST_NAMES = 8  # of blocks, in one line
MOST_TURNS = 6  # of a load path, in one line


def answer(summary: Mapping[str, Any], folder: Path, files: Sequence[str], verbose: bool = False) -> str:
    """Format the result of a run: the failure load first, then its accuracy and the files.

    verbose: what was skipped as well, and why kernels took longer than they need.
    """
    rows = answer_rows(summary) + [("warning", text) for text in summary.get("warnings", ())]
    if verbose:
        from dem_cli.core.kernels.compilation.switch import SWITCH

        rows += [("skipped", text) for text in summary.get("skipped", ())]
        rows += [("compilation", text) for text in SWITCH.said()]
    rows.append(("written to", f"{folder} ({', '.join(files)})"))
    return "\n".join([str(summary["title"]), *(f"  {label:<14} {text}" for label, text in rows)])


def answer_rows(summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return label and text of each line of an answer of any kind, without warnings."""
    rows = [*_load_rows(summary), *_shaking_rows(summary), *fragility_rows(summary), *mode_rows(summary)]
    rows += [*curve_rows(summary), *safety_rows(summary)]
    return [*_standing_rows(summary), *rows, *sureness_rows(summary), *_cost_rows(summary)]


def _controlled(turn: Mapping[str, Any]) -> float:
    """Return the displacement of a turning point: of the controlled monitor, else of the live load [m]."""
    return float(turn["controlled"] if "of" in turn else turn.get("live_displacement", turn["displacement"]))


def _standing_rows(summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Describe a structure that stands under its dead loads, and large displacements until then."""
    if summary.get("kind") != "gravity" or summary["status"] != "ok":
        return []
    far = summary.get("moved_far")
    moved = f"; block '{far['block']}' has moved by {metres(far['distance'])} until then" if far else ""
    return [("result", f"stands{moved}")]


def explained(summary: Mapping[str, Any]) -> bool:
    """Test whether the failure load exceeds its bound because blocks have moved before."""
    return bool((summary.get("above_the_bound") or {}).get("explained"))


def _moved_rows(summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Describe the load of the first motion, where only displaced blocks carry the failure load."""
    if not explained(summary):
        return []
    above = summary["above_the_bound"]
    onset = summary.get("onset_of_displacements")
    first = above["bound"] if onset is None else min(onset, above["bound"])
    moved = f"then blocks move, by {metres(above['displacement'])} until the failure load"
    return [("first motion", f"{load_text(first)}; {moved}")]


def _load_rows(summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    rows = []
    if summary["status"] != "ok":
        rows.append(("status", str(summary["status"])))
    rows += _moved_rows(summary)
    load, bracket = summary.get("failure_load"), summary.get("failure_load_bracket")
    if load is not None:
        between = (
            f"  (between {load_text(bracket[0])} and {load_text(bracket[1])})"
            if bracket and None not in bracket
            else ""
        )
        rows.append(("failure load", f"{load_text(load)}{between}"))
    elif known := unfound_load(summary):
        rows.append(("failure load", f"not found: {known}"))
    settled = summary.get("settlement_at_collapse")
    if settled is not None:
        stands, falls = (100.0 * share for share in settled["bracket"])
        rows.append(("collapse", f"between {stands:.3g} % and {falls:.3g} % of the settlement"))
    if summary.get("equilibrium_load") is not None:
        bound = "" if bracket is None or bracket[1] is None else f"; not above {load_text(bracket[1])}"
        rows.append(("equilibrium at", f"{load_text(summary['equilibrium_load'])}{bound}"))
    if summary.get("failure_mode"):
        rows.append(("failure mode", str(summary["failure_mode"])))
    if summary.get("onset_of_displacements") is not None and not explained(summary):
        rows.append(("first motion", f"{load_text(summary['onset_of_displacements'])}, more than joints deform"))
    turns = summary.get("turning_points")
    if turns:
        shown = [(_controlled(turn), turn["load"]) for turn in turns[:MOST_TURNS]]
        text = ", ".join(f"{metres(moved)} at {load_text(load)}" for moved, load in shown)
        rows.append(("displacement", text + (", …" if len(turns) > MOST_TURNS else "")))
    reached = summary.get("reached")
    if reached:
        where = f"{reached['time']:.4g} s" if "time" in reached else f"load {load_text(reached['load'])}"
        where += f", displacement {metres(reached['displacement'])}"
        rows.append(("reached", f"{reached['stage']}, {where}"))
    return rows


def _shaking_rows(summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Describe a time history: collapse, peaks, and energy balance."""
    how = ending_words(summary)
    rows = [("result", how)] if how else []
    fallen = summary.get("fallen_blocks")
    if fallen:
        names = ", ".join(fallen["first"][:MOST_NAMES])
        rows.append(("fell", f"{fallen['count']:,}: {names}" + (", …" if fallen["count"] > MOST_NAMES else "")))
    peaks = summary.get("peaks") or {}
    for name, found in list(peaks.items())[:MOST_PEAKS]:
        residual = _measure(found["residual"], found["unit"])
        rows.append(("peak", f"{name}: {_peak_words(found)}, {residual} {last_words(summary)}"))
        spread = ((summary.get("repeats") or {}).get("peaks") or {}).get(name)
        if spread:
            low, high = (_measure(spread[key], spread["unit"]) for key in ("min", "max"))
            rows.append(("", f"of its repeats {low} to {high}"))
    if len(peaks) > MOST_PEAKS:
        rows.append(("", f"and {len(peaks) - MOST_PEAKS} more in summary.json"))
    shares = {name: share for name, share in (summary.get("energy_shares") or {}).items() if share >= 0.0005}
    if shares:
        listed = sorted(shares.items(), key=lambda item: -item[1])
        rows.append(("energy went to", ", ".join(f"{name.replace('_', ' ')} {100 * s:.3g} %" for name, s in listed)))
    return rows


def _peak_words(found: Mapping[str, Any]) -> str:
    """Format a peak and its time; also that during the motion, where it came after the motion."""
    if found["peak"] is None:
        return "no peak, blocks hit each other"
    said = f"{_measure(found['peak'], found['unit'])} at {found['time']:.4g} s"
    during, time = found.get("during_motion"), found.get("during_motion_time", found["time"])
    if during is None or time == found["time"]:
        return said
    return f"{said} ({_measure(during, found['unit'])} at {time:.4g} s during the motion)"


def _measure(value: float | None, unit: str) -> str:
    """Format a value of a monitor with its unit."""
    if value is None:
        return "–"
    return metres(value) if unit == "m" else f"{value:.3g} {unit}"


def _cost_rows(summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    counts = [f"{summary[key]:,} {key}" for key in ("blocks", "joints", "steps") if summary.get(key) is not None]
    if not counts:
        return []
    wall, cpu = summary.get("solve_seconds"), summary.get("solve_cpu_seconds")
    if wall is not None and cpu is not None and abs(cpu - wall) > _ELSEWHERE * wall:
        counts.insert(0, f"{seconds(wall)} ({seconds(cpu)} of CPU)")
    elif wall is not None:
        counts.insert(0, seconds(wall))
    return [("solved in", " · ".join(counts))]


def limit_answer(summary: Mapping[str, Any], folder: Path | None = None) -> str:
    """Format the result of a limit analysis."""
    limits = summary["limit_analysis"]
    rows = [] if summary["status"] == "ok" else [("status", str(summary["status"]))]
    rows += limit_rows(limits)
    if limits["heads"] == "frictionless":
        rows.append(("head joints", "without friction"))
    rows += _cost_rows(summary)
    rows += [("warning", text) for text in summary.get("warnings", ())]
    if folder is not None:
        rows.append(("written to", str(folder)))
    return "\n".join([str(summary["title"]), *(f"  {label:<14} {text}" for label, text in rows)])


def show(lines: str) -> None:
    """Print the answer on stdout."""
    print(printable(lines), flush=True)


def note(line: str, quiet: bool = False) -> None:
    """Print a remark on stderr."""
    if not quiet:
        print(printable(line), file=sys.stderr, flush=True)
