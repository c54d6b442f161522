"""Made-up structures and frames, so that output and pictures are tested without a solver."""

from __future__ import annotations

import numpy as np

from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import ContactRecord, Frame
from dem_cli.core.records.history_rows import Energy, HistoryRow

LENGTH, HEIGHT, DEPTH, DENSITY = 0.040, 0.0175, 0.080, 2143.0


def wall_model(courses: int = 6, per_course: int = 3) -> Model:
    """Running-bond wall of equal blocks on a fixed base; even courses end in half blocks."""
    boxes = [(-LENGTH / 2, -HEIGHT, LENGTH * (per_course + 1), HEIGHT, True)]
    for i in range(courses):
        edges = [0.0, *[LENGTH * (k + (0.5 if i % 2 else 1.0)) for k in range(per_course)]]
        edges = edges[: per_course + 1] if i % 2 == 0 else [*edges, LENGTH * per_course]
        boxes += [(a, i * HEIGHT, b - a, HEIGHT, False) for a, b in zip(edges, edges[1:])]
    return boxes_model(boxes)


def boxes_model(boxes: list[tuple[float, float, float, float, bool]]) -> Model:
    """Rectangles (x, y, width, height, fixed), one block each."""
    n = len(boxes)
    x, y, b, h = (np.array([box[i] for box in boxes]) for i in range(4))
    corners = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
    vertices = np.concatenate([corners * (b[i], h[i]) for i in range(n)])
    masses = DENSITY * DEPTH * b * h
    dead = np.zeros((n, 3))
    dead[:, 1] = -9.81 * masses
    return Model(
        dimension=2,
        block_ids=tuple(f"wall-{i}" for i in range(n)),
        material_names=("peperino",),
        block_material=np.zeros(n, dtype=np.int64),
        fixed=np.array([box[4] for box in boxes]),
        thickness=np.full(n, DEPTH),
        masses=masses,
        inertias=(masses * (b * b + h * h) / 12)[:, np.newaxis],
        centroids=np.stack((x + b / 2, y + h / 2), axis=1),
        part_blocks=np.arange(n, dtype=np.int64),
        part_starts=np.arange(0, 4 * n + 1, 4, dtype=np.int64),
        vertices=vertices,
        dead_loads=dead,
        live_loads=np.zeros((n, 3)),
    )


def bed_contacts(model: Model, positions: np.ndarray, angles: np.ndarray, load: float) -> ContactRecord:
    """Two points for every bed joint, forces from the weight above, states from the motion."""
    c = model.centroids
    half = np.array([np.ptp(model.vertices[4 * i : 4 * i + 4], axis=0) / 2 for i in range(model.n_blocks)])
    rows = []
    for a in range(model.n_blocks):
        for b in range(model.n_blocks):
            low, high = (
                max(c[a, 0] - half[a, 0], c[b, 0] - half[b, 0]),
                min(c[a, 0] + half[a, 0], c[b, 0] + half[b, 0]),
            )
            if abs(c[b, 1] - half[b, 1] - c[a, 1] - half[a, 1]) < 1e-9 and high - low > 1e-9:
                rows += [(a, b, x - c[a, 0], half[a, 1], x) for x in (low, high)]
    a, b = (np.array([row[i] for row in rows], dtype=np.int64) for i in (0, 1))
    arm = np.array([(row[2], row[3]) for row in rows])
    cos, sin = np.cos(angles[a]), np.sin(angles[a])
    points = positions[a] + np.stack((cos * arm[:, 0] - sin * arm[:, 1], sin * arm[:, 0] + cos * arm[:, 1]), axis=1)
    top = c[:, 1].max() + HEIGHT
    weight = DENSITY * 9.81 * DEPTH * LENGTH / 4 * (top - c[b, 1])
    lean = np.where(arm[:, 0] > 0, 1.0 + load, 1.0 - load)
    gaps = np.linalg.norm(positions[b] - c[b] - positions[a] + c[a], axis=1) * np.where(arm[:, 0] < 0, 1.0, 0.0)
    opened = gaps > 5e-5
    normal = np.where(opened, 0.0, weight * lean)
    slips = np.abs((positions[b] - c[b] - positions[a] + c[a])[:, 0])
    state = np.where(opened, 0, np.where(slips > 1e-4, 2, 1)).astype(np.int8)
    return ContactRecord(
        joint=np.arange(len(rows), dtype=np.int64) // 2,
        blocks=np.stack((a, b), axis=1),
        points=points,
        normals=np.stack((-sin, cos), axis=1),
        normal_force=normal,
        shear_force=-(load * normal)[:, np.newaxis],
        gap=gaps,
        slip=slips,
        state=state,
    )


