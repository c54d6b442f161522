"""Made-up motion in space: a column of square drums that is shaken along x, y and z, and whose upper half tumbles."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dem_cli.core.geometry.polyhedron import box
from dem_cli.core.geometry.rotation import quaternions
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import ContactRecord, Frame
from dem_cli.core.records.history_rows import Energy, HistoryRow, Samples
from dem_cli.results.output.store import ResultWriter
from synthetic import wall_summary
from synthetic.solid_runs import box_contacts
from synthetic.spatial import spatial_model

SIDE, HEIGHT, DRUMS = 0.8, 0.5, 6
DURATION, LEAVES, GRAVITY = 4.0, 2.4, 9.81  # s: how long it moves, when it breaks; m/s2
BASE = np.array([(2.0, 1.5, 0.0), (1.2, 2.3, 0.7), (0.5, 4.0, 0.3)])  # amplitude [m/s2], frequency [Hz], phase: x, y, z
SPEEDS = ((1.6, 0.9, 0.4), (0.8, 1.9, 1.0), (-0.3, 1.2, 1.6))  # [m/s] of the three drums on top
SPINS = ((-1.5, 2.6, 0.2), (-4.5, 2.0, 1.1), (-3.1, -2.2, 6.0))  # [rad/s]
MONITORS = {
    "top displacement x": "displacement",
    "top displacement y": "displacement",
    "top displacement z": "displacement",
    "top rotation": "rotation",
    "top rotation z": "rotation",
}


def column() -> Model:
    """Drums on a slab, z upwards."""
    slab = box((-2.5, -2.5, -0.3), (2.5, 2.5, 0.0))
    half = 0.5 * SIDE
    return spatial_model(
        [slab, *(box((-half, -half, HEIGHT * i), (half, half, HEIGHT * (i + 1))) for i in range(DRUMS))]
    )


def base_motion(times: np.ndarray) -> np.ndarray:
    """Acceleration, velocity and displacement, (n, 3, 3)."""
    a, w, phase = BASE[:, 0], 2.0 * np.pi * BASE[:, 1], BASE[:, 2]
    angles = w * times[:, np.newaxis] + phase
    return np.stack([a * np.sin(angles), -a * np.cos(angles) / w, -a * np.sin(angles) / w**2], axis=1)


def motion(model: Model, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Centroids, rotation vectors (of any length) and velocities of all blocks at a time [s], relative to the base."""
    n, rises = model.n_blocks, np.arange(model.n_blocks)[:, np.newaxis] / DRUMS
    sway = 0.02 * np.sin(2.0 * np.pi * np.array([1.5, 2.3, 0.0]) * time)
    positions = model.centroids + rises**2 * sway * (~model.fixed)[:, np.newaxis]
    turns, velocities = np.zeros((n, 3)), np.zeros((n, 6))
    since = max(time - LEAVES, 0.0)
    if since > 0.0:
        top = np.arange(n - 3, n)
        speed, spin = np.array(SPEEDS), np.array(SPINS)
        falls = np.array([0.0, 0.0, -0.5 * GRAVITY * since**2])
        positions[top] += speed * since + falls
        lands = positions[top, 2] < 0.5 * HEIGHT
        positions[top, 2] = np.where(lands, 0.5 * HEIGHT, positions[top, 2])
        turns[top], velocities[top] = spin * since, np.column_stack([speed - (0.0, 0.0, GRAVITY * since), spin])
    return positions, turns, velocities


def frame_at(model: Model, stage: str, step: int, time: float) -> Frame:
    """One instant; blocks that fly touch nothing."""
    positions, turns, velocities = motion(model, time)
    orientations = quaternions(turns)
    contacts = box_contacts(model, positions, orientations, 0.1)
    near = np.abs(contacts.gap) < 0.05
    far = float(np.linalg.norm(positions - model.centroids, axis=1).max())
    return Frame(
        stage, step, 0.1, far, positions, orientations, velocities,
        ContactRecord(*(column[near] for column in contacts)), time,
    )  # fmt: skip


