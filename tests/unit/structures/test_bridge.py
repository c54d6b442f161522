"""Bridges: area, volume and faces in the open in closed form, unequal spans, names, what is refused, a lone arch."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError
from synthetic.skins import free_volume, model_of, open_area

from dem_cli.core.geometry import polygon
from dem_cli.masonry.structures import course_layout
from dem_cli.masonry.structures.arch import SHAPE_JOINTS, Arch
from dem_cli.masonry.structures.bridge import Bridge, build

ONE = {"span": 5.0, "rise": 1.5, "ring": 0.45, "voussoirs": 13}
TWO = ONE | {
    "count": 2,
    "height": 2.5,
    "piers": {"width": 1.2, "courses": 4},
    "abutments": {"width": 2.0, "courses": 4},
    "spandrels": {"block": [1.2, 0.5], "cover": 0.25},
}
ROUND = {key: value for key, value in TWO.items() if key != "rise"}  # semicircles
SPACE = TWO | {"width": 3.0, "rows": 3, "spandrels": TWO["spandrels"] | {"thickness": 0.5}, "fill": {}}
UNEQUAL = {key: value for key, value in TWO.items() if key not in ("span", "count")} | {"spans": [4.0, 6.0, 4.0]}
CASES = {"two spans": TWO, "one on fixed springings": ONE | {"spandrels": TWO["spandrels"]}, "unequal": UNEQUAL}


def joints_of(keys: dict, span: float) -> np.ndarray:
    given = {"voussoirs": keys["voussoirs"], "ring": keys["ring"], "shape": "segmental", "span": span}
    arch = Arch.model_validate(given | {"rise": keys.get("rise", span / 2.0)})
    return SHAPE_JOINTS["segmental"](arch)


def elevation(keys: dict) -> tuple[float, float, float]:
    """Area of the masonry between ground and deck; length of the inner faces; length from end to end."""
    spans = keys.get("spans") or [keys["span"]] * keys.get("count", 1)
    high, inner, hollow, crown = keys["height"], 0.0, 0.0, 0.0
    for span in spans:
        joints = joints_of(keys, span)
        hollow += abs(polygon.signed_area(joints[:, 0])) + span * high
        inner += float(np.linalg.norm(np.diff(joints[:, 0], axis=0), axis=1).sum())
        crown = max(crown, float(joints[:, 1, 1].max()))
    length = sum(spans) + 2.0 * keys["abutments"]["width"] + (len(spans) - 1) * keys["piers"]["width"]
    return length * (high + crown + keys["spandrels"]["cover"]) - hollow, inner, length


@pytest.mark.parametrize("keys", [TWO, UNEQUAL], ids=["equal", "unequal"])
def test_stones_fill_what_lies_between_ground_deck_and_inner_faces(keys):
    shapes = [part for block in build(Bridge.model_validate(keys)) for part in block.parts if not block.fixed]
    assert sum(polygon.area(shape) for shape in shapes) == pytest.approx(elevation(keys)[0], rel=1e-12)


@pytest.mark.parametrize("change", [{}, {"fill": None}], ids=["filled", "hollow"])
def test_in_space_all_inner_faces_are_shared(change):
    model = model_of({"kind": "bridge", "base": False, **SPACE, **change})
    area, inner, length = elevation(SPACE)
    deck = area_of_spandrels(SPACE)
    hollow, high = 2.0 if change else 0.0, SPACE["height"]
    assert free_volume(model) == pytest.approx(3.0 * area - hollow * deck, rel=1e-12)
    top = high + float(joints_of(SPACE, 5.0)[:, 1, 1].max()) + 0.25
    around = inner + 2.0 * high * 2 + 2.0 * top + length  # inner faces, piers and jambs, ends, deck
    feet = 2.0 * 2.0 + 1.2
    skin = 2.0 * area + 3.0 * (around + feet)
    if change:  # two walls face each other; rings and tops of piers are bare between them, deck and ends are none
        bare, gone = outline_of_spandrels(SPACE)
        skin += 2.0 * deck + hollow * (bare - gone)
    assert open_area(model) == pytest.approx(skin, rel=1e-9)


def area_of_spandrels(keys: dict) -> float:
    """Area of the elevation above piers and abutments, outside the rings."""
    shapes = [
        part for block in build(Bridge.model_validate(keys)) if block.id[0].isdigit() and block.id.endswith("a")
        for part in block.parts
    ]  # fmt: skip
    drawn = sum(polygon.area(shape) for shape in shapes)
    joints, top = joints_of(keys, 5.0), keys["spandrels"]["cover"]
    deck = float(joints[:, 1, 1].max()) + top - float(joints[0, 1, 1])
    outer = abs(polygon.signed_area(joints[:, 1]))
    length = 2.0 * 5.0 + 2.0 * 2.0 + 1.2
    assert drawn == pytest.approx(length * deck - 2.0 * outer, rel=1e-12)
    return drawn


def outline_of_spandrels(keys: dict) -> tuple[float, float]:
    """Lengths in elevation: shared with rings, piers and abutments; of the deck and the ends."""
    joints = joints_of(keys, 5.0)
    outer = float(np.linalg.norm(np.diff(joints[:, 1], axis=0), axis=1).sum())
    reach = float(joints[-1, 1, 0])
    tops = 2.0 * (2.0 - (reach - 2.5)) + 1.2 - 2.0 * (reach - 2.5)
    deck = float(joints[:, 1, 1].max()) + keys["spandrels"]["cover"] - float(joints[0, 1, 1])
    return 2.0 * outer + tops, 2.0 * 5.0 + 2.0 * 2.0 + 1.2 + 2.0 * deck


def test_what_blocks_are_called():
    names = [block.id for block in build(Bridge.model_validate(TWO | {"spandrels": None, "voussoirs": 2}))]
    supports = [f"{name}-{k}" for name in ("left", "pier-1", "right") for k in (1, 2, 3, 4)]
    assert names == ["base-left", "base-1", "base-right", *supports,
                     "arch-1-1", "arch-1-2", "arch-2-1", "arch-2-2"]  # fmt: skip
    space = {block.id for block in build(Bridge.model_validate(SPACE))}
    assert {"arch-1-1-3", "arch-2-2-4", "1-1a", "1-1b", "1-1c"} - space == set()
    assert {block.course for block in build(Bridge.model_validate(TWO)) if block.id == "1-1"} == {5}


def test_looks_at_corners_grow_with_the_square_of_the_spans(monkeypatch):
    """They grew with the cube: each thin leftover looked from every head joint of its neighbours at every corner."""
    looks, nearest = list[int](), course_layout.near

    def near(place, stops, reach):
        looks.append(len(stops))
        return nearest(place, stops, reach)

    monkeypatch.setattr(course_layout, "near", near)

    def counted(spans):
        looks.clear()
        build(Bridge.model_validate(TWO | {"count": spans}))
        return len(looks), sum(looks)

    (calls, corners), (more_calls, more_corners) = counted(2), counted(4)
    assert more_calls < 2.2 * calls  # some per span, each of which looks at the corners of all spans
    assert more_corners < 4.4 * corners


@given(
    st.lists(st.floats(-1.0, 3.0), max_size=8), st.lists(st.floats(-1.0, 3.0), max_size=6).map(sorted),
    st.floats(0.01, 0.9),
)  # fmt: skip
def test_joints_beside_a_leftover_never_divide_it(joints, stops, least):
    """A corner moves a joint by half of a least piece at most: those outside have no say."""
    tip = (0.0, 2.0)
    inside = [x for x in joints if tip[0] < x < tip[1]]
    places = sorted({course_layout.near(x, stops, 0.5 * least) for x in joints})
    ends = [tip[0]]
    for x in places:
        if ends[-1] + least < x < tip[1] - least:
            ends.append(x)
    found = course_layout.split(tip, joints, stops, least)
    assert found == course_layout.split(tip, inside, stops, least)
    assert found == list(zip(ends, [*ends[1:], tip[1]], strict=True))


def test_one_span_without_spandrels_is_the_arch():
    """Corner for corner that of kind = "arch", half a span further left."""
    found = {block.id: block.parts[0] for block in build(Bridge.model_validate(ONE))}
    joints = joints_of(ONE, 5.0) + np.array([2.5, 0.0])
    for k in range(13):
        corners = np.array([joints[k, 0], joints[k + 1, 0], joints[k + 1, 1], joints[k, 1]])
        assert np.abs(np.sort(found[f"arch-1-{k + 1}"], axis=0) - np.sort(corners, axis=0)).max() < 1e-12


REFUSED = {
    "spans: a bridge needs either spans or span; found none": {"ring": 0.4, "voussoirs": 9},
    "spans: a bridge needs either spans or span; found both": ONE | {"spans": [3.0]},
    "rise: 3 is not allowed; must be at most 2.5, half the least span": ONE | {"rise": 3.0},
    "piers: missing: there are several spans": ONE | {"count": 2, "height": 1.0},
    "piers: not used with one span": ONE | {"piers": {"width": 1.0}},
    "height: 0 is not allowed with piers or abutments; must be greater than 0": ONE | {"abutments": {"width": 1.0}},
    "height: not used without piers or abutments": ONE | {"height": 1.0},
    "piers width: 0.5 is not allowed; must be at least 0.794118, as the springings": TWO | {"piers": {"width": 0.5}},
    "piers width: 0.8 is not allowed; must be at least 0.9, as the springings": ROUND | {"piers": {"width": 0.8}},
    "abutments width: 0.4 is not allowed; must be at least 0.45, as the springings": (
        ROUND | {"abutments": {"width": 0.4, "courses": 4}}
    ),
    "fill: not used without spandrels.thickness, walls at either side": TWO | {"fill": {}},
    "spandrels thickness: 2 is not allowed; must be at most 1.5, half the width": (
        SPACE | {"spandrels": {"block": [1.0, 0.5], "thickness": 2.0}}
    ),
    "spandrels: missing: rings of unequal spans meet piers at unequal levels; give spandrels": (
        UNEQUAL | {"spandrels": None}
    ),
}


@pytest.mark.parametrize(("message", "keys"), REFUSED.items(), ids=REFUSED)
def test_what_cannot_be_built_is_said_with_its_key(message, keys):
    with pytest.raises(ValidationError) as caught:
        Bridge.model_validate(keys)
    problem = caught.value.errors()[0]["ctx"]["error"]
    assert f"{' '.join(map(str, problem.keys))}: {problem}" == message
