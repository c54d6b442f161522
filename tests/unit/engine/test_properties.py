"""From the [joints] of a case to contact points: how many, by stiffness, law and analysis; layouts in space."""

from __future__ import annotations

import numpy as np
import pytest
from casefiles import CASES
from engine import block, rectangle, scene, solve, tables

from dem_cli.core.contact.start import bodies_at_rest, joints_of_start
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.model.scales import smallest_edge

CUBE = {"polygon": [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], "y": [0.0, 1.0], "material": "stone"}
ABOVE = CUBE | {"polygon": [[0.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]}


MORTAR = {"law": "mohr-coulomb", "friction": 0.6, "cohesion": 1e5}


@pytest.mark.parametrize(
    ("joint", "stone", "points", "lands"),
    [
        ({"friction": 0.6}, {}, 4, 4),
        ({"friction": 0.6, "points": "vertices+centre"}, {}, 5, 5),
        ({"law": "elastic", "kn": 1e9}, {}, 5, 5),
        ({"friction": 0.6, "kn": 1e9}, {}, 4, 4),  # its pressure is integrated
        ({"friction": 0.6}, {"young": 1e9}, 4, 4),
        ({"friction": 0.6, "points": 3}, {}, 9, 9),
        ({"friction": 0.6, "kn": 1e9, "points": "vertices"}, {}, 4, 4),
        ({"friction": 0.6, "points": 5}, {}, 25, 25),
        (MORTAR, {}, 57, 5),
        (MORTAR | {"kn": 1e9}, {}, 57, 5),
        (MORTAR | {"kn": 1e9, "points": 3}, {}, 9, 9),
        (MORTAR | {"points": "section"}, {}, 57, 57),
        (MORTAR | {"kn": 1e9, "points": "vertices+centre"}, {}, 5, 5),
    ],
)
def test_points_of_a_joint_in_space(joint, stone, points, lands):
    """Where geometry is that of the start, and where it moves, in analyses without time and in time histories."""
    case = {
        "dimension": 3,
        "materials": {"stone": {"density": 2000.0} | stone},
        "joints": {"dry": joint},
        "block": [CUBE | {"id": "base", "fixed": True}, ABOVE | {"id": "b"}],
    }
    for analysis, count in (({"kind": "gravity"}, points), ({"kind": "time-history", "duration": 1.0}, lands)):
        made = scene(case | {"analysis": analysis})
        properties = joint_properties(made.request, made.model)
        built = joints_of_start(made.model, bodies_at_rest(made.model), properties, smallest_edge(made.model))
        assert len(built.joints.kn) == count
        assert built.joints.kn.sum() == pytest.approx(properties.stiffness_of(np.zeros(1, int), built.geometry.keys)[0])
        moving = Simulation(made.model, law_of(made.request), properties, "large")
        assert (moving.joints.kn > 0.0).sum() == count


FRICTION = {"friction": 0.6}
GIVEN = FRICTION | {"kn": 1e9}
SOFTENING = {"softening": {"residual": 0.8, "slip_start": 1e-3, "slip_length": 1e-4}}
YOUNG = {"young": 1e9}


@pytest.mark.parametrize(
    ("joint", "stone", "points"),
    [
        (FRICTION, {}, 2),
        (GIVEN, {}, 2),  # its pressure is integrated
        (GIVEN | {"points": 5}, {}, 5),
        (GIVEN | {"points": 2}, {}, 2),
        (FRICTION | SOFTENING, {}, 2),
        (GIVEN | SOFTENING, {}, 2),
        (GIVEN | {"law": "elastic", "friction": None}, {}, 3),
        (GIVEN | {"law": "crushing", "compression": 1e7}, {}, 16),
        (GIVEN | {"law": "crushing", "compression": 1e7, "points": 5}, {}, 5),
        (GIVEN | {"points": "section"}, {}, 16),
        (GIVEN | {"law": "mohr-coulomb"}, {}, 5),
        (GIVEN | {"profile": {"sides": 3, "aperture": 1e-4}}, {}, 4),
        (FRICTION, YOUNG, 2),
        (FRICTION, YOUNG | {"deformation": "none"}, 2),
        (FRICTION | {"points": 3}, YOUNG, 3),
        (GIVEN, YOUNG | {"deformation": "quadratic"}, 5),
    ],
)
def test_points_follow_stiffness(joint, stone, points):
    joint = {key: value for key, value in joint.items() if value is not None}
    case = tables(
        block("base", rectangle(0.0, -1.0, 1.0, 0.0), fixed=True), block("b", rectangle(0.0, 0.0, 1.0, 1.0)),
        materials={"stone": {"density": 2000.0} | stone}, joints={"dry": joint},
    )  # fmt: skip

    def found(analysis):
        made = scene(case | {"analysis": analysis})
        properties = joint_properties(made.request, made.model)
        bodies, smallest = bodies_at_rest(made.model), smallest_edge(made.model)
        return len(joints_of_start(made.model, bodies, properties, smallest).joints.kn)

    assert found({"kind": "gravity"}) == points
    if points == 5 and "points" not in joint and "law" not in joint:
        # where blocks land on each other the ends alone take the blow, unless they bend between them
        bends = stone.get("deformation") == "quadratic"
        assert found({"kind": "time-history", "duration": 1.0}) == (5 if bends else 2)


@pytest.mark.parametrize(
    ("analysis", "joint", "stone", "integrated"),
    [
        ({"kind": "gravity"}, GIVEN, {}, True),
        ({"kind": "gravity"}, FRICTION, YOUNG, True),
        ({"kind": "gravity"}, FRICTION, {}, False),  # rigid
        ({"kind": "gravity"}, GIVEN | {"points": 2}, {}, False),
        ({"kind": "gravity"}, GIVEN | {"law": "mohr-coulomb", "tension": 1e5, "cohesion": 1e5}, {}, False),
        ({"kind": "gravity"}, GIVEN | {"law": "crushing", "compression": 1e7}, {}, False),
        ({"kind": "gravity"}, GIVEN, YOUNG | {"deformation": "quadratic"}, False),
        ({"kind": "time-history", "duration": 1.0}, GIVEN, {}, False),  # blocks land on the ends
        ({"kind": "modes"}, GIVEN, {}, True),
        ({"kind": "pushover"}, GIVEN, {}, True),
    ],
)
@pytest.mark.parametrize("dimension", [2, 3])
def test_pressure_is_integrated_where_joints_are_elastic(analysis, joint, stone, integrated, dimension):
    if dimension == 3 and "quadratic" in stone.values():
        return
    blocks = [block("base", rectangle(0.0, -1.0, 1.0, 0.0), fixed=True), block("b", rectangle(0.0, 0.0, 1.0, 1.0))]
    more = {}
    if dimension == 3:
        blocks = [{**one, "polygon": one["vertices"], "y": [0.0, 1.0]} for one in blocks]
        blocks, more = [{k: v for k, v in one.items() if k != "vertices"} for one in blocks], {"dimension": 3}
    materials, joints = {"stone": {"density": 2000.0} | stone}, {"dry": joint}
    made = scene(tables(*blocks, materials=materials, joints=joints, analysis=analysis, **more))
    properties = joint_properties(made.request, made.model)
    found = joints_of_start(made.model, bodies_at_rest(made.model), properties, smallest_edge(made.model)).joints
    assert found.integrated.tolist() == ([1] if integrated else [])


def test_points_between_the_ends_leave_limit_analysis_and_its_path():
    """All points of a plane joint lie in one plane: the bound, the path and the load are those of its ends."""
    wanted = ("analysis.follow=0", "analysis.limit=true", "analysis.start='path'")
    two, five = (
        solve(CASES / "verification" / "wall_21.toml", f"joints.dry.points={points}", *wanted)[0] for points in (2, 5)
    )
    assert five["start"]["kind"] == "path"
    for name in ("associated", "non_associated"):
        assert five["limit_analysis"][name] == pytest.approx(two["limit_analysis"][name], rel=1e-6)
    assert five["failure_load"] == pytest.approx(two["failure_load"], rel=1e-3)
