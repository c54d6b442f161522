"""Work-precision diagrams of time histories over the step: a block that rocks, and two shaken structures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bench import diagrams
from bench.cases import FOLDER
from bench.record import BenchOptions, GroupResult, Measurement, record
from bench.table import count, lines_of, percent, seconds
from bench.timing import TimedTask, in_turn
from dem_cli.app import api
from dem_cli.core.records.history_rows import Samples
from dem_cli.core.records.ports import Observer

MARGINS = (0.9, 0.5, 0.25, 0.1, 0.05)  # of the largest stable step
USUAL = 0.25
FINEST = 0.02  # of the runs that errors of shaken structures refer to
QUICK_MARGINS = (0.5, USUAL)
LONG = 0.5  # s: what takes longer is measured once
LANDINGS = (0.39088807, 0.79862462, 1.06101466)  # s, of Housner's block 0.5 m × 1 m let go at 0.25 rad
STIFFNESS = (2e8, 2e9, 2e10, 2e11)  # Pa/m, of the block
WEIGHT_OVER_AREA = 2000.0 * 9.81 * 1.0  # Pa, of the block on its joint
EDGE = 0.5  # m, its smallest edge
EVERY = 0.01  # s, between the instants at which histories are compared
DASHPOTS = {"dashpots": [], "no dashpots": ["damping={ none = true }"]}
BLOCK, SHAKEN_FILES = "block", {"column": "shaken_column", "arch": "shaken_arch"}


class FirstMonitor(Observer):
    """An observer that keeps the first monitor."""

    def __init__(self) -> None:
        self.parts: list[Samples] = []

    def samples(self, samples: Samples) -> None:
        """Keep them; not those after the motion."""
        if not samples.coda:
            self.parts.append(samples)

    @property
    def times(self) -> np.ndarray:
        """[s], (n,)."""
        return np.concatenate([part.times for part in self.parts])

    @property
    def values(self) -> np.ndarray:
        """(n,)."""
        return np.concatenate([part.monitors[:, 0] for part in self.parts])


@dataclass(frozen=True)
class StepStudy:
    """One structure and setting, for which the step varies."""

    axis: str
    case: str
    file: str
    overrides: tuple[str, ...]

    def job(self, margin: float) -> TimedTask:
        """The run with a step of that share of the largest stable one."""
        loaded = api.load_case(FOLDER / f"{self.file}.toml", [*self.overrides, f"analysis.margin={margin}"])
        model = api.build_model(loaded)

        def run() -> tuple[dict[str, Any], FirstMonitor]:
            from dem_cli.analyses.solve import solve as solve

            history = FirstMonitor()
            return solve(loaded.case, model, history).summary, history

        return TimedTask(run)


def lines(quick: bool) -> Iterator[StepStudy]:
    """All lines of the pictures."""
    for kn in STIFFNESS[1:2] if quick else STIFFNESS:
        yield StepStudy(BLOCK, f"kn·h/W {kn * EDGE / WEIGHT_OVER_AREA:.0e}", "rocking", (f"joints.dry.kn={kn!r}",))
    shorter = ("analysis.duration=1.5",) if quick else ()
    for axis, file in SHAKEN_FILES.items():
        for name, overrides in DASHPOTS.items():
            yield StepStudy(axis, name, file, (*overrides, *shorter))


def measure(options: BenchOptions) -> GroupResult:
    """One record per line and step."""
    found = GroupResult()
    wanted = list(lines(options.quick))
    margins = QUICK_MARGINS if options.quick else MARGINS
    jobs = [(line, margin, line.job(margin)) for line in wanted for margin in margins]
    for line in wanted:
        line.job(MARGINS[0]).run()  # kernels compiled or loaded, so that nobody's time holds that
    in_turn([job for *_, job in jobs], options.rounds(2), LONG)
    finest = {line: _finest(line, options.quick) for line in wanted if line.axis != BLOCK}
    for line, margin, job in jobs:
        summary, history = job.result
        said: dict[str, Any] = {"steps": summary["steps"], "closure": summary["energy_closure"]}
        if line.axis == BLOCK:
            said["error"] = landing_error(history.times, history.values)
        else:
            reference = finest[line]
            said["error"] = distance(history, reference)
            said["peak"] = float(np.abs(history.values).max() / np.abs(reference.values).max() - 1.0)
        found.records.append(record(line.case, line.axis, margin, job.seconds, **said))
    return found


def _finest(line: StepStudy, quick: bool) -> FirstMonitor:
    """The history that others are compared with."""
    history: FirstMonitor = line.job(0.5 * USUAL if quick else FINEST).run()[1]
    return history


def landing_error(times: np.ndarray, angles: np.ndarray) -> float | None:
    """Largest relative error of the times at which the block lands; None: it did not land as often."""
    at = np.flatnonzero(angles[:-1] * angles[1:] < 0.0)
    share = angles[at] / (angles[at] - angles[at + 1])
    landed = times[at] + share * (times[at + 1] - times[at])
    if len(landed) < len(LANDINGS):
        return None
    return float(np.abs(landed[: len(LANDINGS)] / LANDINGS - 1.0).max())


def distance(history: FirstMonitor, reference: FirstMonitor) -> float:
    """Root mean square of the difference of two histories, over that of the second."""
    at = np.arange(0.0, min(history.times[-1], reference.times[-1]), EVERY)
    mine, other = (np.interp(at, h.times, h.values) for h in (history, reference))
    return float(np.sqrt(((mine - other) ** 2).mean() / (other**2).mean()))


def page(records: list[Measurement]) -> list[str]:
    """A table per structure: steps against settings."""
    text = (
        "`analysis.margin`: the time step over the largest stable one; the default is bold. CPU seconds are of the"
        " whole run: ground motion, coming to rest and the motion itself. Energy: what is missing in the books, over"
        f" the largest energy. What takes longer than {LONG:g} s is measured once."
    )
    about = {
        BLOCK: "A block of 0.5 m × 1 m is let go at 0.25 rad (`cases/verification/rocking_free.toml`), on joints of"
        " four stiffnesses. Error: the worst of the times of its first three landings against Housner's block, exact.",
        "column": "Eight blocks under an artificial record of 10 s, which they rock under, with dashpots of 0.35 of"
        " critical and with none. Error: root mean square of the difference of the top's motion from a run with"
        f" {FINEST:g} of the stable step, over that motion; then that of its peak.",
        "arch": "The semicircular arch of `cases/verification/portal.toml` under such a record:"
        " rotation of a column, measured in the same way.",
    }
    found = [text]
    for axis, words in about.items():
        chosen = [r for r in records if r.axis == axis]
        if chosen:
            found += ["", f"**{axis}.** {words}", "", *_table(chosen)]
    chance = (
        "With dashpots the histories converge. Without any, blocks that land lose nothing but by friction, every joint"
        " clatters on, and a motion hangs on chance: no step makes two runs alike, although the energy of each closes."
    )
    return [*found, "", chance, "", *_rates(records)]


def _table(records: list[Measurement]) -> list[str]:
    cells = {(r.value, r.case): _cell(r) for r in records}
    cases = list(dict.fromkeys(r.case for r in records))
    rows = [
        (f"**{margin:g}**" if margin == USUAL else f"{margin:g}", *(cells.get((margin, case), "") for case in cases))
        for margin in dict.fromkeys(r.value for r in records)
    ]
    return lines_of(("margin", *cases), rows)


def _cell(r: Measurement) -> str:
    error, peak = r.found["error"], r.found.get("peak")
    text = "no answer" if error is None else percent(error).removeprefix("+")
    text += "" if peak is None else f", peak {percent(peak)}"
    return f"{text} · energy {abs(r.found['closure']):.0e} · {seconds(r.best)}"


def _rates(records: list[Measurement]) -> list[str]:
    """Steps per second of each line: those between its finest and its coarsest run, over the time that they took."""
    rows = []
    for axis, case in dict.fromkeys((r.axis, r.case) for r in records):
        mine = sorted((r for r in records if (r.axis, r.case) == (axis, case)), key=lambda r: r.found["steps"])
        more, longer = mine[-1].found["steps"] - mine[0].found["steps"], mine[-1].best - mine[0].best
        rate = count(1000 * round(more / longer / 1000)) if longer > 0.0 else "–"
        rows.append((axis, case, count(mine[0].found["steps"]), count(mine[-1].found["steps"]), rate))
    head = ("structure", "setting", "steps, coarsest", "steps, finest", "steps per second")
    return ["Steps per second, from the difference of the finest and the coarsest run:", "", *lines_of(head, rows)]


def picture(records: list[Measurement], path: Path) -> None:
    """A panel per structure, a line per setting, along the steps."""
    panels: dict[str, dict[str, list[tuple[float, float | None]]]] = {}
    for r in records:
        panels.setdefault(r.axis, {}).setdefault(r.case, []).append((r.best, r.found["error"]))
    diagrams.work_precision(path, panels)


PICTURES = {"time_histories": picture}