def no_contacts(dimension: int = 2) -> ContactRecord:
    """A frame in which nothing touches."""
    d = dimension
    whole, real = np.zeros(0, dtype=np.int64), np.zeros(0)
    shapes = np.zeros((0, d))
    return ContactRecord(
        whole,
        np.zeros((0, 2), dtype=np.int64),
        shapes,
        shapes,
        real,
        np.zeros((0, d - 1)),
        real,
        real,
        np.zeros(0, dtype=np.int8),
    )


def wall_frames(model: Model, n_frames: int = 12, last: float = 0.02) -> list[Frame]:
    """Gravity, loading to 0.64, then a collapse in which the upper left triangle slides and turns."""
    frames = []
    movers = ~model.fixed & (model.centroids[:, 1] + 0.6 * model.centroids[:, 0] > 0.065)
    for i in range(n_frames):
        stage = "gravity" if i == 0 else "loading" if i < n_frames // 2 else "collapse"
        load = 0.0 if i == 0 else min(0.64, 0.64 * i / (n_frames // 2 - 1)) if stage == "loading" else 0.64 - 0.01 * i
        d = 1e-6 * i if stage != "collapse" else last * (i - n_frames // 2 + 1) / (n_frames - n_frames // 2)
        grade = (model.centroids[:, 1] / model.centroids[:, 1].max()) * movers
        angles = -2.0 * d * grade * (model.centroids[:, 0] > 0.06) / 0.1
        positions = model.centroids + np.stack((d * grade, 0.05 * d * grade), axis=1)
        velocities = np.stack((grade, 0.05 * grade, angles), axis=1)
        contacts = no_contacts() if i == 1 else bed_contacts(model, positions, angles, load)
        if i % 3 == 2:
            contacts = ContactRecord(*(column[2 * i :] for column in contacts))
        frames.append(Frame(stage, 100 * i, load, d, positions, angles[:, np.newaxis], velocities, contacts))
    return frames


def history_rows(frames: list[Frame], per_frame: int = 10, n_monitors: int = 1) -> list[HistoryRow]:
    """Rows between the frames, linear in load and displacement."""
    rows, old = [], frames[0] if frames else None
    for frame in frames:
        for k in range(1, per_frame + 1):
            t = k / per_frame
            load = old.load + t * (frame.load - old.load)
            d = old.displacement + t * (frame.displacement - old.displacement)
            energy = Energy(1e-6 * d, 1e-4 * load, 0.2 * d, 0.5 * load * d, 0.2 * load * d, 0.05 * load * d, 0.0)
            rows.append(HistoryRow(frame.stage, old.step + k, load, d, 1e-5, 1e-9, energy, (d,) * n_monitors))
        old = frame
    return rows


def wall_summary(status: str = "ok") -> dict[str, object]:
    """What a pushover of the wall would say."""
    return {
        "title": "21-block opus quadratum wall",
        "kind": "pushover",
        "version": "0.1.0",
        "status": status,
        "failure_load": 0.6402,
        "failure_load_bracket": [0.6395, 0.6409],
        "failure_mode": "mixed",
        "displacement_at_failure": 5e-6,
        "limit_analysis": {"associated": 0.652, "non_associated": 0.6405},
        "blocks": 22,
        "joints": 50,
        "contacts": 100,
        "steps": 12345,
        "time_step": 1e-5,
        "solve_seconds": 0.1,
        "wall_seconds": 0.4,
        "energy_closure": 1e-9,
        "warnings": [],
    }
