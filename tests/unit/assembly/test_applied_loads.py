"""Loads against closed forms: buoyancy of any solid, thrust of water and earth, weight of fill over an arch."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from synthetic.buoyancy import floating

from dem_cli.core.geometry.rotation import moments
from dem_cli.errors import CaseError
from dem_cli.masonry.assembly.assemble import assembly

GRAVITY, WATER = 9.81, 1000.0
FLOOR = {"id": "floor", "vertices": [[-9, -1], [9, -1], [9, 0], [-9, 0]], "fixed": True}
FLOOR_3D = {"id": "floor", "polygon": [[-9, -1], [9, -1], [9, 0], [-9, 0]], "y": [-9, 9], "fixed": True}
DAM = {"id": "dam", "vertices": [[0, 0], [2, 0], [2, 3], [0, 3]]}
BATTERED = {"id": "dam", "vertices": [[0, 0], [3, 0], [3, 3], [1.5, 3]]}
ARCH = {"kind": "arch", "voussoirs": 15, "shape": "segmental", "span": 4.0, "rise": 1.0, "ring": 0.4}
exactly = {"rel": 1e-12, "abs": 1e-9}


def box(name: str, low, high, **more) -> dict:
    """A block in 3D between two corners."""
    x, z = (low[0], high[0]), (low[2], high[2])
    return {
        "id": name,
        "polygon": [[x[i], z[j]] for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))],
        "y": [low[1], high[1]],
    } | more


def loads_of(case_of, **tables):
    """Applied loads and model."""
    made = assembly(case_of(**tables))
    return made.loads, made.model


def moment(load, about) -> np.ndarray:
    """Of all forces about a point, (r,)."""
    return moments(load.points - np.asarray(about, float), load.forces).sum(axis=0)


def test_water_on_an_upright_wall(case_of):
    """γh²/2 at a third of the height; γh³/6 about the toe."""
    (load,), model = loads_of(
        case_of, block=[DAM, FLOOR], pressure=[{"block": "dam", "face": "-x", "fluid": {"level": 3.0}}]
    )
    weight = WATER * GRAVITY
    assert load.resultant == pytest.approx([weight * 9 / 2, 0.0], **exactly)
    assert moment(load, [2.0, 0.0]) == pytest.approx([-weight * 27 / 6], **exactly)
    assert load.centre == pytest.approx([0.0, 1.0], **exactly)
    assert load.area == pytest.approx(3.0, **exactly)
    dam = model.numbers["dam"]
    assert model.dead_loads[dam, 0] == pytest.approx(weight * 9 / 2)
    assert model.dead_loads[dam, 2] == pytest.approx(-weight * 9 / 2 * (1.0 - 1.5))


def test_water_on_a_battered_wall_lies_on_it_too(case_of):
    """Sideways as on an upright wall; downwards what stands over the face, at the middle of that triangle."""
    (load,), _ = loads_of(
        case_of, block=[BATTERED, FLOOR], pressure=[{"block": "dam", "face": "-x", "fluid": {"level": 3.0}}]
    )
    weight = WATER * GRAVITY
    assert load.resultant == pytest.approx([weight * 9 / 2, -weight * 1.5 * 3 / 2], **exactly)
    assert moment(load, [0.0, 0.0]) == pytest.approx([-weight * 27 / 6 - weight * 2.25 * 0.5], **exactly)


def test_only_between_its_levels_and_below_the_surface(case_of):
    table = {"block": "dam", "face": "-x", "fluid": {"level": 2.5}, "levels": [1.0, 2.8]}
    (load,), _ = loads_of(case_of, block=[DAM, FLOOR], pressure=[table])
    assert load.resultant == pytest.approx([WATER * GRAVITY * 1.5**2 / 2, 0.0], **exactly)
    assert load.centre[1] == pytest.approx(1.5, **exactly)


def test_what_is_covered_is_not_pressed(case_of):
    """A block before the wall covers its lower half but for a strip; each then feels the water before itself."""
    toe = {"id": "toe", "vertices": [[-1, 0.25], [0, 0.25], [0, 1.5], [-1, 1.5]]}
    post = {"id": "post", "vertices": [[-1, 0], [-0.5, 0], [-0.5, 0.25], [-1, 0.25]]}
    table = {"block": "dam", "face": "-x", "uniform": 100.0}
    (load,), _ = loads_of(case_of, block=[DAM, toe, post, FLOOR], pressure=[table])
    assert load.area == pytest.approx(3.0 - 1.25, **exactly)
    assert load.resultant == pytest.approx([175.0, 0.0], **exactly)


def test_a_face_in_space_is_covered_in_part(case_of):
    """Two bricks lean against a wall; what is left is an L with a known middle."""
    bricks = [
        box("low", (0, -1, 0), (1, 0, 2)),
        box("high", (1, -1, 1), (2, 0, 2)),
        box("post", (1, -1, 0), (2, -0.5, 1)),
    ]
    wall = box("wall", (0, 0, 0), (3, 0.5, 2))
    table = {"block": "wall", "face": "-y", "uniform": 10.0}
    (load,), _ = loads_of(case_of, dimension=3, block=[*bricks, wall, FLOOR_3D], pressure=[table])
    assert load.resultant == pytest.approx([0.0, 10.0 * 3.0, 0.0], **exactly)
    assert load.centre == pytest.approx([(1.5 * 1 + 2.5 * 2) / 3, 0.0, (0.5 * 1 + 1.0 * 2) / 3], **exactly)


@settings(max_examples=15, deadline=None)
@given(st.lists(st.tuples(*[st.floats(0.1, 1.0)] * 3), min_size=8, max_size=12, unique=True), st.floats(1.5, 9.0))
def test_a_solid_under_water_is_lifted_by_what_it_displaces(corners, level):
    """Archimedes: γV upwards through the centroid, whatever the shape; every other component is nothing."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        found = ConvexHull(np.array(corners))
    except QhullError:
        return
    if found.volume < 1e-3:
        return
    load, volume, centroid = floating(np.array(corners)[found.vertices], level)
    lift = WATER * GRAVITY * volume
    assert load.resultant == pytest.approx([0.0, 0.0, lift], abs=1e-9 * WATER * GRAVITY * level)
    assert moment(load, centroid) == pytest.approx([0.0] * 3, abs=1e-9 * WATER * GRAVITY * level)


