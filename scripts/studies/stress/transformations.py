"""What must not matter: order, place, mirror image, rotation of structure and gravity, units."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from studies.stress.structures import StressScene, Tables, explicit


def each_block(scene: StressScene, change: Callable[[Tables, np.random.Generator], Tables]) -> StressScene:
    """The scene, drawn by hand, with every block changed."""
    scene, rng = explicit(scene), np.random.default_rng(1)
    return replace(scene, tables={**scene.tables, "block": [change(b, rng) for b in scene.tables["block"]]})


def pieces(b: Tables) -> list[np.ndarray]:
    """The corners of the convex pieces of a block."""
    return [np.array(part, float) for part in b.get("parts") or [b["vertices"]]]


def with_pieces(b: Tables, parts: list[np.ndarray]) -> Tables:
    return {key: value for key, value in b.items() if key != "vertices"} | {"parts": [p.tolist() for p in parts]}


def each_corner(scene: StressScene, move: Callable[[np.ndarray], np.ndarray]) -> StressScene:
    """Every corner moved: (n, 2) -> (n, 2)."""
    return each_block(scene, lambda b, rng: with_pieces(b, [move(p) for p in pieces(b)]))


def blocks_in_any_order(scene: StressScene) -> StressScene:
    scene = explicit(scene)
    order = np.random.default_rng(1).permutation(len(scene.tables["block"]))
    return replace(scene, tables={**scene.tables, "block": [scene.tables["block"][i] for i in order]})


def corners_from_another(scene: StressScene) -> StressScene:
    """Each list of corners starts elsewhere."""
    return each_block(
        scene, lambda b, rng: with_pieces(b, [np.roll(p, rng.integers(len(p)), axis=0) for p in pieces(b)])
    )


def corners_clockwise(scene: StressScene) -> StressScene:
    return each_corner(scene, lambda p: p[::-1])


def corners_in_any_order(scene: StressScene) -> StressScene:
    return each_block(scene, lambda b, rng: with_pieces(b, [rng.permutation(p) for p in pieces(b)]))


def pieces_in_any_order(scene: StressScene) -> StressScene:
    """Each block cut in two, the pieces in one order or the other."""
    return each_block(scene, lambda b, rng: with_pieces(b, [*reversed(pieces(b))]))


def cut_in_two(scene: StressScene) -> StressScene:
    """Each block of two convex pieces: cut along the diagonal between its first and third corner."""

    def halves(p: np.ndarray) -> list[np.ndarray]:
        return [p] if len(p) < 4 else [p[:3], p[[0, *range(2, len(p))]]]

    return each_block(scene, lambda b, rng: with_pieces(b, [h for p in pieces(b) for h in halves(p)]))


def moved(scene: StressScene, x: float, y: float) -> StressScene:
    """Shifted [m]."""
    return each_corner(scene, lambda p: p + np.array([x, y]))


def scaled(scene: StressScene, length: float = 1.0, density: float = 1.0, gravity: float = 1.0) -> StressScene:
    """In other units of length, density and acceleration."""
    changed = each_corner(scene, lambda p: p * length) if length != 1.0 else scene
    if length != 1.0:  # every length of a scene that was given in metres
        blocks = [b | {"thickness": length * b.get("thickness", 1.0)} for b in changed.tables["block"]]
        changed = replace(changed, tables={**changed.tables, "block": blocks})
    changed = changed.material(density=density)
    return changed.having("gravity", gravity * changed.tables.get("gravity", 9.81))


def mirrored(scene: StressScene) -> StressScene:
    """The mirror image, pushed the other way."""
    changed = each_corner(scene, lambda p: p * [-1.0, 1.0])
    x, y = changed.tables["analysis"].get("direction", [1.0, 0.0])
    return changed.having("analysis.direction", [-float(x), float(y)])


def rotated(scene: StressScene, degrees: float) -> StressScene:
    """Structure, weight and live load turned together: only a model can say it, a case has its weight along −y."""
    angle = np.radians(degrees)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

    def change(model: Any) -> Any:
        def loads(given: np.ndarray) -> np.ndarray:
            return np.column_stack([given[:, :2] @ turn.T, given[:, 2:]])

        return model._replace(
            centroids=model.centroids @ turn.T,
            vertices=model.vertices @ turn.T,
            dead_loads=loads(model.dead_loads),
            live_loads=loads(model.live_loads),
        )

    return replace(scene, change=change)


def renumbered(scene: StressScene) -> StressScene:
    """Blocks, pieces and corners of the model in another order, past the sorting that a case gets."""

    def change(model: Any) -> Any:
        order = np.random.default_rng(2).permutation(model.n_blocks)
        parts = [p for new in order for p in np.flatnonzero(model.part_blocks == new)]
        rows = [np.arange(model.part_starts[p], model.part_starts[p + 1]) for p in parts]
        new_number = np.argsort(order)
        by_block = {
            name: getattr(model, name)[order]
            for name in (
                "block_material", "fixed", "thickness", "masses", "inertias", "centroids", "dead_loads", "live_loads"
            )
        }  # fmt: skip
        return model._replace(
            **by_block,
            block_ids=tuple(model.block_ids[i] for i in order),
            part_blocks=new_number[model.part_blocks[parts]],
            part_starts=np.concatenate([[0], np.cumsum([len(r) for r in rows])]),
            vertices=model.vertices[np.concatenate(rows)],
        )

    return replace(scene, change=change)
