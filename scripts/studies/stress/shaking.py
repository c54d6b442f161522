"""Time histories: rest and sliding limit for a long time, books of the energy, free flight, what must not matter."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from dem_cli.analyses.solve import solve
from studies.observer import RunKeeper
from studies.polygons import rectangle
from studies.stress.structures import StressScene, block, drawn, ground
from studies.stress.verdicts import HELD, WRONG, StressRecord, figure

AXIS = "time histories"
GRAVITY, FRICTION = 9.81, 0.4


def shake(scene: StressScene) -> tuple[dict[str, Any], RunKeeper, Any]:
    """Summary, what was observed, and the model."""
    case, model, _ = scene.build()
    history = RunKeeper()
    return solve(case, model, history).summary, history, model


def scene(name: str, blocks: list[dict], duration: float, **tables: Any) -> StressScene:
    """Blocks on the ground under a motion; `tables` adds tables or replaces them."""
    made = drawn(name, [ground(3.0), *blocks], 0.0, FRICTION).joint(kn=1e9)
    first = {
        "analysis": {"kind": "time-history", "duration": duration, "margin": 0.5},
        "monitor": [{"block": blocks[-1]["id"], "component": "x"}],
        "output": {"frames": 0, "rate": 500.0},
    }
    return replace(made, tables={**made.tables, **first, **tables})


def column(n: int = 6) -> list[dict]:
    return [block(f"b{i}", rectangle(0, 0.3 * i, 0.5, 0.3 * i + 0.3)) for i in range(n)]


def shaken(short: bool) -> Iterator[StressRecord]:
    """Drift at rest and below the sliding limit, books, momenta of a collision, rates of output."""
    seconds = 2.0 if short else 20.0
    still = scene("column of 6, undamped, no motion", column(), seconds, damping={"none": True})
    _, history, _ = shake(still)
    values, energy = history.values, history.rows[-1].energy
    yield figure(AXIS, still.name, "drift in blocks", float(np.ptp(values)) / 0.3, 1e-9)
    yield figure(AXIS, still.name, "kinetic over elastic energy", energy.kinetic / energy.elastic, 1e-12)
    yield from creep(seconds)
    yield closing()
    yield from collision()
    yield looks()


def creep(seconds: float) -> Iterator[StressRecord]:
    """A block on a table that shakes it with 95 % of what it needs to slide (Newmark: it never does)."""
    motion = {"kind": "harmonic", "amplitude": 0.95 * FRICTION * GRAVITY, "frequency": 3.0, "cycles": 3 * seconds}
    motion["ramp"] = 0.5
    low = scene("block at 95 % of its sliding limit", [block("b", rectangle(0, 0, 2, 0.2))], seconds, motion=motion)
    _, history, _ = shake(low)
    last = float(history.values[-1, 0])
    yield figure(AXIS, low.name, "drift in blocks", abs(last) / 0.2, 1e-6)
    energy = history.rows[-1].energy
    yield figure(AXIS, low.name, "friction work over elastic energy", energy.friction / energy.elastic, 1e-12)


def closing() -> StressRecord:
    """Energy error of a column that bounces and rocks, while the step is halved twice."""
    motion = {"kind": "pulse", "shape": "sine", "amplitude": 3.0, "frequency": 3.0}
    errors = []
    for margin in (0.4, 0.2, 0.1):
        case = scene("", column(), 1.0, damping={"none": True}, motion=motion).having("analysis.margin", margin)
        errors.append(abs(shake(case)[0]["energy_closure"]))
    order = float(np.log2(errors[0] / errors[-1]) / 2.0)
    said = ", ".join(f"{error:.1e}" for error in errors)
    return StressRecord(
        AXIS, "column of 6, undamped, pulse", "energy", HELD if order > 1.5 and errors[-1] < 1e-3 else WRONG,
        f"order {order:.2f}", errors[-1], f"order {order:.2f}", f"errors {said}",
    )  # fmt: skip


def collision() -> Iterator[StressRecord]:
    """Two blocks that meet in flight, without gravity."""
    blocks = [block("a", rectangle(0, 0, 0.5, 0.3)), block("b", rectangle(1, 0, 1.4, 0.4))]
    for name, damping in (("undamped", {"none": True}), ("with dashpots", {"contact_fraction": 1.0})):
        flight = scene(
            f"two blocks in flight, {name}", blocks, 0.6, damping=damping, gravity=0.0, output={"frames": 8},
            initial=[
                {"block": "a", "displacement": [0.0, 5.0], "velocity": [2.0, 0.1, 0.3]},
                {"block": "b", "displacement": [0.0, 5.1]},
            ],
        ).having("analysis.settle", False).having("analysis.fallen_deg", 1e6)  # fmt: skip
        _, history, model = shake(flight)
        before, after = (momenta(history.frames[i], model) for i in (0, -1))
        error = np.abs(after - before).max() / np.abs(before).max()
        yield figure(AXIS, flight.name, "momenta", float(error), 1e-11)


def momenta(frame: Any, model: Any) -> np.ndarray:
    """Linear and angular momentum of all free blocks [N s, N m s], (3,)."""
    free = ~model.fixed
    x, v, m, inertia = (a[free] for a in (frame.positions, frame.velocities, model.masses, model.inertias[:, 0]))
    turning = (m * (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]) + inertia * v[:, 2]).sum()
    return np.array([*(m[:, None] * v[:, :2]).sum(axis=0), turning])


def looks() -> StressRecord:
    """The same run with other rates and frames: the answer to the last bit."""
    motion = {"kind": "pulse", "shape": "sine", "amplitude": 6.0, "frequency": 1.5}
    answers = []
    for output in ({"frames": 0, "rate": 500.0}, {"frames": 30, "rate": 77.0}, {"frames": 0, "rate": 1e5}):
        summary, _, _ = shake(scene("", column(), 1.0, motion=motion, output=output))
        answers.append((summary["largest_displacement"], summary["energy_closure"], summary["collapse_time"]))
    worst = 0.0 if answers[0] == answers[1] == answers[2] else 1.0
    return figure(AXIS, "column of 6, pulse", "rates of output", worst, 0.0)
