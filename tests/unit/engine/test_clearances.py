"""How far blocks move until the gaps of the start have closed: never further than is said, and not much less."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, running_wall, simulation, tables, turned
from hypothesis import given, settings
from hypothesis import strategies as st
from oracle import rolling_polygons as statics
from scipy.spatial.transform import Rotation

from dem_cli.core.contact.detect import find_joints
from dem_cli.core.contact.edges import widest_gaps
from dem_cli.core.contact.geometry import geometry_of
from dem_cli.core.contact.planar import microrotations
from dem_cli.core.engine.placement.clearances import beyond, gap_play, play
from dem_cli.core.engine.settings import DEFAULT

CLEARANCE = DEFAULT.clearance

HEIGHT, WIDTH = 0.0175, 0.04


def column(blocks: int, lengths: list[float], aperture: float):
    """The same column of dem and of statics: blocks on polygons."""
    profile = {"sides": len(lengths), "lengths": lengths, "aperture": aperture}
    stones = [block(f"b{i}", rectangle(0.0, i * HEIGHT, WIDTH, (i + 1) * HEIGHT)) for i in range(blocks)]
    base = block("base", rectangle(-WIDTH, -HEIGHT, 2 * WIDTH, 0.0), fixed=True)
    case = tables(base, *stones, joints={"dry": {"friction": 0.6, "profile": profile}})
    return simulation(case, "large"), statics.column(blocks, HEIGHT, lengths, aperture)


def motion(made, sides: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """Of all blocks from where all rest: distances [m], (n,), and angles against the ground [rad], (n,)."""
    before, after = statics.standing(made, [0] * made.blocks)[0], statics.standing(made, sides)[0]
    steps = np.diff(made.foot, axis=0)
    slopes = np.arctan2(steps[:, 1], steps[:, 0])
    return np.hypot(*(after - before).T), np.abs(np.cumsum(slopes[made.rest + np.array(sides)]))


@st.composite
def rolled(draw):
    """A column, and the side that each of its blocks rolled to."""
    n = draw(st.integers(2, 7))
    half = draw(st.lists(st.floats(0.3, 1.0), min_size=(n + 1) // 2, max_size=(n + 1) // 2))
    lengths = np.array(half + half[::-1][n % 2 :])
    lengths *= WIDTH / lengths.sum()
    blocks = draw(st.integers(1, 10))
    rest = (n - 1) // 2
    if draw(st.booleans()):  # to the extremes
        sides = draw(st.lists(st.sampled_from([-rest, n - 1 - rest]), min_size=blocks, max_size=blocks))
    else:
        sides = draw(st.lists(st.integers(-rest, n - 1 - rest), min_size=blocks, max_size=blocks))
    return blocks, lengths.tolist(), draw(st.floats(1e-5, 4e-4)), sides


@settings(max_examples=60, deadline=None)
@given(rolled())
def test_no_column_rolls_further(drawn):
    """Statics of rigid blocks that roll on their feet, to any sides of them, with finite rotations."""
    *shape, sides = drawn
    sim, made = column(*shape)
    moved, angles = motion(made, sides)
    assert (moved <= sim.play.moved[1:]).all()
    assert (angles <= sim.play.turned[1:]).all()


@pytest.mark.parametrize(("blocks", "share"), [(1, 3.0), (14, 1.5), (40, 1.35)])
@pytest.mark.parametrize("lengths", [[0.016, 0.008, 0.016], [0.008] * 5])
def test_a_column_rolls_nearly_as_far(blocks, share, lengths):
    """All blocks to the last side, to the right: not much more than that is called microrotation, at the top."""
    sim, made = column(blocks, lengths, 1e-4)
    moved, angles = motion(made, [len(lengths) // 2] * blocks)
    assert (sim.play.turned[1:] < 1.3 * angles).all()
    assert sim.play.moved[-1] < share * moved[-1]
    assert (sim.play.moved[1:] < 3.0 * moved).all()


def test_every_block_of_a_wall_has_play_by_its_nearest_support():
    """A block that stands on two is held by the one that can move less; courses above it move further."""
    profile = {"sides": 3, "aperture": 1e-4, "over": "face", "only": "bed"}
    sim = simulation(tables(*running_wall(4, 3), joints={"dry": {"friction": 0.6, "profile": profile}}), "large")
    names = sim.model.block_ids
    courses = [[sim.play.moved[i] for i, name in enumerate(names) if name.startswith(f"b{k}-")] for k in range(4)]
    assert sim.play.moved[names.index("base")] == sim.play.turned[names.index("base")] == 0.0
    assert all(max(low) < min(high) for low, high in zip(courses, courses[1:]))
    own = (sim.joints.blocks == [names.index("base"), names.index("b0-1")]).all(axis=1)
    angles = microrotations(sim.joints, sim.geometry)[own]
    assert sim.play.turned[names.index("b0-1")] == pytest.approx(CLEARANCE.margin * angles[0])


def test_plane_closed_joints_have_none():
    for kinematics in ("fixed", "large"):
        sim = simulation(tables(*running_wall(3, 3)), kinematics)
        assert not sim.play.moved.any()
        assert not sim.play.turned.any()


def test_what_touches_nothing_has_none():
    """Nothing holds it, so that all its motion counts."""
    profile = {"sides": 3, "aperture": 1e-2}
    stones = [block(name, rectangle(x, y, x + 1, y + 1)) for name, x, y in (("low", 0, 0), ("flying", 5, 5))]
    base = block("base", rectangle(-1, -1, 2, 0), fixed=True)
    sim = simulation(tables(base, *stones, joints={"dry": {"friction": 0.6, "profile": profile}}), "large")
    found = play(sim.model, sim.joints, microrotations(sim.joints, sim.geometry), sim.bodies.positions)
    moved = dict(zip(sim.model.block_ids, found.moved.tolist()))
    assert moved["base"] == moved["flying"] == 0.0
    assert moved["low"] > 0.0


def test_beyond_play():
    """From inside, from outside, and what stays inside."""
    play_of = np.array([1.0, 1.0, 1.0])
    since, before, now = np.array([0.5, 4.0, 3.0]), np.array([0.2, 0.5, 6.0]), np.array([0.7, 3.5, 8.0])
    assert beyond(play_of, since, before, now) == pytest.approx([-0.3, 2.5, 1.0])


# -- gaps between blocks -------------------------------------------------------------------------------


def gap_of(*blocks: dict, reach: float = 0.25) -> float:
    sim = simulation(tables(*blocks), "large")
    faces = find_joints(sim.model, sim.bodies.corners, reach)
    corners, narrow = sim.bodies.corners, geometry_of(2)
    found = narrow.open_gaps(sim.model, faces, corners, CLEARANCE.steepest, CLEARANCE.bare)
    return float(found.max(initial=0.0))


GROUND = block("ground", rectangle(-3, -1, 6, 0), fixed=True)


@pytest.mark.parametrize("gap", [0.0, 1e-3, 0.1])
def test_gap_of_faces_apart(gap):
    assert gap_of(GROUND, block("b", rectangle(0, gap, 1, 1 + gap))) == pytest.approx(gap, abs=1e-15)


@pytest.mark.parametrize("angle", [-0.1, -0.01, 0.01, 0.1])
def test_gap_of_a_wedge_is_that_of_its_open_end(angle):
    """A block on one corner of its foot: it can turn until the other, 1 m away, comes down."""
    stone = turned(rectangle(0, 0, 1, 1), angle, (0.0 if angle > 0 else 1.0, 0.0))
    assert gap_of(GROUND, block("b", stone)) == pytest.approx(np.sin(abs(angle)), rel=1e-12)


@pytest.mark.parametrize(("x", "y"), [(1.0, 1.0), (1.1, 1.0), (1.0, 1.1), (1.1, 1.1)])
def test_corners_that_face_each_other_have_none(x, y):
    """Blocks diagonally above each other have no faces that could close."""
    assert gap_of(block("a", rectangle(0, 0, 1, 1)), block("b", rectangle(x, y, x + 1, y + 1))) == 0.0


def test_gap_only_where_faces_overlap():
    """The slanting top of a sinks away from the flat foot of b, which ends half way."""
    low = block("low", [[0, 0], [2, 0], [2, 0.8], [0, 1]], fixed=True)
    for right, expected in ((1.0, 0.1), (2.0, 0.2), (3.0, 0.2)):
        found = gap_of(low, block("b", rectangle(-1, 1, right, 2)))
        assert found == pytest.approx(expected, rel=0.02)  # across the slant of 0.1


CUBE = np.array([[x, y, z] for z in (0.0, 1.0) for x in (0.0, 1.0) for y in (0.0, 1.0)])


@pytest.mark.parametrize(
    ("roll", "pitch", "expected"),
    [(0.0, 0.0, 0.05), (0.1, 0.0, 0.05 + np.sin(0.1)), (0.1, 0.2, None), (0.4, 0.0, 0.0)],
)
def test_gap_in_space_is_that_of_the_corner_furthest_off(roll, pitch, expected):
    """A cube turned about an edge of its foot, over a slab and beyond it, and steeper than what closes."""
    turn = Rotation.from_euler("xy", [roll, pitch])
    foot = turn.apply(CUBE[:4] * (1.0, 1.0, 0.0))
    corners = turn.apply(CUBE) + np.array([0.0, 0.0, 0.05 - foot[:, 2].min()])
    slab = {"id": "slab", "polygon": rectangle(-3, -1, 6, 0), "y": [-3.0, 3.0], "fixed": True}
    sim = simulation({**tables(slab, block("b", corners)), "dimension": 3})
    faces = find_joints(sim.model, sim.bodies.corners, 0.25)
    found = geometry_of(3).open_gaps(sim.model, faces, sim.bodies.corners, CLEARANCE.steepest, CLEARANCE.bare)
    highest = corners[:4, 2].max() if expected is None else expected
    assert found == pytest.approx([highest], rel=0.02)  # across the bisector of both faces
    assert geometry_of(3).open_gaps(sim.model, faces.where(found < 0.0), sim.bodies.corners, 0.3, 1e-3).shape == (0,)


@settings(max_examples=60, deadline=None)
@given(
    angle=st.floats(-0.25, 0.25), lean=st.floats(-np.pi, np.pi), x=st.floats(-0.8, 0.8), y=st.floats(0.0, 0.2),
    width=st.floats(0.5, 2.0),
)  # fmt: skip
def test_gap_is_the_largest_distance_of_points(angle, lean, x, y, width):
    """Against distances of many points of the foot of b from the top of a, and in whatever direction both lie."""
    foot = np.array(turned([[x, y], [x + width, y]], angle, (x, y)))
    top = np.array([[1.0, 0.0], [0.0, 0.0]])  # counter-clockwise round a, which is below
    along = np.linspace(0.0, 1.0, 20_001)[:, None]
    points = foot[0] + along * (foot[1] - foot[0])
    over = points[(points[:, 0] >= 0.0) & (points[:, 0] <= 1.0)]
    expected = max(0.0, over[:, 1].max(initial=0.0)) if len(over) > 50 else None
    corners = np.array(turned(np.concatenate([top, foot]), lean))
    found = widest_gaps(np.array([[0, 1, 2, 3]]), corners, CLEARANCE.steepest, CLEARANCE.bare)[0]
    if expected is not None:
        assert found == pytest.approx(expected, abs=1e-4)


@given(gap=st.floats(0.0, 1.0), width=st.floats(1e-3, 10.0))
def test_gap_play_is_no_licence_to_collapse(gap, width):
    found = gap_play(np.array([0.0, gap]), width, 3)
    assert found.moved.shape == found.turned.shape == (3,)
    assert (found.moved <= min(CLEARANCE.amplified * gap, CLEARANCE.farthest * width)).all()
    assert (found.turned <= min(CLEARANCE.amplified * gap / width, CLEARANCE.steepest)).all()
    assert (found.moved >= min(gap, CLEARANCE.farthest * width)).all()  # a block that falls through the gap


@pytest.mark.parametrize("restack", ["set down", "left"])
def test_gaps_of_blocks_that_do_not_fit_count(restack):
    """A wall whose second course is 0.3 mm too low at one end, or hovers by as much."""
    case = tables(*running_wall(3, 3))
    above = [row for row in case["block"] if row["id"].startswith("b1")]
    for row in above:
        low = [[x, y + (3e-4 if restack == "left" else 0.0)] for x, y in row["vertices"]]
        row["vertices"] = low if restack == "left" else [*low[:2], [low[2][0], low[2][1] - 3e-4], low[3]]
    if restack == "left":
        for row in case["block"]:
            if row["id"].startswith("b2"):
                row["vertices"] = [[x, y + 3e-4] for x, y in row["vertices"]]
    sim = simulation(case, "large")
    assert sim.play.moved == pytest.approx(CLEARANCE.amplified * 3e-4, rel=1e-3)
    assert not simulation(case, "fixed").play.moved.any()
