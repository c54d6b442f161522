"""From the [joints] of a case to contact points: layouts of joints in space."""

from __future__ import annotations

import pytest
from engine import scene

from dem_cli.contact.start import bodies_at_rest, joints_of_start
from dem_cli.engine.properties import joint_properties
from dem_cli.model.scales import smallest_edge

CUBE = {"polygon": [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], "y": [0.0, 1.0], "material": "stone"}
ABOVE = CUBE | {"polygon": [[0.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]}


@pytest.mark.parametrize(
    ("joint", "points"),
    [
        ({"law": "coulomb", "friction": 0.6}, 4),
        ({"law": "coulomb", "friction": 0.6, "points": "vertices+centre"}, 5),
        ({"law": "elastic"}, 9),
        ({"law": "coulomb", "friction": 0.6, "kn": 1e9}, 9),
        ({"law": "coulomb", "friction": 0.6, "kn": 1e9, "points": "vertices"}, 4),
        ({"law": "coulomb", "friction": 0.6, "points": 5}, 25),
        ({"law": "mohr-coulomb", "friction": 0.6, "cohesion": 1e5}, 9),
    ],
)
def test_points_of_a_joint_in_space(joint, points):
    made = scene(
        {
            "dimension": 3,
            "materials": {"stone": {"density": 2000.0}},
            "joints": {"dry": joint},
            "block": [CUBE | {"id": "base", "fixed": True}, ABOVE | {"id": "b"}],
            "analysis": {"kind": "gravity"},
        }
    )
    properties = joint_properties(made.case, made.model)
    built = joints_of_start(made.model, bodies_at_rest(made.model), properties, smallest_edge(made.model))
    assert len(built.joints.kn) == points
    assert built.joints.kn.sum() == pytest.approx(properties.kn[0])