def test_earth_of_rankine_and_coulomb(case_of):
    """K = tan²(45° − φ/2); with wall friction δ the thrust points down by δ, its horizontal part that of Coulomb."""
    earth = {"density": 1800.0, "level": 3.0, "friction_angle_deg": 30.0}
    tables = [
        {"block": "dam", "face": "-x", "earth": earth},
        {"block": "dam", "face": "-x", "earth": earth | {"wall_friction_deg": 20.0}},
    ]
    (rankine, coulomb), _ = loads_of(case_of, block=[DAM, FLOOR], pressure=tables)
    weight = 1800.0 * GRAVITY * 9 / 2
    assert rankine.resultant == pytest.approx([weight / 3, 0.0], **exactly)
    assert np.hypot(*coulomb.resultant) == pytest.approx(0.29731 * weight, rel=1e-4)  # Das, Table 7.7: 0.2973
    assert -coulomb.resultant[1] / coulomb.resultant[0] == pytest.approx(math.tan(math.radians(20.0)), rel=1e-12)


def test_surcharge_pushes_evenly(case_of):
    earth = {"density": 1800.0, "level": 3.0, "coefficient": 0.5, "surcharge": 1000.0}
    (load,), _ = loads_of(case_of, block=[DAM, FLOOR], pressure=[{"block": "dam", "face": "-x", "earth": earth}])
    assert load.resultant == pytest.approx([0.5 * (1800.0 * GRAVITY * 4.5 + 3000.0), 0.0], **exactly)


