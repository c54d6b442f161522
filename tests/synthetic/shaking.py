"""A made-up time history: a wall that rocks on a base under harmonic motion and falls over in the end."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import Frame
from dem_cli.core.records.history_rows import Energy, HistoryRow, Samples
from dem_cli.results.output.store import ResultWriter
from synthetic import LENGTH, bed_contacts, wall_model

DURATION, AMPLITUDE, FREQUENCY, COLLAPSE = 5.0, 3.0, 2.0, 4.2  # s, m/s2, Hz, s
MONITORS = {
    "top displacement x": "displacement",
    "top displacement y": "displacement",
    "top acceleration x": "acceleration",
    "foot opening": "opening",
    "top rotation": "rotation",
}


def base_motion(times: np.ndarray) -> np.ndarray:
    """Acceleration, velocity and displacement, (n, 3, 2)."""
    w = 2.0 * np.pi * FREQUENCY
    out = np.zeros((len(times), 3, 2))
    a = AMPLITUDE
    out[:, :, 0] = a * np.stack([np.sin(w * times), -np.cos(w * times) / w, -np.sin(w * times) / w**2], axis=1)
    return out


def angle(times: np.ndarray) -> np.ndarray:
    """Rocking that grows, then overturning to the right."""
    return -0.02 * times * np.sin(9.0 * times) ** 2 - 1.2 * np.clip(times - COLLAPSE, 0.0, None) ** 2


def shaken(n: int = 1001, n_monitors: int = len(MONITORS)) -> Samples:
    """A history at even intervals; the first monitor is a displacement, others are multiples of it."""
    times = np.linspace(0.0, DURATION, n)
    values = np.stack([(-0.5) ** i * 0.1 * angle(times) for i in range(n_monitors)], axis=1)
    return Samples(times, base_motion(times), values.reshape(n, n_monitors))


def shaking_frames(model: Model, n_frames: int = 30) -> list[Frame]:
    """The whole wall turns about its lower right corner."""
    free = ~model.fixed
    corner = np.array([3.0 * LENGTH, 0.0])
    frames = []
    for k, time in enumerate(np.linspace(0.0, DURATION, n_frames)):
        turn = float(angle(np.array([time]))[0])
        rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        positions = np.where(free[:, None], corner + (model.centroids - corner) @ rotation.T, model.centroids)
        angles = np.where(free, turn, 0.0)
        moved = float(np.abs(positions - model.centroids).max())
        contacts = bed_contacts(model, positions, angles, 0.2)
        stage = "gravity" if k == 0 else "shaking"
        frames.append(
            Frame(stage, 400 * k, 0.0, moved, positions, angles[:, None], np.zeros((len(free), 3)), contacts, time)
        )
    return frames


def shaking_rows(frames: list[Frame], per_frame: int = 10) -> list[HistoryRow]:
    """The ledger in between."""
    rows = []
    for time in np.linspace(0.0, DURATION, per_frame * len(frames)):
        grown = 0.3 * time
        energy = Energy(0.1 * np.sin(9 * time) ** 2, 0.02, 0.05 * time, grown, 0.4 * grown, 0.02 * grown, 0.0,
                        dashpots=0.45 * grown, mass_damping=0.1 * grown)  # fmt: skip
        stage = "gravity" if time == 0.0 else "shaking"
        rows.append(HistoryRow(stage, int(80 * time), 0.0, 0.01, 1e-3, 1e-9, energy, (0.0,) * len(MONITORS), time))
    return rows


def shaking_summary() -> dict[str, object]:
    """What the time history would say."""
    return {
        "title": "Wall on a shaking table", "kind": "time-history", "version": "0.1.0", "status": "ok",
        "collapsed": True, "collapse_time": COLLAPSE, "blocks": 22, "joints": 50, "contacts": 100, "steps": 12345,
        "time_step": 1e-5, "solve_seconds": 0.1, "wall_seconds": 0.4, "energy_closure": 1e-6, "warnings": [],
        "energy_shares": {"friction": 0.4, "dashpots": 0.45, "mass_damping": 0.1, "damping": 0.05},
    }  # fmt: skip


def write_shaking(folder: Path, n_frames: int = 30) -> Path:
    """Results of the whole run."""
    model = wall_model()
    frames = shaking_frames(model, n_frames)
    names, quantities = tuple(MONITORS), tuple(MONITORS.values())
    writer = ResultWriter(folder, model, "", {}, names, "time-history", quantities=quantities)
    for row in shaking_rows(frames):
        writer.row(row)
    writer.samples(shaken())
    for frame in frames:
        writer.frame(frame)
    writer.close({**shaking_summary(), **writer.measured({})})
    return folder
