"""Interactive view of a report page: blocks as polyhedra, with poses, joints and forces of each frame.

Everything has three columns, and hangs on blocks by arms in their own axes: the view can exaggerate displacements
without new numbers, and 3D needs no other view.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from dem_cli.analysis_kinds import kind_of
from dem_cli.core.geometry.rotation import beside, largest_angle_between, matrices, rotation_vectors, unturned
from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import STATES, ContactRecord, Frame
from dem_cli.results.output.paraview.vertices import in_space
from dem_cli.results.output.reader import Results
from dem_cli.results.post import frame_measures
from dem_cli.results.post import view_box as stage
from dem_cli.results.post.scene import joint_strokes
from dem_cli.results.post.scene.axonometry import axonometry, wide_side
from dem_cli.results.render.chamfered import Surface, sharp
from dem_cli.results.render.solids import prisms
from dem_cli.results.report.packed_arrays import pack

MOST_BYTES = 8_000_000  # of all frames; where there is more, frames are left out
AS_BUILT = "as built"
MODE = "mode"  # stage of frames that show natural modes
_HAIRLINE = 0.02  # joints open by less than this share of the largest displacement are faint
_FAINT = len(STATES)  # the code of these
_FAR_ROUND = 2.0  # rad: who turns farther from frame to frame may have gone the other way round
_NO_LOAD = 1e-6  # of the largest load of a run: what is less is round-off of none
_SINGLE = 0.05  # length of a joint of one point, in sizes of its block


def view(results: Results, most: int = MOST_BYTES) -> dict[str, Any]:
    """Create the scene as plain JSON, without frames in the initial geometry. most: bytes of frames."""
    model = results.model
    frames = _shown(results.frames) or [_as_built(model)]
    skin, series = SKINS[model.dimension](model), results.series
    kept = _within(most, [_bytes(model, frame) for frame in frames], _always(frames, results.summary))
    chosen = [frames[i] for i in kept]
    scales = [1.0 if frame.stage == MODE else frame_measures.visible_scale(model, frame) for frame in chosen]
    carried, grounds = stage.carried(results, min(scales)), [stage.ground(series, frame) for frame in chosen]
    moved = grounds if carried else [0.0 * each for each in grounds]
    return {
        "dimension": model.dimension,
        **STANDPOINTS[model.dimension](model, chosen, skin),
        **WINDOWS[model.dimension](model, chosen, moved),
        "size": frame_measures.size(model),
        "ids": list(model.block_ids),
        "materials": [model.material_names[i] for i in model.block_material],
        "masses": pack(model.masses),
        "fixed": pack(model.fixed),
        "centroids": pack(in_space(model.centroids)),
        "corners": pack(skin.points),
        "corner_blocks": pack(skin.owners),
        "faces": pack(skin.faces),
        "face_blocks": pack(skin.face_owners),
        "frames": [
            {**_frame(model, frame, scale), "says": _says(frame, results)}
            for frame, scale in zip(chosen, scales, strict=True)
        ],
        "left_out": len(frames) - len(chosen),
        "scale": min(scales),
        "start": _first_shown(chosen, results.summary),
        "in_seconds": kind_of(results.kind).timed,
        "modes": chosen[0].stage == MODE,
        "of_any_size": kind_of(results.kind).shapes,
        "still": chosen[0].stage == AS_BUILT,
        "ground": in_space(np.stack(grounds)).tolist(),
        "ground_moves": series is not None and bool(series.base[:, 2].any()),
        "has_joints": any(len(frame.contacts.joint) for frame in chosen),
        "carried": carried,
        "follows": not kind_of(results.kind).shapes and _close(chosen),
    }


def turns(orientations: np.ndarray) -> np.ndarray:
    """Compute rotation vectors [rad], (n, 3), of angles (n, 1) or of unit quaternions (n, 4), scalar first."""
    found = rotation_vectors(orientations)
    return found if found.shape[1] == 3 else np.column_stack((np.zeros((len(found), 2)), found))


def _shown(frames: Sequence[Frame]) -> list[Frame]:
    """Return the frames to show: of a modal analysis the modes only."""
    modes = [frame for frame in frames if frame.stage == MODE]
    return modes or list(frames)


def _as_built(model: Model) -> Frame:
    """Create a frame of the initial geometry, without joints."""
    d, n = model.dimension, model.n_blocks
    none, vectors = np.zeros(0), np.zeros((0, d))
    pairs, states = np.zeros((0, 2), dtype=np.int64), np.zeros(0, dtype=np.int8)
    contacts = ContactRecord(
        pairs[:, 0], pairs, vectors, vectors, none, np.zeros((0, d - 1)), none, none, states, np.zeros((0, 3))
    )
    still = np.zeros((n, model.inertias.shape[1] + d))
    return Frame(AS_BUILT, 0, 0.0, 0.0, model.centroids, unturned(model.n_blocks, model.dimension), still, contacts)


def _bytes(model: Model, frame: Frame) -> int:
    return 24 * model.n_blocks + 50 * len(joint_strokes.visible_strokes(frame.contacts).points)


def _always(frames: Sequence[Frame], summary: Mapping[str, Any]) -> set[int]:
    """Return the frames that are always kept: first, last, and the one that the page opens at."""
    return {0, len(frames) - 1, _first_shown(frames, summary)}


def _within(budget: int, sizes: Sequence[int], always: set[int]) -> list[int]:
    """Select every n-th frame, n as small as the budget allows, and those that must be there."""
    n = len(sizes)
    for stride in range(1, n + 1):
        kept = sorted(always | set(range(0, n, stride)))
        if sum(sizes[i] for i in kept) <= budget:
            return kept
    return sorted(always)


def _close(frames: Sequence[Frame]) -> bool:
    """Test whether the direction of rotation of every block is unambiguous from each frame to the next."""
    pairs = zip(frames, frames[1:])
    return all(largest_angle_between(a.orientations, b.orientations) < _FAR_ROUND for a, b in pairs)


def _first_shown(frames: Sequence[Frame], summary: Mapping[str, Any]) -> int:
    """Return the first frame to show: the first mode, the collapse or largest displacement, else the last frame."""
    if frames[0].stage == MODE:
        return 0
    if summary.get("collapsed"):
        at = summary.get("collapse_time") or frames[-1].time
        return int(np.abs([frame.time - at for frame in frames]).argmin())
    if summary.get("collapsed") is False:
        return int(np.argmax([frame.displacement for frame in frames]))
    return len(frames) - 1


def _frame(model: Model, frame: Frame, scale: float) -> dict[str, Any]:
    return {
        "stage": frame.stage,
        "step": frame.step,
        "load": frame.load,
        "time": frame.time,
        "displacement": frame.displacement,
        "scale": scale,
        "shifts": pack(in_space(frame.positions - model.centroids)),
        "turns": pack(turns(frame.orientations)),
        **_joints(model, frame),
        **_forces(frame),
    }


def _says(frame: Frame, results: Results) -> str:
    """Describe a frame by its frequency, its time, or its load where that changes."""
    if frame.stage == MODE:
        return f"mode {frame.step}: {results.summary['frequencies'][frame.step - 1]:.4g} Hz"
    if kind_of(results.kind).timed:
        return f"{frame.time:.3f} s"
    loads = np.abs(results.history.get("load", np.zeros(0)))
    load = frame.load if abs(frame.load) > _NO_LOAD * loads.max(initial=0.0) else 0.0
    return f"λ = {load:.4g}".replace("-", "−") if loads.any() or kind_of(results.kind).shapes else ""


def _arms(frame: Frame, points: np.ndarray, owners: np.ndarray) -> np.ndarray:
    """Convert points to the local axes of their block [m], (n, 3)."""
    turned = matrices(frame.orientations)[owners]
    return in_space(np.einsum("nji,nj->ni", turned, points - frame.positions[owners]))


def _joints(model: Model, frame: Frame) -> dict[str, Any]:
    """Create strokes along the joints, each with the state of its contact point, which colours it."""
    contacts = frame.contacts
    starts, ends, points = joint_strokes.visible_strokes(contacts)
    _, owner, counts = np.unique(contacts.joint, return_inverse=True, return_counts=True)
    alone = (counts[owner] == 1)[points]
    if alone.any():
        along = _SINGLE * np.cbrt(model.masses[contacts.blocks[:, 0]] / model.masses.max()) * frame_measures.size(model)
        tangents = beside(contacts.normals[points]) * np.where(alone, along[points], 0.0)[:, np.newaxis]
        starts, ends = starts - tangents, ends + tangents
    first = contacts.blocks[points, 0]
    hairline = _HAIRLINE * frame_measures.largest_displacement(model, frame)
    states = np.where((contacts.state == STATES.index("open")) & (contacts.gap < hairline), _FAINT, contacts.state)
    strokes = np.stack((_arms(frame, starts, first), _arms(frame, ends, first)), axis=1)
    return {
        "stroke_blocks": pack(contacts.blocks[points]),
        "strokes": pack(strokes.reshape(-1, 6)),
        "states": pack(states[points], "u1"),
    }


def _forces(frame: Frame) -> dict[str, Any]:
    """Create the resultant of each pressed joint, at its centre of pressure."""
    found = frame_measures.resultants(frame.contacts)
    return {
        "force_blocks": pack(found.blocks),
        "force_arms": pack(_arms(frame, found.points, found.blocks[:, 0])),
        "forces": pack(in_space(found.forces)),
    }


def _in_space(model: Model, frames: Sequence[Frame], skin: Surface) -> dict[str, Any]:
    """Return the initial viewpoint, the direction of the wide side for the light, and the edges of the blocks."""
    farthest = max(frames, key=lambda frame: frame.displacement)
    return {
        "eye": axonometry(model, farthest).eye.tolist(),
        "along": wide_side(model).tolist(),
        "edges": pack(skin.edges),
    }


def _window(model: Model, frames: Sequence[Frame], moved: Sequence[np.ndarray]) -> dict[str, Any]:
    """Compute the box that all frames need at true scale, carried along by the ground as it `moved`."""
    corners = [stage.corners(model, frame, 1.0, shift) for frame, shift in zip(frames, moved, strict=True)]
    return {"window": [end.tolist() for end in stage.window(model, corners, 0.0)]}


SKINS: dict[int, Callable[[Model], Surface]] = {2: prisms, 3: sharp}  # chamfers show joints where no edges are drawn
STANDPOINTS: dict[int, Callable[[Model, Sequence[Frame], Surface], dict[str, Any]]] = {
    2: lambda model, frames, skin: {},
    3: _in_space,
}
WINDOWS: dict[int, Callable[[Model, Sequence[Frame], Sequence[np.ndarray]], dict[str, Any]]] = {
    2: lambda model, frames, moved: {},
    3: _window,
}
