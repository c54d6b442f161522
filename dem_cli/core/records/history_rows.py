"""Rows of a history, samples of monitors, the energy balance and the rows of many runs, as solvers return them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

NO_EXTREMES = np.zeros((0, 4))
MONITOR_UNITS = {  # by what is followed
    "displacement": "m",
    "rotation": "rad",
    "opening": "m",
    "slip": "m",
    "velocity": "m/s",
    "acceleration": "m/s2",
    "force": "N",
    "elongation": "m",
    "reaction": "N",
    "reaction_moment": "N m",
    "normal_force": "N",
    "shear_force": "N",
    "moment": "N m",
    "shear_force_across": "N",
    "moment_across": "N m",
    "torsion": "N m",
    "drift": "rad",
}
MONITOR_UNITS |= {f"absolute {name}": MONITOR_UNITS[name] for name in ("displacement", "velocity", "acceleration")}


class Energy(NamedTuple):
    """Energy balance [J], since the start of the run; external: applied loads without gravity."""

    kinetic: float
    elastic: float
    gravity: float
    external: float
    friction: float
    damping: float  # local and numerical damping
    supports: float  # work done by prescribed motions
    dashpots: float = 0.0  # taken by viscous joints
    mass_damping: float = 0.0
    maxwell: float = 0.0  # taken by Maxwell elements of joints
    reweighting: float = 0.0  # taken as the areas of contact points changed in space; minus: made


class HistoryRow(NamedTuple):
    """Row of the load history; rows are written in the order in which they come."""

    stage: str
    step: int
    load: float
    displacement: float
    unbalanced: float  # largest unbalanced force on a block over its own weight
    overlap: float  # largest overlap [m]
    energy: Energy
    monitors: tuple[float, ...]  # in the order of SolverRequest.monitors
    time: float = 0.0  # since the start of a time history [s]
    live_displacement: float = 0.0  # of the live load along itself since it rested under dead loads [m], signed


class Samples(NamedTuple):
    """Samples of a stretch of a time history, at even intervals."""

    times: np.ndarray  # [s], (n,)
    base: np.ndarray  # acceleration, velocity and displacement of the base [m, s], (n, 3, d)
    monitors: np.ndarray  # in the order of SolverRequest.monitors, (n, n_monitors)
    # Highest value, its time [s], lowest, its time of each monitor at any step, (n_monitors, 4); (0, 4): of samples
    extremes: np.ndarray = NO_EXTREMES
    coda: bool = False  # whether the motion of the ground, or the time that a case asks for, was over


class RunRow(NamedTuple):
    """Outcome of one of many runs."""

    structure: int  # 0: the given one; others are slightly different
    record: str  # the ground motion
    intensity: float
    acceleration: float  # peak of the ground [m/s2]
    collapsed: bool | None  # None: the run failed
    time: float | None  # of the collapse [s]
    how: str  # what collapsed and how, or why the run failed
    peaks: tuple[float, ...]  # largest absolute values, as the [[monitor]] tables are; nan: it means nothing
