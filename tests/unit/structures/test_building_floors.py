"""Floors of buildings that cannot lie where they should: refused at their own key, with what to do."""

from __future__ import annotations

import pytest
from unit.structures.test_building import Built, wall

from dem_cli.errors import CaseError


def room(*corners):
    """Walls a, b, c ... around a room."""
    return [wall("abcdefgh"[k], corner, corners[(k + 1) % len(corners)]) for k, corner in enumerate(corners)]


def floor(on, name="f", **more):
    return {"id": name, "z": 1.0, "on": list(on), "kind": "beams", **more}


SKEWED = room((0, 0), (4, 0), (5, 3), (1, 3))
SPLAYED = room((0, 0), (5, 0), (4, 3), (0, 3))
SQUARE = room((0, 0), (5, 0), (5, 4), (0, 4))
REFUSED = {
    "no way": (SKEWED, [floor("ac")], "floors.0.on: beam 1, square to 'a', would run into wall 'd' .* give a plate"),
    "the other way": (
        SPLAYED,
        [floor("ac")],
        "would run into wall 'b' before it reaches 'c'; they are clear",
    ),
    "a wall in the room": (
        [*SQUARE, wall("s", (2.5, 0), (2.5, 1.5))],
        [floor("ac", kind="rigid")],
        "floors.0.on: the plate would run into wall 's', which stands in the room",
    ),
    "in one wall from both sides": (
        [*SQUARE, wall("s", (2.5, 0), (2.5, 4))],
        [floor("bs"), floor("ds", "g")],
        "floors.1.bearing: 'g-1' and 'f-6' would lie in the same place",
    ),
}


@pytest.mark.parametrize("what", REFUSED)
def test_floors_that_cannot_lie_there(what):
    walls, floors, message = REFUSED[what]
    with pytest.raises(CaseError, match=message):
        Built(walls, floors=floors)


def test_beams_parallel_to_a_cross_wall():
    """`name more of the walls` was answered by `give two`: such a floor could not be told at all."""
    divided = [*SQUARE, wall("s", (2.5, 0), (2.5, 4)), wall("t", (3.8, 0), (3.8, 4))]
    with pytest.raises(CaseError, match="meant; 'b', or 'd', or 's' and 't'; beams bear on the first two alone"):
        Built(divided, floors=[floor("ac")])
    found = Built(divided, floors=[floor("acd"), floor("acst", "g"), floor("acb", "h")]).model
    beams = {
        name: found.centroids[k, 0] for k, name in enumerate(found.block_ids) if name[:4] in ("b-f-", "b-g-", "b-h-")
    }
    assert {name[2] for name, x in beams.items() if x < 2.5} == {"f"}
    assert {name[2] for name, x in beams.items() if 2.5 < x < 3.8} == {"g"}
    assert {name[2] for name, x in beams.items() if x > 3.8} == {"h"}


def test_the_walls_that_a_message_names_carry_beams():
    with pytest.raises(CaseError) as refused:
        Built(SPLAYED, floors=[floor("ac")])
    on = str(refused.value).split("on = [")[1].split("]")[0].replace("'", "").split(", ")
    assert "b-f-1" in Built(SPLAYED, floors=[floor(on)]).model.block_ids