def above(blocks, level: float) -> shapely.Geometry:
    """What lies over blocks (polygons) up to a level, between their ends."""
    whole = shapely.union_all([shapely.Polygon(corners) for corners in blocks])
    low_x, low_y, high_x, _ = whole.bounds
    rest = shapely.box(low_x, low_y, high_x, level).difference(whole.buffer(1e-12, join_style="mitre"))
    return next(part for part in rest.geoms if part.bounds[3] > level - 1e-9)


@pytest.mark.parametrize("level", [1.6, 3.0])
def test_fill_over_an_arch_weighs_what_lies_there(case_of, level):
    table = {"structure": "arch", "density": 1800.0, "level": level}
    (load,), model = loads_of(case_of, structure=[ARCH], fill=[table])
    corners = np.split(model.vertices + model.centroids[model.vertex_blocks], model.part_starts[1:-1])
    voussoirs = [own for own, block in zip(corners, model.part_blocks) if not model.fixed[block]]
    over = above(voussoirs, level)
    weight = 1800.0 * GRAVITY * over.area
    assert load.resultant == pytest.approx([0.0, -weight], rel=1e-9, abs=1e-6 * weight)  # shapely's buffer: 1e-12 m
    outline = np.concatenate([[v[np.argsort(v[:, 1])[-2:]][:, :] for v in voussoirs]]).reshape(-1, 2)
    outline = outline[np.argsort(outline[:, 0])]
    exact = np.trapezoid(level - outline[:, 1], outline[:, 0])
    assert -load.resultant[1] == pytest.approx(1800.0 * GRAVITY * exact, rel=1e-12)
    assert moment(load, [over.centroid.x, 0.0]) == pytest.approx([0.0], abs=1e-6 * weight)


def test_thrust_of_fill_on_half_an_arch(case_of):
    """K γ (depth at the springing² − depth at the crown²)/2; both halves together push nowhere."""
    table = {"block": "*", "density": 1800.0, "level": 3.0, "friction_angle_deg": 30.0}
    (load,), model = loads_of(case_of, structure=[ARCH], fill=[table])
    left = load.points[:, 0] < np.median(model.centroids[:, 0])
    heights = (model.vertices + model.centroids[model.vertex_blocks])[~model.fixed[model.vertex_blocks]]
    left_most = heights[heights[:, 0].argmin()]
    depths = 3.0 - np.array([left_most[1], heights[:, 1].max()])
    wanted = 0.5 * 1800.0 * GRAVITY * (depths[0] ** 2 - depths[1] ** 2) / 2
    middle = load.blocks == np.argmin(np.abs(model.centroids[:, 0] - 0.5 * np.ptp(heights[:, 0]) - left_most[0]))
    assert load.forces[left & ~middle, 0].sum() == pytest.approx(wanted, rel=1e-9)
    assert load.resultant[0] == pytest.approx(0.0, abs=1e-9 * wanted)


@pytest.mark.parametrize("angle", [37.0, 90.0])
def test_fill_turns_with_what_it_lies_on(case_of, angle):
    """Rows of voussoirs across a bridge lie in the same planes: seen askew none of them is over another one."""
    rows = {"kind": "bridge", "span": 4.0, "rise": 1.0, "ring": 0.4, "voussoirs": 7, "width": 2.0, "rows": 3}
    fill = {"structure": "bridge", "density": 1700.0, "level": 2.0, "coefficient": 0.5}
    (there,), model = loads_of(case_of, dimension=3, structure=[rows], fill=[fill])
    (turned,), other = loads_of(case_of, dimension=3, structure=[rows | {"rotation_deg": angle}], fill=[fill])
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    back = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    for block, name in enumerate(model.block_ids):
        wanted = there.forces[there.blocks == block].sum(axis=0)
        found = turned.forces[turned.blocks == other.numbers[name]].sum(axis=0) @ back
        assert found == pytest.approx(wanted, rel=1e-9, abs=1e-6)


