"""Columns and arches: places of the data book, closed forms of areas, neighbours that share their joints."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from dem_cli.core.geometry import polygon
from dem_cli.masonry.structures import arch
from dem_cli.masonry.structures.columns import column
from dem_cli.masonry.structures.placement import corner_blocks, place

SEMICIRCLE = {"voussoirs": 21, "radius": 1.0, "ring": 0.15}
PORTAL = {"voussoirs": 6, "inner_radius": 0.2, "ring": 0.08, "columns": {"width": 0.16, "height": 0.32}}
ARCHES = {
    "semicircle": SEMICIRCLE,
    "horseshoe": SEMICIRCLE | {"included_angle_deg": 240.0},
    "thesis 6.2": PORTAL,
    "buttresses": {
        "voussoirs": 12,
        "inner_radius": 10.0,
        "ring": 1.5,
        "included_angle_deg": 120.0,
        "buttresses": {"width": 5.0, "height": 21.4, "courses": 3},
        "base_extension": 0.5,
    },
    "segmental": {"shape": "segmental", "voussoirs": 9, "span": 3.0, "rise": 0.5, "ring": 0.3},
    "pointed": {
        "shape": "pointed",
        "voussoirs": 10,
        "span": 3.0,
        "rise": 2.5,
        "ring": 0.3,
        "columns": {"width": 0.5, "height": 2.0, "courses": 4},
    },
    "pointed by radius": {"shape": "pointed", "voussoirs": 2, "span": 3.0, "inner_radius": 4.0, "ring": 0.3},
    "flat": {
        "shape": "flat",
        "voussoirs": 7,
        "span": 1.5,
        "ring": 0.3,
        "buttresses": {"width": 1.0, "height": 2.0},
    },
    "flat on springings": {"shape": "flat", "voussoirs": 7, "span": 1.5, "ring": 0.3, "skew_deg": 10.0},
}


def built(**keys):
    return {block.id: block for block in arch.build(arch.Arch.model_validate(keys))}


@pytest.mark.parametrize("keys", ARCHES.values(), ids=ARCHES)
def test_convex_symmetric_and_joint_to_joint(keys):
    blocks = built(**keys)
    ring = [blocks[f"{k + 1}"].parts[0] for k in range(keys["voussoirs"])]
    assert all(polygon.is_convex(part) for block in blocks.values() for part in block.parts)
    for k, shape in enumerate(ring):
        mirrored = ring[-1 - k] * [-1.0, 1.0]
        assert sorted(np.round(mirrored, 9).tolist()) == sorted(np.round(shape, 9).tolist())
    piers = keys.get("columns") or keys.get("buttresses")
    names = [f"{side}-{piers.get('courses', 1)}" if piers else f"base-{side}" for side in ("left", "right")]
    feet = [blocks[name].parts[0] for name in names]
    for a, b in zip(ring[:-1], ring[1:]):  # neighbouring voussoirs have two corners in common
        assert shared(a, b) == 2
    assert shared(feet[0], ring[0]) >= 1  # flush at the inner face; a level springing joint runs on into the pier
    assert shared(feet[1], ring[-1]) >= 1


def shared(a, b) -> int:
    distance = np.abs(a[:, None, :] - b[None, :, :]).max(axis=2)
    return int((distance < 1e-12 * polygon.size(a)).sum())


@given(st.integers(1, 60), st.floats(0.01, 1.5), st.floats(5.0, 330.0))
def test_area_of_a_circular_ring(voussoirs, ring, angle):
    inner = 1.0 - ring / 2.0
    step = math.radians(angle) / voussoirs
    if step > 1.0:  # the chord of a very long voussoir is no arch
        return
    blocks = built(voussoirs=voussoirs, radius=1.0, ring=ring, included_angle_deg=angle)
    area = sum(polygon.area(blocks[f"{k + 1}"].parts[0]) for k in range(voussoirs))
    exact = voussoirs / 2.0 * math.sin(step) * ((inner + ring) ** 2 - inner**2)
    assert area == pytest.approx(exact, rel=1e-9)


def test_portal_of_thesis_6_2():
    blocks = built(**PORTAL)
    assert len([b for b in blocks.values() if not b.fixed]) == 8
    left = blocks["left-1"].parts[0]
    assert left.min(axis=0) == pytest.approx([-0.36, 0.0])
    assert left.max(axis=0) == pytest.approx([-0.2, 0.32])
    assert len(left) == 4
    top = max(part[:, 1].max() for block in blocks.values() for part in block.parts)
    assert top == pytest.approx(0.6)
    assert blocks["base-right"].parts[0].min(axis=0) == pytest.approx([0.2, -0.08])
    assert blocks["base-right"].fixed


def test_shapes_are_where_their_names_say():
    segment = built(**ARCHES["segmental"])
    assert segment["1"].parts[0][0] == pytest.approx([-1.5, 0.0])
    assert segment["5"].parts[0][:2, 1].max() == pytest.approx(0.5, rel=0.02)
    pointed = built(**ARCHES["pointed"])
    assert pointed["5"].parts[0][1] == pytest.approx([0.0, 4.5])  # columns 2.0, rise 2.5
    flat = built(**ARCHES["flat on springings"])
    assert flat["1"].parts[0][3] == pytest.approx([-0.75 - 0.3 * math.tan(math.radians(10.0)), 0.3])
    assert corner_blocks(list(built(**SEMICIRCLE).values()))["top"] == "11"


BAD_ARCHES = {
    "radius: a circular arch needs either radius or inner_radius; found none": {"radius": None},
    "radius: a circular arch needs either radius or inner_radius; found both": {"inner_radius": 0.9},
    "radius: 0.05 is not allowed; must be more than 0.075, half the ring": {"radius": 0.05},
    "span: not used by a circular arch, which is given by radius, inner_radius, included_angle_deg": {"span": 1.0},
    "rise: missing: a segmental arch needs span and rise": {
        "shape": "segmental",
        "radius": None,
        "span": 1.0,
    },
    "rise: 0.6 is not allowed; must be at most 0.5 (half the span, a semicircle)": {
        "shape": "segmental",
        "radius": None,
        "span": 1.0,
        "rise": 0.6,
    },
    "voussoirs: 21 is not allowed; must be even: a pointed arch has a joint at the top": {
        "shape": "pointed",
        "radius": None,
        "span": 1.0,
        "rise": 0.6,
    },
    "included_angle_deg: 200 is not allowed; must be at most 180 for an arch on piers": {
        "included_angle_deg": 200.0,
        "columns": {"width": 1.0, "height": 1.0},
    },
    "columns.width: 0.1 is not allowed; must be at least 0.15, as the springing joint": {
        "columns": {"width": 0.1, "height": 1.0}
    },
    "buttresses: an arch stands on columns or on buttresses, not on both": {
        "columns": {"width": 1.0, "height": 1.0},
        "buttresses": {"width": 1.0, "height": 1.0},
    },
}


@pytest.mark.parametrize(("message", "keys"), BAD_ARCHES.items())
def test_what_does_not_fit_is_said_at_its_key(message, keys):
    with pytest.raises(ValidationError) as error:
        arch.Arch.model_validate(SEMICIRCLE | keys)
    cause = error.value.errors()[0]["ctx"]["error"]
    assert f"{'.'.join(map(str, cause.keys))}: {cause}" == message


def test_a_voussoir_too_long_to_be_convex():
    with pytest.raises(ValueError, match="voussoir 1 is not convex"):
        arch.build(arch.Arch.model_validate({"voussoirs": 1, "radius": 1.0, "ring": 0.1}))


def drums(**keys):
    return column.build(column.Column.model_validate(keys))


def test_the_14_block_column():
    blocks = drums(block=[0.04, 0.0175], courses=14)
    assert [b.id for b in blocks[:3]] == ["base", "1", "2"]
    assert len(blocks) == 15
    assert blocks[-1].parts[0][2] == pytest.approx([0.02, 0.245])


def test_the_tapered_drums_of_dimitri():
    blocks = drums(block=[1.11, 0.85], courses=7, top_width=0.9, cap={"width": 0.9, "height": 0.21, "material": "x"})
    widths = [np.ptp(b.parts[0][:2, 0]) for b in blocks[1:8]]
    assert widths == pytest.approx([1.11 - 0.03 * k for k in range(7)])
    assert blocks[7].parts[0][2] == pytest.approx([0.45, 5.95])
    assert (blocks[8].id, blocks[8].material) == ("cap", "x")
    area = sum(polygon.area(b.parts[0]) for b in blocks[1:8])
    assert area == pytest.approx((1.11 + 0.9) / 2 * 5.95)


def test_drums_one_by_one():
    blocks = drums(drums=[{"width": 1.0, "height": 0.5}, {"width": 0.8, "height": 2.0, "top_width": 0.6}], base=False)
    assert [b.parts[0].max(axis=0).tolist() for b in blocks] == [[0.5, 0.5], [0.4, 2.5]]


@pytest.mark.parametrize(
    ("keys", "where"),
    [({}, "block"), ({"courses": 3}, "block"), ({"block": [1.0, 1.0]}, "courses"),
     ({"drums": [{"width": 1.0, "height": 1.0}], "courses": 3}, "courses")],
)  # fmt: skip
def test_a_column_has_one_shape(keys, where):
    with pytest.raises(ValidationError) as error:
        drums(**keys)
    assert error.value.errors()[0]["ctx"]["error"].keys == (where,)


def test_placing_turns_then_shifts():
    parameters = column.Column.model_validate(
        {
            "id": "pier",
            "material": "tuff",
            "block": [2.0, 1.0],
            "courses": 1,
            "origin": [10.0, 5.0],
            "rotation_deg": 90.0,
        }
    )
    base, block = place(column.build(parameters), parameters, ("structure", 3))
    assert (block.id, block.material, block.path) == ("pier-1", "tuff", ("structure", 3))
    assert block.parts[0] == pytest.approx(np.array([[10.0, 4.0], [10.0, 6.0], [9.0, 6.0], [9.0, 4.0]]))
    assert base.parts[0][:, 0].min() == pytest.approx(10.0)


UPRIGHT = {"joints": "vertical", "voussoirs": 40, "radius": 1.0, "ring": 0.12}


def test_vertical_joints_cut_a_half_ring():
    """Joints are upright, their ends on both circles; voussoirs follow one another and fill the ring between chords."""
    table = arch.Arch.model_validate(UPRIGHT)
    left, right, *stones = arch.build(table)
    assert (left.fixed, right.fixed) == (True, True)
    assert [float(box) for box in (*left.parts[0].min(axis=0), *left.parts[0].max(axis=0))] == pytest.approx(
        [-1.06, -0.12, -0.94, 0.0]
    )
    assert [stone.id for stone in stones] == [str(k + 1) for k in range(40 + 2 * 3)]
    area = 0.0
    for stone, after in zip(stones, [*stones[1:], None], strict=True):
        corners = np.concatenate(stone.parts)
        area += sum(polygon.properties(part).area for part in stone.parts)
        assert all(polygon.is_convex(part) for part in stone.parts)
        if after is not None:
            assert np.concatenate(after.parts)[:, 0].min() == pytest.approx(corners[:, 0].max(), abs=1e-15)
        end = corners[np.isclose(corners[:, 0], corners[:, 0].max(), rtol=0.0, atol=1e-15), 1]
        x = corners[:, 0].max()
        assert end.max() == pytest.approx(math.sqrt(max(1.06**2 - x**2, 0.0)), abs=1e-7)
        assert end.min() == pytest.approx(math.sqrt(max(0.94**2 - x**2, 0.0)), abs=1e-7)
    assert area == pytest.approx(math.pi / 2.0 * (1.06**2 - 0.94**2), rel=2e-3)


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ({"included_angle_deg": 120.0}, "only allowed of a half ring"),
        ({"columns": {"width": 0.2, "height": 1.0}}, "not allowed on columns or buttresses"),
        ({"shape": "segmental", "radius": None, "span": 2.0, "rise": 0.5}, "only allowed of a half ring"),
    ],
)
def test_vertical_joints_are_of_half_rings(more, says):
    table = {key: value for key, value in (UPRIGHT | more).items() if value is not None}
    with pytest.raises(ValidationError, match=says):
        arch.Arch.model_validate(table)
