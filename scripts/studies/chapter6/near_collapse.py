"""Shapes and rotations near failure: steady oscillation (Figure 6-11), a record near failure (6-12, 6-13)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.app import api
from dem_cli.masonry.assembly.ground_motions import motions_of
from dem_cli.results.post import style
from studies.chapter6.arch import UNIT
from studies.chapter6.shaken_case import ShakenCase, draw_blocks, run
from studies.places import CASES
from studies.storage import rounded
from studies.template import commands, table

STEPS = tuple(round(0.9 + 0.05 * k, 2) for k in range(30))  # a tried for the record, up to the first collapse
PERIOD = 0.2  # s, at 5 Hz
BEFORE = (1.5, 0.6, 0.3, 0.15, 0.0)  # [s] before the collapse of the record


def measure() -> dict[str, Any]:
    """The steady motion at 5 Hz, a = 1.5, the collapse at 2.5 Hz, and record 3 at its lowest collapse and below."""
    steady = run("arch_8_harmonic_steady", "output.frames=500")
    falls = run("arch_8_harmonic", "output.frames=500", "analysis.after_collapse=0.0", "analysis.repeats=0")
    end = falls.summary["collapse_time"] or 5.0
    stood, fell = _record()
    return {
        "steady": _picked(steady, [5.0 - PERIOD * (1.0 - k / 4) for k in range(4)])
        | {"late": _late(steady), "slid": _slid(steady)},
        "falls": _picked(falls, [0.4 * end, 0.6 * end, 0.8 * end, end]),
        "stood": {"run": stood[1].answer, "a": stood[0], "curve": _curve(stood[1])},
        "record": _picked(fell[1], [(fell[1].summary["collapse_time"] or 20.0) - before for before in BEFORE])
        | {"a": fell[0], "curve": _curve(fell[1])},
    }


def _late(found: ShakenCase) -> list[list[float]]:
    """Mean and half of the range in the last second: rotations of the right and the left column [rad], crown [m]."""
    last = found.values[found.times > found.times[-1] - 1.0, :3]
    return rounded(np.column_stack([last.mean(axis=0), np.ptp(last, axis=0) / 2.0]))


def _slid(found: ShakenCase) -> list[float]:
    """Slip of the joints of the ring [mm], mean of the last cycle: springings, then the joints beside them."""
    last = found.times > found.times[-1] - PERIOD
    return rounded(1e3 * found.values[last, 5:9].mean(axis=0), 3)


def _record() -> tuple[tuple[float, ShakenCase], tuple[float, ShakenCase]]:
    """Record 3 at the highest level below its first collapse, and at that."""
    case = api.load_case(CASES / "validation" / "arch_8_record.toml").case
    (motion,), before = motions_of(case), None
    for a in STEPS:
        found = run("arch_8_record", f"motion.scale={a * UNIT / motion.peak:.5g}", "output.frames=400")
        if before is not None and found.summary.get("collapsed") is not False:
            break
        before = (a, found)
    assert before is not None
    return before, (a, found)


def _picked(found: ShakenCase, times: Sequence[float]) -> dict[str, Any]:
    """Shapes nearest to some times."""
    near = [min(found.frames, key=lambda frame, t=t: abs(frame["time"] - t)) for t in times]
    return {"run": found.answer, "frames": near}


def _curve(found: ShakenCase) -> list[list[float]]:
    """Time, rotations of the right and the left column, crown; 25 per second."""
    every = max(1, round(0.04 / (found.times[1] - found.times[0])))
    return rounded(np.column_stack([found.times, found.values[:, :3]])[::every])


def values(found: dict[str, Any]) -> dict[str, Any]:
    """What near_collapse.md.j2 shows."""
    steady, record = found["steady"], found["record"]
    names = ("right column [mrad]", "left column [mrad]", "crown [mm]")
    rows = [
        (name, f"{1e3 * mean:.1f}", f"{1e3 * half:.1f}")
        for name, (mean, half) in zip(names, steady["late"], strict=True)
    ]
    left, right, left_haunch, right_haunch = map(abs, steady["slid"])
    stood, curve = np.array(found["stood"]["curve"]), np.array(record["curve"])
    until = curve[curve[:, 0] < record["run"]["collapse_time"] - 0.5]
    return {
        "steady": table(("", "mean", "half of the range"), rows),
        "springings": (left, right), "haunches": (left_haunch, right_haunch),
        "stood": found["stood"]["a"], "fell": record["a"], "at": record["run"]["collapse_time"],
        "block": record["run"]["collapse_block"], "how": record["run"]["collapse"],
        "rest": 1e3 * np.abs(stood[-1, 1:3]).max(), "crown": -1e3 * stood[-1, 3],
        "peak": np.abs(until[:, 1]).max(),
        "commands": commands(steady["run"], found["falls"]["run"], found["stood"]["run"], record["run"]),
    }  # fmt: skip


def draw_harmonic(found: dict[str, Any], path: Path) -> None:
    """As Figure 6-11: the steady oscillation, and the collapse at 2.5 Hz."""
    with style.figure(path, figsize=(10.0, 3.9)) as figure:
        axes = figure.subplots(2, 4)
        for row, (name, label) in zip(axes, (("steady", "5 Hz, a = 1.5"), ("falls", "2.5 Hz, a = 1.1"))):
            for axis, frame in zip(row, found[name]["frames"]):
                draw_blocks(axis, frame["blocks"], f"{label}, {frame['time']:.2f} s")


def draw_record(found: dict[str, Any], path: Path) -> None:
    """As Figure 6-12."""
    frames = found["record"]["frames"]
    with style.figure(path, figsize=(11.0, 1.9)) as figure:
        for axis, frame in zip(figure.subplots(1, len(frames)), frames):
            draw_blocks(axis, frame["blocks"], f"{frame['time']:.2f} s")


def draw_rotation(found: dict[str, Any], path: Path) -> None:
    """As Figure 6-13."""
    with style.figure(path, figsize=(9.0, 3.4)) as figure:
        axis = figure.subplots()
        for name, colour, word in (("record", style.COLLAPSE, "collapses"), ("stood", style.THRUST, "stands")):
            times, right = np.array(found[name]["curve"])[:, :2].T
            axis.plot(times, 1e3 * right, color=colour, lw=1.0, label=f"a = {found[name]['a']:g}, {word}")
        axis.axvline(found["record"]["run"]["collapse_time"], color=style.GREY, ls=":", lw=1.0)
        axis.set(xlabel="time [s]", ylabel="rotation of the right column [mrad]", xlim=(0, 20.5), ylim=(-200, 30))
        axis.legend(loc="lower left")


PICTURES = {"harmonic": draw_harmonic, "record": draw_record, "rotation": draw_rotation}