def test_no_fill_under_a_roof_and_none_beside_it(case_of):
    """A slab over half of a step: fill on the other half of it, on the slab, and against the step within its extent."""
    blocks = [
        {"id": "step", "vertices": [[0, 0], [4, 0], [4, 1], [0, 1]]},
        {"id": "post", "vertices": [[3.5, 1], [4, 1], [4, 2], [3.5, 2]]},
        {"id": "slab", "vertices": [[2, 2], [4, 2], [4, 2.5], [2, 2.5]]},
    ]
    table = {"block": "s*", "density": 1000.0, "level": 3.0, "coefficient": 0.5, "extent": [-1.0, 3.0]}
    (load,), model = loads_of(case_of, block=[*blocks, FLOOR], fill=[table])
    down = {
        name: -load.forces[load.blocks == model.numbers[name], 1].sum() / (1000.0 * GRAVITY)
        for name in ("step", "slab")
    }
    assert down == pytest.approx({"step": 2 * 2.0, "slab": 1 * 0.5}, **exactly)
    sideways = {name: load.forces[load.blocks == model.numbers[name], 0].sum() for name in ("step", "slab")}
    thrust = {"step": (3**2 - 2**2) / 2, "slab": (1**2 - 0.5**2) / 2}
    assert sideways == pytest.approx({k: 0.5 * 1000.0 * GRAVITY * v for k, v in thrust.items()}, **exactly)


@pytest.mark.parametrize("kind", ["fluid", "earth"])
def test_a_planar_twin_feels_the_same_pressure(case_of, kind):
    """A battered wall 0.7 m deep: the same forces and moments in 2D and 3D."""
    table = {
        "block": "dam",
        kind: {"density": 1700.0, "level": 2.0} | ({"coefficient": 0.4} if kind == "earth" else {}),
    }
    flat_floor = FLOOR | {"thickness": 0.7}
    (flat,), _ = loads_of(case_of, block=[BATTERED | {"thickness": 0.7}, flat_floor], pressure=[table | {"face": "-x"}])
    solid_dam = {"id": "dam", "polygon": BATTERED["vertices"], "y": [-0.35, 0.35]}
    (solid,), _ = loads_of(case_of, dimension=3, block=[solid_dam, FLOOR_3D], pressure=[table | {"face": "-x"}])
    assert solid.resultant == pytest.approx([flat.resultant[0], 0.0, flat.resultant[1]], **exactly)
    about = moment(flat, [0.0, 0.0])[0]
    assert moment(solid, [0.0, 0.0, 0.0]) == pytest.approx([0.0, -about, 0.0], **exactly)


def test_faces_that_look_at_a_point(case_of):
    """An octagon of posts around the origin under pressure from within: all inner faces, outwards, in balance."""
    ring = []
    for k in range(8):
        angle = math.pi / 4 * k
        low, high = (
            [
                [
                    r * math.cos(angle + s * math.pi / 8) / math.cos(math.pi / 8),
                    r * math.sin(angle + s * math.pi / 8) / math.cos(math.pi / 8),
                ]
                for s in (-1, 1)
            ]
            for r in (2.0, 2.5)
        )
        corners = [[*p, z] for p in (*low, *high) for z in (0.0, 1.0)]
        ring.append({"id": f"p{k}", "vertices": corners})
    table = {"block": "p*", "facing": [0.0, 0.0, 0.5], "uniform": 100.0}
    (load,), model = loads_of(case_of, dimension=3, block=[*ring, FLOOR_3D], pressure=[table])
    side = 2 * 2.0 * math.tan(math.pi / 8)
    assert load.area == pytest.approx(8 * side, **exactly)
    assert load.resultant == pytest.approx([0.0] * 3, abs=1e-9)
    post = load.blocks == model.numbers["p0"]
    assert load.forces[post].sum(axis=0) == pytest.approx([100.0 * side, 0.0, 0.0], abs=1e-9)


