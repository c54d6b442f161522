"""Cost of optional features, off and on."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.cases import KNOWN_STRUCTURES, SIZES, KnownStructure, solve
from bench.kernels import POINT_STEPS, blocks_of, simulation
from bench.record import BenchOptions, GroupResult, Measurement, record
from bench.table import lines_of, seconds
from bench.timing import TimedTask, in_turn
from dem_cli.core.records.frames import Frame
from dem_cli.core.records.history_rows import HistoryRow
from dem_cli.core.records.ports import Observer

if TYPE_CHECKING:
    from dem_cli.case.schema import Case
    from dem_cli.core.engine.simulation import Simulation
    from dem_cli.core.model.model import Model

PICTURES: dict[str, Any] = {}
KERNEL, RUN = "kernel", "run"
BLOCK_COUNTS, QUICK_BLOCKS = (21, 231, 2275), (21,)
CASES, QUICK_CASES = ("T21 μ 0.6", "T231"), ("T21 μ 0.6",)
BARE, LEDGER, FULL = "nothing", "ledger", "all, unused"
MONITORS = "monitor=[" + ", ".join('{block = "top-right", quantity = "rotation"}' for _ in range(10)) + "]"
PLAIN = "plain"
FOLLOW = {"T21 μ 0.6": 0.02, "T231": 0.04}  # m, as in cases/verification


@dataclass(frozen=True)
class Feature:
    """Feature of a run: something that it may do besides finding a failure load."""

    name: str
    overrides: tuple[str, ...] = ()
    observer: Callable[[Case, Model, Path], Any] | None = None  # (case, model, folder) -> an observer that is closed
    shows: str | None = None  # key of the summary without which it was not done

    def available(self) -> bool:
        """Whether case files of this version know it."""
        from dem_cli.errors import CaseError

        try:
            KNOWN_STRUCTURES["T21 μ 0.6"].build(*self.overrides)
        except CaseError:
            return False
        return True


class DiskObserver(Observer):
    """Everything goes to results.h5 and the files for ParaView, as in `dem run`."""

    def __init__(self, case: Case, model: Model, folder: Path):
        from dem_cli.case.writer import case_text
        from dem_cli.core.contact.drawn_joints import DrawnJoints
        from dem_cli.results.output.store import ResultWriter

        names = [f"monitor {i + 1}" for i in range(len(case.monitor))]
        self.writer = ResultWriter(folder, model, case_text(case), {}, names, case.analysis.kind)
        self.writer.follow(DrawnJoints)

    def frame(self, frame: Frame) -> None:
        """To all files."""
        self.writer.frame(frame)

    def row(self, row: HistoryRow) -> None:
        """To results.h5."""
        self.writer.row(row)


def features(name: str) -> tuple[Feature, ...]:
    """What is measured on a structure, the plain run first."""
    follow = f"analysis.follow={FOLLOW[name]}"
    return (
        Feature(PLAIN),
        Feature("10 monitors", (MONITORS,)),
        Feature("20 frames, kept by nobody", ("output.frames=20",)),
        Feature("20 frames and histories on disk", ("output.frames=20",), DiskObserver),
        Feature("geometry that moves", ("analysis.kinematics=large",)),
        Feature("limit analysis beside it", ("analysis.limit=true",), shows="limit_analysis"),
        Feature("collapse followed", (follow,)),
        Feature(
            "collapse followed, 10 monitors, 20 frames, on disk", (follow, MONITORS, "output.frames=20"), DiskObserver
        ),
    )


def measure(options: BenchOptions) -> GroupResult:
    """Kernels first, then whole runs."""
    found = GroupResult()
    _kernels(options, found)
    _runs(options, found)
    return found


def _kernels(options: BenchOptions, found: GroupResult) -> None:
    """ns per point and step of three stepping loops in turn: bare, with ledger, with everything."""
    rows: list[tuple[KnownStructure, str, str, TimedTask, int]] = []
    for known in SIZES:
        if blocks_of(known) in (QUICK_BLOCKS if options.quick else BLOCK_COUNTS):
            for kinematics in ("fixed",) if options.quick else ("fixed", "large"):
                sim = simulation(known, kinematics)
                restore, steps = partial(sim.restore, sim.save()), max(POINT_STEPS // len(sim.joints.kn), 10)
                for name, loop in loops(sim).items():
                    job = TimedTask(_stepping(sim, loop, steps), restore)
                    rows.append((known, kinematics, name, job, steps * len(sim.joints.kn)))
    for *_, job, _ in rows:
        job.once()  # compiles
        job.seconds.clear()
    in_turn([job for *_, job, _ in rows], options.rounds(25))
    for known, kinematics, name, job, work in rows:
        times = [1e9 * s / work for s in job.seconds]
        found.records.append(
            record(known.name, KERNEL, f"{kinematics}: {name}", times, "ns", kinematics=kinematics, has=name)
        )


def loops(sim: Simulation) -> dict[str, Callable]:
    """Stepping loops that do the same motion, by what they have."""
    from bench.bare_loop import make_bare
    from dem_cli.core.engine.loops import compiled_advance
    from dem_cli.core.kernels.contact_forces import make_contact_forces
    from dem_cli.core.kernels.drift import drift_centroids, drift_corners
    from dem_cli.core.kernels.planar_forces import make_planar_forces

    if sim.kinematics == "fixed":
        parts = (make_contact_forces(sim.law.function), drift_centroids)
    else:
        parts = (make_planar_forces(sim.law.function), drift_corners)
    full = compiled_advance(sim.kinematics, sim.law)
    return {BARE: make_bare(*parts, False), LEDGER: make_bare(*parts, True), FULL: full}


def _stepping(sim: Simulation, loop: Callable, steps: int) -> Callable[[], Any]:
    from dem_cli.core.kernels import records as slot

    return lambda: loop(
        steps, slot.HOLD_LOAD, 1.0, sim.bodies, sim.shape, sim.joints, sim.geometry, sim.contacts, sim.links,
        sim.loads, sim.control, sim.ledger, sim.like, sim.like_rotation,
    )  # fmt: skip


def _runs(options: BenchOptions, found: GroupResult) -> None:
    rows: list[tuple[str, Feature, TimedTask]] = []
    with tempfile.TemporaryDirectory() as folder:
        for name in QUICK_CASES if options.quick else CASES:
            for feature in features(name)[: 4 if options.quick else None]:
                if feature.available():
                    rows.append((name, feature, _run(KNOWN_STRUCTURES[name], feature, Path(folder) / str(len(rows)))))
                elif name == QUICK_CASES[0]:
                    found.notes.append(f"{feature.name}: not in this version")
        in_turn([job for *_, job in rows], options.rounds(5))
    for name, feature, job in rows:
        if feature.shows is None or job.result.get(feature.shows):
            found.records.append(record(name, RUN, feature.name, job.seconds, steps=job.result["steps"]))
        else:
            found.notes.append(f"{feature.name}, {name}: left out, the run's summary has no {feature.shows}")


def _run(known: KnownStructure, feature: Feature, folder: Path) -> TimedTask:
    case, model = known.build(*feature.overrides)

    def run() -> dict[str, Any]:
        if feature.observer is None:
            return solve(case, model)
        folder.mkdir(exist_ok=True)
        disk = feature.observer(case, model, folder)
        summary = solve(case, model, disk)
        disk.writer.close(summary)
        return summary

    return TimedTask(run)


def page(records: list[Measurement]) -> list[str]:
    """A table of kernels and one of runs."""
    kernels, runs = [r for r in records if r.axis == KERNEL], [r for r in records if r.axis == RUN]
    return [*KERNEL_TEXT, "", *_kernel_table(kernels), "", *RUN_TEXT, "", *_run_table(runs)]


def _kernel_table(records: list[Measurement]) -> list[str]:
    best = {(r.case, r.found["kinematics"], r.found["has"]): r.best for r in records}
    rows = []
    for case, kinematics in dict.fromkeys((r.case, r.found["kinematics"]) for r in records):
        bare, ledger, full = (best[case, kinematics, has] for has in (BARE, LEDGER, FULL))
        times = (f"{time:.2f}" for time in (bare, ledger, full))
        rows.append((case, kinematics, *times, f"{ledger / bare:.2f}", f"{full / ledger:.3f}"))
    head = ("structure", "geometry", "bare", "with ledger", "the program's", "ledger on", "features off")
    return lines_of(head, rows)


def _run_table(records: list[Measurement]) -> list[str]:
    cases = list(dict.fromkeys(r.case for r in records))
    plain = {r.case: r.best for r in records if r.value == PLAIN}
    cells = {(r.value, r.case): f"{r.best / plain[r.case]:.2f} · {seconds(r.best)}" for r in records}
    rows = [
        (name, *(cells.get((name, case), "") for case in cases)) for name in dict.fromkeys(r.value for r in records)
    ]
    return lines_of(("on", *cases), rows)


KERNEL_TEXT = """\
CPU ns per contact point and step of three loops: a *bare* one that can do nothing but hold a load, the same with the
energy ledger (which the program always keeps: the proof of failure needs it), and the program's own, which can also
prescribe rates, tilt gravity, steer by FIRE, damp in combination, move supports and limit speeds, and does none of it
here. *Ledger on* is the ratio of the second to the first, *features off* that of the third to the second (≤ 1.05 is
wanted).""".splitlines()
RUN_TEXT = """\
Whole runs: CPU time over that of the plain run · CPU seconds. In the plain run all of these are off and none of their
code is called; what that costs is in the table above.""".splitlines()
