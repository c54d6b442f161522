"""Benchmarks in space: their loads against statics, and what other programs are given of our models."""

from __future__ import annotations

import numpy as np
import pytest
from bench.kernels import blocks_of
from bench.record import BenchOptions
from bench.spatial import compas_walls, mujoco_walls, peers, sizes
from bench.spatial.associated import associated_job
from bench.spatial.boxes import boxes_of
from bench.spatial.cases import KNOWN_IN_SPACE, MANY, SIZES_IN_SPACE, wall_out_of_plane
from synthetic.spatial_case import spatial_case

from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.limit.analysis import limit_loads
from dem_cli.masonry.assembly.assemble import assemble
from dem_cli.masonry.assembly.solver_request import solver_request

SQUARE = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
TRIANGLE = SQUARE[:3]
CLOSED_FORMS = ["block 30°", "block 60°", "panel"]  # nothing slides: the associated load is the load


@pytest.mark.parametrize("known", KNOWN_IN_SPACE.values(), ids=lambda known: known.name)
def test_associated_loads_are_those_of_exact_cones(known):
    job = associated_job(known)
    job.once()
    assert (known.upper is None) == (known.name in CLOSED_FORMS)
    assert abs(job.result["error"]) < 5e-6


def test_an_l_wall_carries_its_zero_dilation_load():
    known = KNOWN_IN_SPACE["L wall"]
    case, model = known.build()
    path = limit_loads(
        model, joint_properties(solver_request(case), model), law_of(solver_request(case))
    ).non_associated
    assert path.load == pytest.approx(known.path, rel=2e-4)
    assert known.load == pytest.approx(known.path, rel=1e-3)


@pytest.mark.parametrize("known", SIZES_IN_SPACE[:2], ids=lambda known: known.name)
def test_walls_in_space_have_as_many_blocks_as_they_say(known):
    boxes = boxes_of(known.build()[1])
    assert np.count_nonzero(~boxes.fixed) == blocks_of(known)
    top = (boxes.centres + 0.5 * boxes.sizes)[~boxes.fixed].max(axis=0)
    assert top == pytest.approx([20.0, 0.4, 10.0])


def test_sizes_are_those_of_the_targets():
    assert [blocks_of(known) for known in (*SIZES_IN_SPACE, MANY)] == [52, 205, 520, 1001, 2064, 10045]
    assert wall_out_of_plane(3, 2).name == "wall 7"  # 2 + 3 + 2


def test_boxes_fill_the_blocks():
    _, model = KNOWN_IN_SPACE["L wall"].build()
    boxes = boxes_of(model)
    free = ~boxes.fixed
    assert boxes.sizes[free].prod(axis=1) == pytest.approx(model.masses[free] / 2000.0)
    assert boxes.centres[free] == pytest.approx(model.centroids[free])
    assert boxes.smallest_edge == pytest.approx(0.2)


@pytest.mark.parametrize(
    "shape",
    [
        {"polygon": TRIANGLE, "y": [0.0, 1.0]},
        {"vertices": [[x + 0.1 * z, y, z] for x, y in SQUARE for z in (0.0, 1.0)]},  # leans
        {"parts": [[[x + dx, y, z] for x, y in SQUARE for z in (0.0, 1.0)] for dx in (0.0, 1.0)]},
    ],
    ids=["prism", "leaning", "of two parts"],
)
def test_blocks_that_are_no_boxes_are_refused(shape):
    case = spatial_case(block=[{"id": "odd", **shape}], analysis={"kind": "gravity"})
    with pytest.raises(ValueError, match=r"no .*box"):
        boxes_of(assemble(case))


def problem(name: str) -> peers.BoxProblem:
    return peers.problem_of(KNOWN_IN_SPACE[name])


def test_mujoco_gets_our_boxes():
    pytest.importorskip(mujoco_walls.PACKAGE)
    known = KNOWN_IN_SPACE["L wall"]
    _, model = known.build()
    given, setting = problem("L wall"), mujoco_walls.SETTINGS[-1]
    world = mujoco_walls.MujocoWorld(given.boxes, given.friction, given.direction, setting)
    free, scale = ~model.fixed, setting.edge / 0.2
    assert world.places() == pytest.approx(scale * model.centroids[free])
    masses = world.model.body_mass[1:]
    assert masses / masses.sum() == pytest.approx(model.masses[free] / model.masses[free].sum())
    world.tilt(0.25)
    assert world.model.opt.gravity == pytest.approx([0.0, -0.25 * 9.81, -9.81])


@pytest.mark.parametrize("azimuth", [30, 60])
def test_mujoco_turns_a_block_over_its_edge(azimuth):
    """The harder its contacts, the nearer: 0.4 % with the best setting, bisected to 0.5 %."""
    pytest.importorskip(mujoco_walls.PACKAGE)
    errors = []
    for setting in mujoco_walls.SETTINGS[1:]:
        job = peers.tilted(problem(f"block {azimuth}°"), setting, 0.005)
        job.once()
        errors.append(job.result["error"])
    assert errors == sorted(errors)
    assert abs(errors[-1]) < 0.008


def test_compas_finds_our_joints():
    """As many contact points, and the same areas."""
    pytest.importorskip(compas_walls.PACKAGE)
    given = problem("L wall")
    found = compas_walls.RigidAssembly(given.boxes, given.friction, given.direction).assembly
    interfaces = [each for edge in found.graph.edges() for each in found.graph.edge_attribute(edge, "interfaces")]
    job = associated_job(KNOWN_IN_SPACE["L wall"])
    job.once()
    assert sum(len(each.points) for each in interfaces) == job.result["points"]
    beds = 7 * 0.2 * 2.2  # wings of 1.2 m share a corner of 0.2 m
    assert sum(each.size for each in interfaces if abs(each.frame.zaxis[2]) > 0.5) == pytest.approx(beds)


def test_compas_balances_a_block_up_to_its_edge():
    pytest.importorskip(compas_walls.PACKAGE)
    for tension, error in ((1e-5, 0.003), (1e-4, 0.003)):
        job = peers.balanced(problem("block 30°"), tension)
        job.once()
        assert abs(job.result["error"]) < error + peers.RESOLUTION


def test_programs_that_are_not_installed_are_named(monkeypatch):
    monkeypatch.setattr(peers, "find_spec", lambda name: None)
    found = peers.measure(BenchOptions(quick=True))
    assert {record.axis for record in found.records} == {"dem", "dem limit"}
    assert [note.split(" was")[0] for note in found.notes] == ["MuJoCo", "compas_cra", "the load of wall 205 in MuJoCo"]


def test_memory_grows_with_the_points():
    (small, points), (large, more) = (sizes.building(known) for known in SIZES_IN_SPACE[:2])
    assert large / small == pytest.approx(more / points, rel=0.2)