def test_a_force_on_several_is_shared_by_mass(case_of):
    blocks = [DAM, {"id": "daughter", "vertices": [[4, 0], [5, 0], [5, 1], [4, 1]]}, FLOOR]
    tables = [{"block": "da*", "force": [700.0, -70.0]}, {"block": "da*", "force": [3.0, 0.0], "each": True}]
    (shared, each), model = loads_of(case_of, block=blocks, load=tables)
    assert shared.resultant.tolist() == [700.0, -70.0]
    at_dam = shared.blocks == model.numbers["dam"]
    assert shared.forces[at_dam][0] == pytest.approx([600.0, -60.0], rel=1e-15)
    assert each.forces.tolist() == [[3.0, 0.0]] * 2
    assert np.array_equal(shared.points, model.centroids[shared.blocks])


def test_a_line_load_is_shared_by_length(case_of):
    """Across three blocks of an uneven top, the middle one lower; on a joint both have half."""
    blocks = [
        box("a", (0, 0, 0), (1, 1, 1)), box("b", (1, 0, 0), (3, 1, 0.5)), box("c", (3, 0, 0), (4, 1, 1)), FLOOR_3D,
    ]  # fmt: skip
    tables = [
        {"line": [[0.5, 0.5, 1.0], [3.25, 0.5, 1.0]], "force_per_length": [0.0, 0.0, -100.0]},
        {"line": [[1.0, 0.0, 1.0], [1.0, 1.0, 1.0]], "force_per_length": [0.0, 0.0, -100.0]},
        {"at": [2.0, 0.5, 1.5], "force": [0.0, 0.0, -60.0], "spread": 0.5},
    ]
    (across, along, axle), model = loads_of(case_of, dimension=3, block=blocks, load=tables)
    parts = {name: across.forces[across.blocks == model.numbers[name], 2].sum() for name in "abc"}
    assert parts == pytest.approx({"a": -50.0, "b": -200.0, "c": -25.0}, rel=1e-9)
    assert across.resultant == pytest.approx([0.0, 0.0, -275.0], **exactly)
    halves = {name: along.forces[along.blocks == model.numbers[name], 2].sum() for name in "ab"}
    assert halves == pytest.approx({"a": -50.0, "b": -50.0}, rel=1e-9)
    spread = axle.points[axle.blocks == model.numbers["b"]]
    assert np.ptp(spread[:, 0]) <= 1.0 + 1e-5  # a metre deep, two down to one aside: half a metre to each side
    assert axle.resultant == pytest.approx([0.0, 0.0, -60.0], **exactly)
    assert axle.centre == pytest.approx([2.0, 0.5, 0.5], abs=1e-9)


