"""The arch under harmonic motion in another engine, Box2D: hard contacts, its own friction and impacts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from studies.chapter6.arch import ARCHES
from studies.places import CASES
from studies.template import table

PICTURES: dict[str, Any] = {}
MOTIONS = ((2.5, 1.1), (5.0, 1.5), (5.0, 2.0), (10.0, 2.0))  # frequency [Hz], a
FRICTION = 0.6
STEPS = (960, 1920)  # per second
RING = 0.08  # m: smallest edge, and how far a voussoir sinks that has fallen
EDGE = 10.0  # its length in the units of Box2D, whose tolerances are absolute
DURATION = 5.0  # s
STATIC = 0.325  # a = 1, in g


def measure() -> list[dict[str, Any]]:
    """What Box2D says of each arch, motion and step; nothing where it is not installed."""
    from importlib.util import find_spec

    if find_spec("Box2D") is None:
        return []
    from dem_cli.app import api

    case = CASES / "validation" / "arch_8_harmonic.toml"
    models = {name: api.build_model(api.load_case(case, list(more))) for name, more in ARCHES.items()}
    return [
        {"arch": name, "frequency": frequency, "a": a, "rate": rate} | shaken(model, frequency, a, rate)
        for name, model in models.items()
        for frequency, a in MOTIONS
        for rate in STEPS
    ]


def shaken(model: Any, frequency: float, a: float, rate: int) -> dict[str, float | None]:
    """Time of collapse [s], or how far the lowest voussoir sank [m]; gravity turns as it does for who moves along."""
    from bench.box2d_walls import THIN, Box2DWorld
    from bench.tilting import EngineSettings

    scale, dt, iterations = EDGE / RING, 1.0 / rate, (10, 4)
    gravity = 9.81 * scale
    setting = EngineSettings("", EDGE, gravity, dt, iterations, options=THIN)
    world = Box2DWorld(model, FRICTION, setting, RING)
    world.step(rate // 2)  # to rest
    start, sank = world.places()[:, 1], 0.0
    for step in range(int(DURATION * rate)):
        time = (step + 0.5) * dt
        base = a * STATIC * gravity * np.sin(2.0 * np.pi * frequency * time)
        world.world.gravity = (-float(base), -gravity)
        world.step(1)
        if step % 64 == 0:
            sank = float((start - world.places()[:, 1]).max()) / scale
            if sank > RING:
                return {"time": time, "sank": sank}
    return {"time": None, "sank": sank}


def values(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """What engines.md.j2 shows."""
    lines = []
    for name in ARCHES:
        cells = []
        for motion in MOTIONS:
            chosen = [row for row in rows if row["arch"] == name and (row["frequency"], row["a"]) == motion]
            cells.append(" / ".join(map(_said, chosen)))
        lines.append((name, *cells))
    head = ("", *(f"{f:g} Hz, a = {a:g}" for f, a in MOTIONS))
    return {"steps": STEPS, "ring": RING, "outcomes": table(head, lines)}


def _said(row: Mapping[str, Any]) -> str:
    return f"collapses, {row['time']:.1f} s" if row["time"] is not None else f"stands, {1e3 * row['sank']:.0f} mm lower"
