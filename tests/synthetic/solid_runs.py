"""Made-up runs of structures in space: a wall of boxes that falls out of its plane, with four points at every joint."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dem_cli.core.geometry.polyhedron import box, prism
from dem_cli.core.geometry.rotation import matrices, quaternions, tangents_of
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import ContactRecord, Frame
from dem_cli.results.output.paraview.vertices import rest_vertices
from dem_cli.results.output.store import ResultWriter
from synthetic import history_rows, wall_summary
from synthetic.spatial import spatial_model

LENGTH, DEPTH, HEIGHT = 1.0, 0.4, 0.5
_UNIT = np.eye(3)


def solid_wall(courses: int = 4, per_course: int = 3) -> Model:
    """Running bond along x on a fixed base; y is through the wall."""
    boxes = [box((-0.5, -0.3, -HEIGHT), (LENGTH * per_course + 0.5, DEPTH + 0.3, 0.0))]
    for i in range(courses):
        inner = [LENGTH * (k + (0.5 if i % 2 else 0.0)) for k in range(per_course + 1 - i % 2)]
        edges = sorted({0.0, *inner, LENGTH * per_course})
        boxes += [box((a, 0.0, HEIGHT * i), (b, DEPTH, HEIGHT * (i + 1))) for a, b in zip(edges, edges[1:])]
    return spatial_model(boxes, direction=(0.0, 1.0, 0.0))


def drum(sides: int) -> Model:
    """A regular prism upright on a slab: with seven sides a cell that VTK has no name for."""
    angles = 2.0 * np.pi * np.arange(sides) / sides
    lying = prism(np.column_stack([np.cos(angles), np.sin(angles)]), 0.0, 2.0)
    upright = lying._replace(vertices=lying.vertices @ np.array([(1, 0, 0), (0, 0, 1), (0, -1, 0)], float))
    return spatial_model([box((-2, -2, -0.5), (2, 2, 0.0)), upright])


def box_contacts(model: Model, positions: np.ndarray, orientations: np.ndarray, load: float) -> ContactRecord:
    """The corners of every rectangle that two boxes share at the start, carried by the lower-numbered block."""
    places, rows, owner = rest_vertices(model), [], 0
    corners = np.split(places, model.part_starts[1:-1])
    sides = [(part.min(axis=0), part.max(axis=0)) for part in corners]
    for a, (low_a, high_a) in enumerate(sides):
        for b, (low_b, high_b) in enumerate(sides):
            low, high = np.maximum(low_a, low_b), np.minimum(high_a, high_b)
            flat = np.flatnonzero(np.abs(high - low) < 1e-9)
            if a >= b or len(flat) != 1 or (high - low < -1e-9).any():
                continue
            k = int(flat[0])
            normal = _UNIT[k] * (1.0 if model.centroids[b, k] > model.centroids[a, k] else -1.0)
            first = _UNIT[(k + 1) % 3]
            second = np.cross(normal, first)
            size, middle = high - low, 0.5 * (low + high)
            for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                corner = middle + 0.5 * (s * abs(size @ first) * first + t * abs(size @ second) * second)
                rows.append((owner, a, b, corner, normal, first))
            owner += 1
    joint, a, b = (np.array([row[i] for row in rows]) for i in range(3))
    corner, normal, first = (np.array([row[i] for row in rows]) for i in (3, 4, 5))
    turn = matrices(orientations)
    hung = [positions[i] + np.einsum("nij,nj->ni", turn[i], corner - model.centroids[i]) for i in (a, b)]
    normal, first = (np.einsum("nij,nj->ni", turn[a], v) for v in (normal, first))
    apart = hung[1] - hung[0]
    gaps = (apart * normal).sum(axis=1)
    second = tangents_of(normal, first)[1]
    slips = np.hypot((apart * first).sum(axis=1), (apart * second).sum(axis=1))
    weight = 0.25 * model.masses[b] * 9.81 * (np.abs(normal[:, 2]) > 0.5)
    pressed = np.where(gaps > 1e-4, 0.0, weight)
    state = np.where(gaps > 1e-4, 0, np.where(slips > 1e-3, 2, 1)).astype(np.int8)
    shear = np.stack([load * pressed, -0.5 * load * pressed], axis=1)
    pairs = np.stack([a, b], axis=1)
    return ContactRecord(joint, pairs, hung[0], normal, pressed, shear, gaps, slips, state, first)


def solid_frames(model: Model, n_frames: int = 8, last: float = 0.5) -> list[Frame]:
    """Gravity, loading, then the upper half leans out along +y about its lower edge, one end more than the other."""
    moves = ~model.fixed & (model.centroids[:, 2] > 2.0 * HEIGHT)
    pivot = np.array([0.0, DEPTH, 2.0 * HEIGHT])
    frames = []
    for i in range(n_frames):
        stage = "gravity" if i == 0 else "loading" if i < n_frames // 2 else "collapse"
        load = 0.0 if i == 0 else min(0.2, 0.2 * i / max(n_frames // 2 - 1, 1))
        lean = 1e-5 * i if stage != "collapse" else last * (i + 1 - n_frames // 2) / (n_frames - n_frames // 2)
        vectors = np.where(moves, -lean, 0.0)[:, np.newaxis] * (1.0, 0.0, 0.0)
        vectors[:, 2] = np.where(moves, 0.2 * lean * (model.centroids[:, 0] > 1.5), 0.0)
        orientations = quaternions(vectors)
        arms = model.centroids - pivot
        turned = np.einsum("nij,nj->ni", matrices(orientations), arms)
        positions = np.where(moves[:, np.newaxis], pivot + turned, model.centroids)
        velocities = np.column_stack([positions - model.centroids, vectors])
        far = float(np.linalg.norm(positions - model.centroids, axis=1).max())
        contacts = box_contacts(model, positions, orientations, load)
        frames.append(Frame(stage, 100 * i, load, far, positions, orientations, velocities, contacts))
    return frames


def write_solid_run(folder: Path, model: Model, frames: list[Frame], joints_of=None) -> Path:
    """Results of a pushover in space."""
    folder.mkdir(parents=True, exist_ok=True)
    writer = ResultWriter(folder, model, "title = 'a wall in space'\n", {"dem": "0.5.0"}, ["top"])
    if joints_of is not None:
        writer.follow(joints_of)
    rows = history_rows(frames)
    for i, frame in enumerate(frames):
        for row in rows[10 * i : 10 * i + 10]:
            writer.row(row)
        writer.frame(frame)
    found = {"title": "a wall in space", "failure_load": 0.2, "failure_load_bracket": [0.1998, 0.2002]}
    writer.close(wall_summary() | found)
    return folder