def turned(table: dict, keys: tuple[str, ...], degrees: float) -> dict:
    """A table with places and vectors turned in plan."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return table | {key: (np.asarray(table[key], float) @ turn.T).tolist() for key in keys if key in table}


def test_loads_turn_with_the_case(case_of):
    """Three stones with uneven tops under axles on a point and along a line, fill, earth: turned by 30° in plan the
    loads on each stone and their moments are those of before, turned."""
    stones = []
    for name, low, high in (("a", 0.0, 1.0), ("b", 1.0, 1.8), ("c", 1.8, 3.0)):
        top = [[low, 0.0, 1.0 + 0.2 * low], [high, 0.0, 1.0], [high, 2.0, 1.2], [low, 2.0, 1.2 + 0.2 * low]]
        stones.append({"id": name, "vertices": [[x, y, 0.0] for x, y, _ in top] + top})
    tables = [
        {"at": [1.1, 0.3, 2.5], "force": [3.0, 1.0, -60.0], "spread": 0.4},
        {"at": [1.0, 1.0, 2.0], "force": [0.0, 0.0, -1.0]},
        {"line": [[0.3, 0.2, 2.0], [2.5, 1.5, 2.0]], "force_per_length": [0.0, 1.0, -7.0], "spread": 0.3},
    ]
    floor = {"id": "floor", "vertices": [[x, y, z] for x in (-9, 9) for y in (-9, 9) for z in (-1, 0)], "fixed": True}
    found = []
    for angle in (0.0, 30.0):
        blocks = [turned(stone, ("vertices",), angle) for stone in stones]
        loads, model = loads_of(
            case_of, dimension=3, block=[*blocks, floor],
            load=[turned(table, ("at", "force", "line", "force_per_length"), angle) for table in tables],
            fill=[{"block": "?", "density": 1800.0, "level": 2.0, "coefficient": 0.5}],
        )  # fmt: skip
        sums = []
        for load in loads:
            for name in "abc":
                on = load.blocks == model.numbers[name]
                force, moment = load.forces[on].sum(axis=0), moments(load.points[on], load.forces[on]).sum(axis=0)
                sums += [turned({"v": [force, moment]}, ("v",), -angle)["v"]]
        found.append(np.array(sums))
    assert np.abs(found[0][0]).max() > 1.0
    sizes = np.abs(found[0]).reshape(4, -1).max(axis=1)
    errors = np.abs(found[1] - found[0]).reshape(4, -1).max(axis=1)
    assert (errors[[0, 2, 3]] <= 2e-12 * sizes[[0, 2, 3]]).all()  # depths are those in strips of a micrometre
    assert errors[1] <= 1e-9  # a disc of a micrometre


def test_an_axle_in_the_plane_acts_where_it_stands(case_of):
    """On the extrados under it, with its moment, also on a joint; spread through fill, still with its moment."""
    (load, wide), _ = loads_of(
        case_of, structure=[ARCH],
        load=[{"at": [1.0, 5.0], "force": [0.0, -1.0]}, {"at": [1.0, 2.0], "force": [0.0, -1.0], "spread": 0.5}],
    )  # fmt: skip
    for one in (load, wide):
        assert one.resultant.tolist() == pytest.approx([0.0, -1.0])
        assert moment(one, [1.0, 0.0]) == pytest.approx([0.0], abs=2e-2 if one is wide else 1e-9)
    assert len(set(wide.blocks.tolist())) > len(set(load.blocks.tolist()))


def test_fill_has_its_share_in_the_load_where_asked(case_of):
    """Pattern mass: λ times the weight of the fill, at the points at which it lies."""
    table = {"block": "dam", "density": 1800.0, "level": 4.0, "inertia": True}
    (load,), model = loads_of(
        case_of, block=[DAM, FLOOR], fill=[table], analysis={"pattern": "mass", "direction": [1.0, 0.0]}
    )
    weight, dam = 1800.0 * GRAVITY * 2.0, model.numbers["dam"]
    assert load.weights.sum() == pytest.approx(weight, **exactly)
    assert model.live_loads[dam] == pytest.approx([model.masses[dam] * GRAVITY + weight, 0.0, -weight * 1.5])


WRONG = [
    ("pressure", {"block": "dam", "face": "+x", "uniform": 1.0, "levels": [4.0, 5.0]}, "levels", "between 0 and 3 m"),
    (
        "pressure",
        {"block": "dam", "face": "bottom", "uniform": 1.0},
        "face",
        "that nothing covers looks towards 'bottom'",
    ),
    ("fill", {"block": "dam", "density": 1800.0, "level": 2.0}, "level", "no face of 'dam' looks up"),
    ("load", {"at": [30.0, 9.0], "force": [0.0, -1.0]}, "at", "there is no block under [30, 9]"),
    (
        "load",
        {"block": "dam", "line": [[1.0, 9.0], [3.0, 9.0]], "force_per_length": [0.0, -1.0]},
        "line",
        "1 m of it lie",
    ),
]


@pytest.mark.parametrize(("key", "table", "where", "says"), WRONG, ids=[row[2] for row in WRONG])
def test_loads_on_nothing(case_of, key, table, where, says):
    with pytest.raises(CaseError) as caught:
        loads_of(case_of, block=[DAM, FLOOR], **{key: [table]})
    (problem,) = caught.value.problems
    assert problem.path == (key, 0, where)
    assert says in problem.message
