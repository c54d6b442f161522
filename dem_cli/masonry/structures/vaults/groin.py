"""Generate groin (cross) vaults: two barrels over a bay that meet in its diagonal planes, on four corners."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dem_cli.case.base import KeyProblem
from dem_cli.core.geometry.frusta import frustum, skewed
from dem_cli.core.geometry.polyhedron import Polyhedron, box
from dem_cli.core.model.blocks import Block
from dem_cli.masonry.structures.arch import Pier
from dem_cli.masonry.structures.vaults.profile import side_of_crown
from dem_cli.masonry.structures.vaults.table import Vault
from dem_cli.masonry.structures.vaults.webs import (
    CORNERS,
    SIDES,
    Bay,
    along_x,
    along_y,
    at_corners,
    bay_of,
    mirrored,
    placed,
)


def build_groin(vault: Vault) -> list[Block]:
    """Generate the blocks of a groin vault: fixed ones, piers, stones astride the groins, webs."""
    bay = bay_of(vault)
    return [*_feet(vault, bay), *_stones(vault, bay)]


def _stones(vault: Vault, bay: Bay) -> Iterator[Block]:
    """Yield the stones of the webs and astride their groins, from the springings up."""
    n = len(bay.joints) - 1
    stone = 2.0 * bay.half / vault.rows
    for k in sorted(range(n), key=lambda k: (min(k, n - 1 - k), k)):
        course = min(k + 1, n - k)
        edges = _heads(bay, k, stone, odd=course % 2 == 0)
        pieces = [_piece(bay, k, low, high) for low, high in zip([None, *edges[:-1]], edges, strict=True)]
        inner = vault.groins == "mitred"
        for side in SIDES:
            own = pieces if inner else pieces[1:]
            for number, piece in enumerate(own, 1):
                parts, row = (placed(piece, bay, side),), side_of_crown(course, k + 1, n)
                yield Block(f"{side}-{k + 1}-{number}", parts, "", course=course, row=row)
        if not inner:
            yield from _astride(bay, pieces[0], k, course)


def _astride(bay: Bay, piece: np.ndarray, k: int, course: int) -> Iterator[Block]:
    """Yield the corner stones of two pieces each; four of the keystones make the boss."""
    n = len(bay.joints) - 1
    if 2 * k + 1 == n:
        yield Block("boss", tuple(placed(piece, bay, side) for side in SIDES), "", course=course)
    elif 2 * k + 1 > n:  # right of the middle: the piece of the northern web that meets the eastern one
        for name, parts in at_corners(piece, bay).items():
            yield Block(f"{name}-{n - k}", parts, "", course=course)


def _heads(bay: Bay, k: int, stone: float, odd: bool) -> list[float]:
    """Return the distances of the heads of voussoir k from the middle of a web, along x of the square bay [m].

    What is left towards the groin is at least a quarter of a stone long.
    """
    groin = float(np.abs(bay.joints[k : k + 2, :, 0]).max())
    places = bay.half - stone * (np.arange(int(bay.half / stone) + 1) + (0.5 if odd else 1.0))
    inner = places[places >= groin + stone / 4.0 * (1.0 - 1e-9)]
    return [*sorted(inner.tolist()), bay.half]


def _piece(bay: Bay, k: int, low: float | None, high: float) -> np.ndarray:
    """Return the corners of voussoir k of the northern web of a square bay, from low (None: the groin) to high, (n,
    3).
    """
    (inner, outer), (next_inner, next_outer) = bay.joints[k : k + 2]
    face = np.array([inner, outer, next_outer, next_inner])
    if low is None and 2 * k + 2 == len(bay.joints):  # the keystone goes to the middle of the bay
        face = np.array([inner, [0.0, inner[1]], next_inner, next_outer, [0.0, outer[1]], outer])
    starts = np.abs(face[:, 0]) if low is None else np.full(len(face), low)
    ends = np.full(len(face), high)
    return np.concatenate([np.column_stack([face[:, 0], y, face[:, 1]]) for y in (starts, ends)])


def _feet(vault: Vault, bay: Bay) -> Iterator[Block]:
    """Yield fixed blocks and piers at the corners, from below."""
    (inner, outer), s = bay.joints[-1], bay.stretch
    foot = np.array([[inner[0], inner[0], inner[1]], [outer[0], outer[0], outer[1]], [inner[0], outer[0], inner[1]]])
    feet = [along_y(bay)(foot), along_x(bay)(foot)]  # below the piece of each web
    down = np.array([0.0, 0.0, -vault.thickness])
    courses: list[tuple[Polyhedron, ...]] = []
    if vault.piers:
        low = np.array([inner[0], s * inner[0]])
        courses = _pier(vault.piers, low, feet, outer[0] * np.array([1.0, s]))
        ground = box([*low, -vault.thickness], [*(low + vault.piers.width), 0.0])
        base: tuple[Polyhedron, ...] = (ground,)
    else:
        base = tuple(skewed(face, down) for face in feet)
    for name, signs in CORNERS.items():
        if vault.base:
            yield Block(f"base-{name}", mirrored(base, signs), "", fixed=True)
        for k, parts in enumerate(courses, 1):
            material = vault.piers.material if vault.piers else ""
            yield Block(f"{name}-pier-{k}", mirrored(parts, signs), material, course=k)


def _pier(pier: Pier, low: np.ndarray, feet: list[np.ndarray], outer: np.ndarray) -> list[tuple[Polyhedron, ...]]:
    """Return the courses of a pier at the corner (+x, +y); the uppermost one is cut to the feet of both webs."""
    least = float((outer - low).max())
    if pier.width < least * (1.0 - 1e-9):
        message = f"{pier.width:g} is not allowed; must be at least {least:g}, as the springing of the webs"
        raise KeyProblem(message, "piers", "width")
    high, levels = low + pier.width, pier.height * np.arange(pier.courses + 1) / pier.courses
    courses: list[tuple[Polyhedron, ...]]
    courses = [(box([*low, a], [*high, b]),) for a, b in zip(levels[:-1], levels[1:], strict=True)]
    top, floor = float(feet[0][:, 2].max()), float(levels[-2])
    if top > pier.height:
        parts = [frustum(face * [1.0, 1.0, 0.0] + [0.0, 0.0, floor], face) for face in feet]
        beside = ((outer[0], low[1], high[0], high[1]), (low[0], outer[1], outer[0], high[1]))
        small = 1e-9 * pier.width
        parts += [
            box([x0, y0, floor], [x1, y1, top]) for x0, y0, x1, y1 in beside if x1 - x0 > small and y1 - y0 > small
        ]
        courses[-1] = tuple(parts)
    return courses
