"""The slice of the church as a case: a bay of S. Maria Maggiore, Tuscania (PhD thesis, MIT, about 2000, Appendix A).

The figures of the appendix are lost. `Slice` has every length and weight that had to be inferred, with how; `tables`
makes a case of it. Lengths in m, x to the right, z upwards; the load pushes to the left.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from studies.polygons import rectangle

Polygon = list[list[float]]

FITTED_SIDE = 7.26  # m, height of the side walls with which the seven-body mechanism has 0.055 (A4); of no case
LEAN = 0.20  # of the left wall, over its height: A2
DRUMS = {"b": 8, "c": 2}  # of the left and of the right column, the wider first one counted: A3
COURSES = 8  # of a side wall
WOOD = ("chestnut", "roof-a", "roof-d", "roof-n")
DENSITIES = {"tuff": 1700.0, "peperino": 2112.0, "travertine": 2420.0, "chestnut": 650.0}  # Table A-1


@dataclass(frozen=True)
class Slice:
    """Lengths [m] and weights [kg/m2]. From the data book (thesis_church): bay, heights, columns, nave walls.

    None of them is fitted to a load of the whole structure.
    """

    side: float = 5.76  # height of the side walls
    bay: float = 5.0
    top: float = 14.0  # of the nave walls: 13.8 m at least (A3)
    foot: float = 0.5  # first element of the columns
    column: float = 5.0  # top of the columns
    thick: float = 0.7  # of the nave walls
    left_column: float = 0.540  # with the bracket: Table A-2
    right_column: float = 0.572
    aisle: float = 4.0  # clear width: guessed
    nave: float = 7.0  # clear width: guessed
    pitch: float = 0.3  # slope of the roofs: tiles
    beam: float = 0.3  # depth of the roof members: guessed
    end: float = 0.1  # their depth where they meet the nave wall: there they turn as hinges
    bracket: float = 0.25  # what the beams rest on, model A: guessed
    roof: float = 120.0  # weight of a roof on a m2 of plan: chestnut, boards, tiles
    aisle_roof: float | None = None  # the same of the aisles, where it differs
    wood_masonry: float = 0.4
    lean: float = LEAN
    model: str = "A"
    pocket: float = 0.35  # how far the beams go into the nave wall, model B: half of it
    buttress: float = 0.165  # its thickness over its height, model B: Table A-3
    left: float | None = None  # thickness of the left wall, where it is not that of Table A-2
    right: float | None = None

    @property
    def left_wall(self) -> float:
        """Thickness of the left wall [m]: it turns at (thickness − lean)/height = 0.062, Table A-2."""
        return round(0.062 * self.side + LEAN, 3) if self.left is None else self.left

    @property
    def right_wall(self) -> float:
        """Thickness of the right wall [m]: it turns at 0.139."""
        return round(0.139 * self.side, 3) if self.right is None else self.right

    @property
    def seat(self) -> float:
        """Where the aisle beams rest on the nave walls."""
        return self.side + self.pitch * self.aisle

    @property
    def axes(self) -> tuple[float, float]:
        """Of the left and the right nave wall; x = 0 is the outer face of the left wall at its foot."""
        first = self.left_wall + self.aisle + 0.5 * self.thick
        return first, first + self.nave + self.thick

    @property
    def right_face(self) -> float:
        """Inner face of the right wall."""
        return self.axes[1] + 0.5 * self.thick + self.aisle


def before_1954(bay: Slice, **changes: Any) -> Slice:
    """Model B: plumb and taller side walls, the right one of which turns at 0.115 (Table A-3), and a buttress.

    The aisle roofs were higher: 1954 brought them "back to their original height".
    """
    return replace(bay, model="B", lean=0.0, side=bay.right_wall / 0.115, left=bay.left_wall, right=bay.right_wall,
                   **changes)  # fmt: skip


def mirrored(part: Polygon, about: float) -> Polygon:
    return [[2.0 * about - x, z] for x, z in reversed(part)]


def area(parts: list[Polygon]) -> float:
    """Of all parts [m2]."""
    return sum(0.5 * abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(p, [*p[1:], p[0]], strict=True))) for p in parts)


class Pile:
    """Blocks as a case file has them."""

    def __init__(self, depth: float) -> None:
        self.depth = depth
        self.blocks: list[dict[str, Any]] = []

    def add(self, name: str, material: str, *parts: Polygon, depth: float | None = None, **more: Any) -> None:
        shapes = [[[round(x, 6), round(z, 6)] for x, z in part] for part in parts]
        shape = {"vertices": shapes[0]} if len(shapes) == 1 else {"parts": shapes}
        thickness = round(self.depth if depth is None else depth, 6)
        self.blocks.append({"id": name, "material": material, "thickness": thickness, **shape, **more})


def side_walls(bay: Slice, pile: Pile) -> None:
    """Wall a on the left, with the buttress of model B, wall d on the right."""
    width = bay.left_wall
    if bay.model == "B":
        high = bay.side + bay.beam
        pile.add("buttress", "tuff", rectangle(-bay.buttress * high, 0.0, 0.0, high))
    for i in range(COURSES):
        low, high = i / COURSES, (i + 1) / COURSES
        a, b = -bay.lean * low, -bay.lean * high
        z0, z1 = bay.side * low, bay.side * high
        pile.add(f"a-{i + 1}", "tuff", [[a, z0], [a + width, z0], [b + width, z1], [b, z1]])
        pile.add(f"d-{i + 1}", "tuff", rectangle(bay.right_face, z0, bay.right_face + bay.right_wall, z1))


def nave_wall(bay: Slice, pile: Pile, name: str, axis: float, width: float, stone: str) -> None:
    """A column and the wall on it; blocks of 0.3 m near the aisle beam."""
    shaft = (bay.column - bay.foot) / (DRUMS[name] - 1)
    pile.add(f"{name}-drum-1", stone, rectangle(axis - 0.45, 0.0, axis + 0.45, bay.foot), depth=0.9)
    for i in range(1, DRUMS[name]):
        low = bay.foot + (i - 1) * shaft
        pile.add(f"{name}-drum-{i + 1}", stone, rectangle(axis - width / 2, low, axis + width / 2, low + shaft),
                 depth=width)  # fmt: skip
    seat, step = bay.seat, bay.beam
    lower = [bay.column, 0.5 * (bay.column + seat - 2 * step), seat - 2 * step, seat - step]
    upper = [seat + step, seat + 2 * step]
    upper += [upper[-1] + (bay.top - upper[-1]) * k / 3 for k in (1, 2, 3)]
    levels = [*lower, seat, *upper]
    left, right = axis - bay.thick / 2, axis + bay.thick / 2
    for i, (z0, z1) in enumerate(zip(levels, levels[1:], strict=False)):
        parts = [rectangle(left, z0, right, z1)]
        if bay.model == "A" and z1 == seat:
            bracket = rectangle(left - bay.bracket, z0, left, z1)
            parts.append(bracket if name == "b" else mirrored(bracket, axis))
        if bay.model == "B" and z0 == seat:
            rest = rectangle(left + bay.pocket, z0, right, z1)
            parts = [rest if name == "b" else mirrored(rest, axis)]
        pile.add(f"{name}-{i + 1}", "tuff", *parts)


def aisle_beam(bay: Slice, outer: float, inner: float, face: float) -> list[Polygon]:
    """From the side wall (outer to inner face, at its top) up to the face of the nave wall, or into it."""
    low, seat, deep = bay.side, bay.seat, bay.beam
    start = face - bay.bracket
    stop, end = (face, bay.end) if bay.model == "A" else (face + bay.pocket, deep)
    slope = [[inner, low], [start, seat], [start, seat + deep], [inner, low + deep]]
    return [rectangle(outer, low, inner, low + deep), slope, rectangle(start, seat, stop, seat + end)]


def roofs(bay: Slice, pile: Pile) -> dict[str, float]:
    """Aisle beams, tie and roof of the nave; densities [kg/m3] that give each its weight."""
    b, c = bay.axes
    half = bay.thick / 2
    left = aisle_beam(bay, -bay.lean, bay.left_wall - bay.lean, b - half)
    mirror = aisle_beam(bay, -bay.right_face - bay.right_wall, -bay.right_face, -c - half)
    right = [mirrored(part, 0.0) for part in mirror]
    tie = rectangle(b - half, bay.top, c + half, bay.top + bay.beam)
    span = c - b + bay.thick
    gable = [tie[3], tie[2], [(b + c) / 2, bay.top + bay.beam + bay.pitch * span / 2]]
    pile.add("roof-a", "roof-a", *left)
    pile.add("roof-d", "roof-d", *right)
    pile.add("tie", "chestnut", tie, depth=0.3)
    pile.add("roof-n", "roof-n", gable)
    light = bay.roof if bay.aisle_roof is None else bay.aisle_roof
    return {
        "roof-a": light * (bay.aisle + bay.left_wall) / area(left),
        "roof-d": light * (bay.aisle + bay.right_wall) / area(right),
        "roof-n": bay.roof * span / area([gable]),
    }


def tables(bay: Slice, title: str, **analysis: Any) -> dict[str, Any]:
    """The case; `analysis` adds to [analysis]."""
    pile = Pile(bay.bay)
    far = bay.right_face + bay.right_wall
    pile.add("ground", "tuff", rectangle(-4.0, -0.5, far + 3.0, 0.0), fixed=True)
    side_walls(bay, pile)
    b, c = bay.axes
    nave_wall(bay, pile, "b", b, bay.left_column, "peperino")
    nave_wall(bay, pile, "c", c, bay.right_column, "travertine")
    densities = DENSITIES | {name: round(value, 3) for name, value in roofs(bay, pile).items()}
    return {
        "title": title,
        "materials": {name: {"density": value} for name, value in densities.items()},
        "joints": {
            "masonry": {"law": "coulomb", "friction": 0.6},
            "wood-masonry": {"law": "coulomb", "friction": bay.wood_masonry},
            "wood": {"law": "coulomb", "friction": 0.45},
        },
        "interface": [
            *({"between": [wood, "tuff"], "joint": "wood-masonry"} for wood in WOOD),
            {"between": ["chestnut", "roof-n"], "joint": "wood"},
        ],
        "block": pile.blocks,
        "analysis": {
            "kind": "pushover", "direction": [-1.0, 0.0], "pattern": "mass", "resolution": 0.005, "limit": True,
            **analysis,
        },
        "output": {"frames": 20},
        "monitor": [{"name": "top", "point": [round(b - bay.thick / 2, 6), bay.top], "component": "x"}],
    }  # fmt: skip


def alone(case: dict[str, Any], letter: str, title: str) -> dict[str, Any]:
    """One wall of a case as a single body, without roofs; for model B `buttress` is one."""
    blocks = case["block"]
    kept = [blocks[0]] + [block for block in blocks if block["id"].split("-")[0] == letter]
    names = {block["material"] for block in kept}
    return case | {
        "title": title,
        "materials": {name: value for name, value in case["materials"].items() if name in names},
        "joints": {"masonry": case["joints"]["masonry"]},
        "interface": [],
        "block": kept,
        "monitor": [{"block": kept[-1]["id"], "component": "x"}],
    }
