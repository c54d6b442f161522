"""From case to arrays in 3D: generators as prisms, blocks by hand, masses, loads of each pattern, names, order."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dem_cli.errors import CaseError
from dem_cli.masonry.assembly.assemble import assemble

CUBE = [[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)]
CUBE_FACES = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]]
FLOOR = {"id": "floor", "polygon": [[-9, -1], [9, -1], [9, 0], [-9, 0]], "y": [-9, 9], "fixed": True}
TETRAHEDRON = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
ARCH = {"kind": "arch", "voussoirs": 9, "radius": 1.0, "ring": 0.2, "thickness": 0.7}
COLUMN = {"kind": "column", "block": [0.5, 0.4], "courses": 3, "top_width": 0.3, "thickness": 0.6}


@pytest.fixture
def space(case_of):
    """A function from the tables of a case in 3D to its model."""
    return lambda **tables: assemble(case_of(dimension=3, **tables))


@pytest.fixture
def structures(wall):
    """A table of each generator."""
    return {"wall": wall, "arch": ARCH, "column": COLUMN}


@pytest.mark.parametrize("kind", ["wall", "arch", "column"])
def test_a_generated_structure_is_the_planar_one_extruded(kind, structures, case_of, space):
    """Same blocks in the same order with the same masses, joints of the plane at y = 0, thickness to both sides."""
    table = structures[kind]
    flat, solid = assemble(case_of(structure=[table])), space(structure=[table])
    assert solid.block_ids == flat.block_ids
    assert solid.aliases == flat.aliases
    assert solid.masses == pytest.approx(flat.masses, rel=1e-13)
    assert solid.centroids[:, [0, 2]] == pytest.approx(flat.centroids, abs=1e-14)
    assert solid.centroids[:, 1] == pytest.approx(0.0, abs=1e-16)
    assert solid.thickness.tolist() == [1.0] * solid.n_blocks
    corners = solid.vertices + solid.centroids[solid.vertex_blocks]
    half = flat.thickness[0] / 2
    assert np.unique(corners[:, 1]) == pytest.approx([-half, half])
    assert solid.live_loads[:, 0] == pytest.approx(flat.live_loads[:, 0])
    assert solid.dead_loads[:, 2] == pytest.approx(flat.dead_loads[:, 1])
    for array in solid:
        if isinstance(array, np.ndarray):
            assert array.flags["C_CONTIGUOUS"]


def test_moments_of_inertia_of_a_course(space, wall):
    model = space(structure=[wall])
    a, b, c = 0.04, 0.08, 0.0175
    full = model.block_ids.index("wall-2-2")
    moments = np.array([b * b + c * c, a * a + c * c, a * a + b * b]) * model.masses[full] / 12
    assert model.inertias[full] == pytest.approx(moments)
    assert model.principal_axes[full] == pytest.approx([1.0, 0.0, 0.0, 0.0])


@given(angle=st.floats(-180.0, 180.0), x=st.floats(-5.0, 5.0), y=st.floats(-5.0, 5.0), z=st.floats(-5.0, 5.0))
@settings(deadline=None, max_examples=25)
def test_a_structure_is_turned_in_plan_and_shifted(angle, x, y, z):
    from synthetic.spatial_case import spatial_case

    still = assemble(spatial_case(structure=[ARCH]))
    moved = assemble(spatial_case(structure=[ARCH | {"origin": [x, y, z], "rotation_deg": angle}]))
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    places = still.centroids @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) + [x, y, z]
    order = [moved.block_ids.index(name) for name in still.block_ids]
    assert moved.centroids[order] == pytest.approx(places, abs=1e-12)
    assert moved.masses[order] == pytest.approx(still.masses, rel=1e-12)


@pytest.mark.parametrize("kind", ["wall", "column"])
def test_a_thickness_within_the_block(kind, structures, space, case_of):
    table = structures[kind]
    within = {key: value for key, value in table.items() if key != "thickness"}
    within["block"] = [*table["block"], table["thickness"]]
    assert space(structure=[within]).masses.tolist() == space(structure=[table]).masses.tolist()
    with pytest.raises(CaseError, match="block and thickness say the same; give one of them"):
        space(structure=[within | {"thickness": 0.1}])
    with pytest.raises(CaseError, match="must be a list of 2 numbers > 0"):
        case_of(structure=[within])


def test_blocks_are_numbered_from_the_lowest_up_along_x_then_y(space, wall):
    across = space(structure=[wall | {"rotation_deg": 90.0}])
    assert across.block_ids[:5] == ("wall-base", "wall-1-1", "wall-1-2", "wall-1-3", "wall-1-4")
    grid = [
        {"id": f"{i}{j}{k}", "polygon": [[i, k], [i + 1, k], [i + 1, k + 1], [i, k + 1]], "y": [j, j + 1]}
        for j in range(2)
        for i in range(2)
        for k in range(2)
    ]
    assert space(block=grid).block_ids == ("000", "010", "100", "110", "001", "011", "101", "111")


SAME_CUBE = [
    {"vertices": CUBE},
    {"vertices": CUBE, "faces": CUBE_FACES},
    {"polygon": [[0, 0], [1, 1], [1, 0], [0, 1]], "y": [0, 1]},
    {"parts": [[[x, y, z / 2] for x, y, z in CUBE], {"vertices": [[x, y, (z + 1) / 2] for x, y, z in CUBE]}]},
    {"parts": [{"vertices": [[x / 2, y, z] for x, y, z in CUBE], "faces": CUBE_FACES},
               [[(x + 1) / 2, y, z] for x, y, z in CUBE]]},
]  # fmt: skip


@pytest.mark.parametrize("shape", SAME_CUBE)
def test_a_cube_however_it_is_drawn(shape, space):
    model = space(block=[{"id": "a", **shape}])
    assert model.masses == pytest.approx([2143.0])
    assert model.centroids[0] == pytest.approx([0.5, 0.5, 0.5])
    assert model.inertias[0] == pytest.approx([2143.0 / 6] * 3)
    assert model.n_parts == len(shape.get("parts", [1]))


def test_point_loads_about_the_centroid(space):
    loads = [
        {"block": "a", "force": [0.0, 0.0, -500.0], "at": [0.75, 0.5, 1.0]},
        {"block": "a", "force": [30.0, 0.0, 0.0], "at": [0.0, 0.0, 1.0], "kind": "live"},
        {"block": "a", "force": [1.0, 2.0, 3.0], "kind": "live"},
    ]
    model = space(block=[{"id": "a", "vertices": CUBE}, FLOOR], load=loads, analysis={"pattern": "live"})
    a = model.numbers["a"]
    assert model.dead_loads[a] == pytest.approx([0.0, 0.0, -500.0 - 9.81 * 2143.0, 0.0, 125.0, 0.0])
    assert model.live_loads[a] == pytest.approx([31.0, 2.0, 3.0, 0.0, 15.0, 15.0])
    assert not model.live_loads[1 - a].any()


def test_pattern_mass_in_any_direction(space, wall):
    model = space(structure=[wall], analysis={"direction": [3.0, -4.0, 0.0]})
    weight = np.where(model.fixed, 0.0, 9.81 * model.masses)
    assert model.live_loads[:, :3] == pytest.approx(weight[:, None] * [0.6, -0.8, 0.0])
    assert not model.live_loads[:, 3:].any()


@given(azimuth=st.floats(0.0, 360.0), angle=st.floats(0.0, 80.0), pull=st.floats(-900.0, 900.0))
@settings(deadline=None, max_examples=25)
def test_a_table_that_tilts_towards_any_side(azimuth, angle, pull):
    """Dead loads × cos θ + live loads × sin θ: gravity and point loads turned by θ about the horizontal axis."""
    from synthetic.spatial_case import spatial_case

    azimuth, angle = math.radians(azimuth), math.radians(angle)
    towards = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
    force = pull * towards + [0.0, 0.0, 300.0]
    model = assemble(
        spatial_case(
            block=[{"id": "a", "vertices": CUBE}, FLOOR],
            load=[{"block": "a", "force": force.tolist(), "at": [1.0, 1.0, 1.0]}],
            analysis={"pattern": "tilt", "direction": (2.0 * towards).tolist()},
        )
    )
    axis = np.cross(towards, [0.0, 0.0, 1.0])  # −z turned by +90° about it points towards

    def turned(vector):
        return math.cos(angle) * vector + math.sin(angle) * np.cross(axis, vector)

    a = model.numbers["a"]
    found = math.cos(angle) * model.dead_loads[a] + math.sin(angle) * model.live_loads[a]
    assert found[:3] == pytest.approx(turned(force) + turned(np.array([0.0, 0.0, -9.81 * 2143.0])), abs=1e-9)
    assert found[3:] == pytest.approx(np.cross([0.5, 0.5, 0.5], turned(force)), abs=1e-9)


def test_a_block_by_hand_beside_a_generator(space, wall):
    model = space(structure=[wall], block=[{"id": "t", "vertices": TETRAHEDRON}])
    t = model.numbers["t"]
    assert model.masses[t] == pytest.approx(2143.0 / 6)
    assert model.centroids[t] == pytest.approx([0.25, 0.25, 0.25])


BAD = {
    "block.0.vertices: the corners lie in one plane: the polyhedron has no volume": {
        "block": [FLOOR | {"polygon": None, "y": None, "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]}]
    },
    "block.0.polygon: the corners lie on one line: the polygon has no area": {
        "block": [FLOOR | {"polygon": [[0, 0], [1, 1], [2, 2]]}]
    },
    "analysis.direction: [0, 0, 0] is not allowed; a direction has a length": {
        "block": [FLOOR],
        "analysis": {"direction": [0.0, 0.0, 0.0]},
    },
    "analysis.direction: a table tilts sideways; the direction is horizontal": {
        "block": [FLOOR],
        "analysis": {"direction": [0.0, 0.0, 1.0], "pattern": "tilt"},
    },
    "load.0.force: [0, 5, -1] is not allowed: it has a part along the axis about which the table tilts": {
        "block": [FLOOR],
        "analysis": {"direction": [1.0, 0.0, 0.0], "pattern": "tilt"},
        "load": [{"block": "floor", "force": [0.0, 5.0, -1.0]}],
    },
}


@pytest.mark.parametrize("says", BAD)
def test_what_is_wrong(says, case_of):
    tables = {
        key: [{k: v for k, v in table.items() if v is not None} for table in value]
        if isinstance(value, list)
        else value
        for key, value in BAD[says].items()
    }
    with pytest.raises(CaseError) as caught:
        assemble(case_of(dimension=3, **tables))
    assert [f"{'.'.join(map(str, p.path))}: {p.message}" for p in caught.value.problems] == [says]


ERRORS = [
    {"height": [-0.0005, 0.0005], "length": {"mean": 0.0, "deviation": 0.0001}, "wedge": 0.0002},
    {"block": "wall-3-2", "height": 0.0003},
    {"lean": 0.01, "restack": False},
]


def test_imperfections_are_those_of_the_elevation(case_of, space, wall):
    """A wall with errors is the planar one extruded, wherever it stands; another one beside it has its own."""
    turned = wall | {"rotation_deg": 90.0, "origin": [1.0, 2.0, 3.0], "sides": [{"face": "-y", "strip": 0.02}]}
    flat = assemble(case_of(structure=[wall], imperfection=ERRORS))
    solid = space(structure=[turned, wall | {"id": "other"}], imperfection=ERRORS)
    for name in flat.block_ids:
        i, j = flat.numbers[name], solid.numbers[name]
        planar = flat.vertices[flat.vertex_blocks == i] + flat.centroids[i]
        corners = solid.vertices[solid.vertex_blocks == j] + solid.centroids[j]
        found = np.column_stack([corners[:, 1] - 2.0, corners[:, 2] - 3.0])  # x of the wall runs along y
        assert found == pytest.approx(np.tile(planar, (2, 1)), abs=1e-12)
        assert np.unique(corners[:, 0].round(9)) == pytest.approx([0.96, 1.04])
        assert solid.masses[j] == pytest.approx(flat.masses[i], rel=1e-9)
    assert solid.masses[solid.numbers["other-3-2"]] != pytest.approx(solid.masses[solid.numbers["wall-3-2"]], rel=1e-6)


NO_IMPERFECTIONS = {
    "imperfection.0.block: a block drawn by hand has no imperfections in 3D; draw it as it is": {"block": "t"},
    "imperfection.0: block 't' is drawn by hand and has none in 3D: say which 'structure' is meant": {},
    "imperfection.0.structure: structure 'arch' is of kind 'arch'; only walls, columns and blocks drawn by hand have "
    "imperfections": {"structure": "arch"},
}


@pytest.mark.parametrize("says", NO_IMPERFECTIONS)
def test_imperfections_that_there_are_none_of(says, space, wall):
    table = NO_IMPERFECTIONS[says] | {"height": 0.1}
    with pytest.raises(CaseError) as caught:
        space(structure=[wall, ARCH], block=[{"id": "t", "vertices": TETRAHEDRON}], imperfection=[table])
    assert [f"{'.'.join(map(str, p.path))}: {p.message}" for p in caught.value.problems] == [says]
