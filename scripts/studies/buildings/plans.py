"""Plans of buildings as tables of case files: a house of two storeys, and a block of houses with walls in common."""

from __future__ import annotations

from typing import Any

STONE = (0.5, 0.25, 0.4)  # length, height, thickness [m]
STOREY = 3.0  # [m]
LINTEL = {"height": 0.25, "bearing": 0.25}


def case(building: dict[str, Any], kind: str, **analysis: Any) -> dict[str, Any]:
    """A case of it."""
    return {
        "title": "A building from its plan",
        "dimension": 3,
        "materials": {"stone": {"density": 2300.0}},
        "joints": {"dry": {"friction": 0.6}},
        "structure": [{"kind": "building", "id": "b", "block": list(STONE), **building}],
        "analysis": {"kind": kind, **analysis},
    }


def house() -> dict[str, Any]:
    """Two storeys, 6.5 × 5 m, two gables, eleven openings, beams and a plate."""

    def windows(*places: float, storey: int) -> list[dict[str, Any]]:
        foot = storey * STOREY + 0.75
        return [{"x": x, "y": foot, "width": 1.0, "height": 1.25, "lintel": LINTEL} for x in places]

    door = {"x": 2.75, "y": 0.0, "width": 1.0, "height": 2.0, "lintel": LINTEL}
    front = [door, *windows(0.9, 4.6, storey=0), *windows(0.9, 2.75, 4.6, storey=1)]
    back = [*windows(0.9, 4.6, storey=0), *windows(0.9, 2.75, 4.6, storey=1)]
    return {
        "courses": 24,
        "walls": [
            {"id": "front", "axis": [[0.0, 0.0], [6.5, 0.0]], "openings": front},
            {"id": "back", "axis": [[0.0, 5.0], [6.5, 5.0]], "openings": back},
            {"id": "left", "axis": [[0.0, 0.0], [0.0, 5.0]], "gable": {"height": 2.0}},
            {"id": "right", "axis": [[6.5, 0.0], [6.5, 5.0]], "gable": {"height": 2.0}},
        ],
        "floors": [
            {"id": "first", "z": STOREY - 0.25, "on": ["left", "right"], "kind": "beams", "mass": 6000.0},
            {"id": "attic", "z": 2.0 * STOREY, "on": ["front", "back"], "mass": 4000.0},
        ],
    }


BONDS: dict[str, dict[str, Any]] = {
    "running": {},
    "offset a quarter": {"offset": 0.2},
    "stack": {"bond": "stack"},
    "english": {"bond": "english"},
    "flemish": {"bond": "flemish"},
    "running, two leaves, a fifth through": {"leaves": 2, "through_stones": 0.2},
    "english, two leaves": {"bond": "english", "leaves": 2},
    "flemish, two leaves": {"bond": "flemish", "leaves": 2},
}


def two_rooms(bond: dict[str, Any]) -> dict[str, Any]:
    """A house of two rooms in coarse blocks, a door and a window in its façade."""
    lintel = {"height": 0.4, "bearing": 0.4}
    openings = [
        {"x": 0.8, "y": 0.8, "width": 0.8, "height": 0.8, "lintel": lintel},
        {"x": 3.6, "y": 0.0, "width": 0.8, "height": 1.6, "lintel": lintel},
    ]
    return {
        "block": [0.8, 0.4, 0.4],
        "courses": 6,
        "walls": [
            {"id": "front", "axis": [[0.0, 0.0], [6.0, 0.0]], "openings": openings},
            {"id": "back", "axis": [[0.0, 3.2], [6.0, 3.2]]},
            {"id": "left", "axis": [[0.0, 0.0], [0.0, 3.2]]},
            {"id": "middle", "axis": [[2.6, 0.0], [2.6, 3.2]]},
            {"id": "right", "axis": [[6.0, 0.0], [6.0, 3.2]]},
        ],
        **bond,
    }


def town(rooms: int = 4, storeys: int = 2) -> dict[str, Any]:
    """Rooms of 5 × 5 m side by side both ways, walls in common, a window or a door in each, plates as floors."""
    side, window = 5.0, {"x": 2.0, "y": 0.75, "width": 1.0, "height": 1.25, "lintel": LINTEL}
    door = {"x": 2.0, "y": 0.0, "width": 1.0, "height": 2.0, "lintel": LINTEL}
    every = [(n, s) for s in range(storeys) for n in range(rooms)]

    def openings(one: dict[str, Any]) -> list[dict[str, Any]]:
        return [{**one, "x": one["x"] + n * side, "y": one["y"] + s * STOREY} for n, s in every]

    ends = rooms * side
    walls = [
        {"id": f"x{j}", "axis": [[0.0, j * side], [ends, j * side]], "openings": openings(window)}
        for j in range(rooms + 1)
    ] + [
        {"id": f"y{i}", "axis": [[i * side, 0.0], [i * side, ends]], "openings": openings(door)}
        for i in range(rooms + 1)
    ]
    floors = [
        {
            "id": f"floor-{s + 1}-{i + 1}-{j + 1}",
            "z": (s + 1) * STOREY - 0.25,
            "on": [f"y{i}", f"y{i + 1}", f"x{j}", f"x{j + 1}"],
            "bearing": 0.1,
            "mass": 6000.0,
        }
        for s in range(storeys)
        for i in range(rooms)
        for j in range(rooms)
    ]
    return {"courses": round(storeys * STOREY / STONE[1]) + 2, "walls": walls, "floors": floors}