def shaken(model: Model, n: int = 801) -> Samples:
    """The monitors of the top, at even intervals."""
    times = np.linspace(0.0, DURATION, n)
    moved = [motion(model, time) for time in times]
    places = np.array([positions[-1] - model.centroids[-1] for positions, _, _ in moved])
    turns = np.array([turned[-1] for _, turned, _ in moved])
    shorter = np.array([np.abs((angle + np.pi) % (2.0 * np.pi) - np.pi) for angle in np.linalg.norm(turns, axis=1)])
    return Samples(times, base_motion(times), np.column_stack([places, shorter, turns[:, 2]]))


def write_shaken_column(folder: Path, n_frames: int = 100) -> Path:
    """Results of a time history."""
    folder.mkdir(parents=True, exist_ok=True)
    model, names, quantities = column(), tuple(MONITORS), tuple(MONITORS.values())
    writer = ResultWriter(folder, model, "", {"dem": "0.5.0"}, names, "time-history", quantities=quantities)
    times = np.linspace(0.0, DURATION, n_frames)
    for k, time in enumerate(np.linspace(0.0, DURATION, 400)):
        grown = 30.0 * time
        energy = Energy(40.0 * np.sin(9 * time) ** 2, 2.0, 5.0 * time, grown, 0.4 * grown, 0.0, 0.0,
                        dashpots=0.45 * grown, reweighting=-0.02 * grown)  # fmt: skip
        writer.row(HistoryRow("shaking", 40 * k, 0.0, 0.01, 1e-3, 1e-9, energy, (0.0,) * len(names), time))
    writer.samples(shaken(model))
    for k, time in enumerate(times):
        writer.frame(frame_at(model, "shaking" if time < LEAVES + 0.5 else "collapse", 100 * k, float(time)))
    writer.close(shaken_summary() | writer.measured({}))
    return folder


def shaken_summary() -> dict[str, object]:
    """What the time history would say."""
    return {
        "title": "Column of drums on a shaking table", "kind": "time-history", "version": "0.5.0", "status": "ok",
        "collapsed": True, "collapse_time": LEAVES + 0.5, "collapse": "turned by 62°", "collapse_block": "b6",
        "ending": "collapsed", "blocks": 7, "joints": 6, "contacts": 24, "steps": 40_000, "time_step": 1e-4,
        "solve_seconds": 1.0, "wall_seconds": 1.4, "energy_closure": 1e-4, "warnings": [],
        "reweighting": {"net": -0.5, "sum": 0.9}, "energy_shares": {"friction": 0.47, "dashpots": 0.53},
    }  # fmt: skip


def write_collapse(folder: Path, n_frames: int = 60) -> Path:
    """Results of a pushover that was followed: gravity, loading, then the same fall."""
    folder.mkdir(parents=True, exist_ok=True)
    model = column()
    writer = ResultWriter(folder, model, "", {"dem": "0.5.0"}, ["top"])
    times = np.concatenate([[0.0, 0.0], np.linspace(LEAVES, DURATION, n_frames - 2)])
    stages = ["gravity", "loading", *["collapse"] * (n_frames - 2)]
    for k, (stage, time) in enumerate(zip(stages, times)):
        frame = frame_at(model, stage, 100 * k, float(time))._replace(time=0.0, load=0.1 if k else 0.0)
        energy = Energy(1.0 * k, 0.1, -5.0 * k, 2.0 * k, 1.0 * k, 0.5 * k, 0.0, reweighting=0.02 * k)
        top = float(frame.positions[-1, 0])
        writer.row(HistoryRow(stage, 100 * k, frame.load, frame.displacement, 1e-5, 1e-9, energy, (top,)))
        writer.frame(frame)
    found = {"title": "A column that tumbles", "failure_load": 0.1, "failure_load_bracket": [0.0999, 0.1001]}
    writer.close(wall_summary() | found | {"displacement_at_failure": 1e-4})
    return folder
