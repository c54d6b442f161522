"""Stones that crack: cuts, names of pieces, the joint between them, its strength in closed form, what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, scene, simulation

from dem_cli.case.base import Crack
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.geometry import polyhedron
from dem_cli.core.kernels import records as slot
from dem_cli.core.limit.analysis import limit_loads
from dem_cli.core.model.blocks import Block
from dem_cli.core.model.places import undeformed
from dem_cli.errors import CaseError
from dem_cli.masonry.assembly import sanity
from dem_cli.masonry.assembly.assemble import assembly
from dem_cli.masonry.assembly.cracks import cracked

GLUE = {"law": "mohr-coulomb", "friction": 1.0, "cohesion": 1e9, "tension": 5e8}


def wall(crack="glue", dimension: int = 2, **more) -> dict:
    """Four courses in running bond, pushed by their mass."""
    push = {"kind": "pushover", "pattern": "mass", "direction": [1.0] + [0.0] * (dimension - 1)}
    drawn = {"kind": "wall", "id": "w", "block": [0.4, 0.2], "courses": 4, "blocks_per_course": 3, "thickness": 0.3}
    return {
        "dimension": dimension,
        "materials": {"stone": {"density": 2000.0}},
        "joints": {"dry": {"friction": 0.7}, "glue": GLUE},
        "structure": [drawn | ({"crack": crack} if crack else {}) | more],
        "analysis": push,
    }


@pytest.mark.parametrize("dimension", [2, 3])
def test_blocks_are_cut_at_mid_length(dimension):
    """Pieces have the names of their stones, half of their volume, and together their corners; the base is whole."""
    whole, made = scene(wall(None, dimension)).model, scene(wall(dimension=dimension)).model
    free = [name for name in whole.block_ids if not name.endswith("base")]
    assert sorted(set(made.block_ids) - set(whole.block_ids)) == sorted(f"{name}/{k}" for name in free for k in "ab")
    volumes = dict(zip(made.block_ids, made.shapes.volumes, strict=True))
    for name in free:
        stone = whole.shapes.volumes[whole.numbers[name]]
        assert [volumes[f"{name}/a"], volumes[f"{name}/b"]] == pytest.approx([stone / 2, stone / 2])
    a, b = (made.centroids[made.numbers[f"w-1-2/{k}"]] for k in "ab")
    assert b - a == pytest.approx([0.2] + [0.0] * (dimension - 1))
    assert {tuple(corner) for corner in undeformed(whole).round(9)} <= {
        tuple(corner) for corner in undeformed(made).round(9)
    }


def test_the_joint_is_that_of_the_stone_within_it_and_of_the_materials_elsewhere():
    made = scene(wall())
    properties = joint_properties(made.request, made.model)
    pairs = np.array([[made.model.numbers[name] for name in pair] for pair in
                      (("w-1-1/a", "w-1-1/b"), ("w-1-1/b", "w-1-2/a"), ("w-base", "w-1-1/a"))])  # fmt: skip
    assert [properties.names[k] for k in properties.between(made.model, pairs)] == ["glue", "dry", "dry"]


@pytest.mark.parametrize("dimension", [2, 3])
def test_stones_that_do_not_crack_carry_what_whole_ones_do(dimension):
    """Limit analysis: pieces that nothing parts are one block."""
    loads = []
    for crack in (None, "glue", {"joint": "glue", "at": [0.2, 0.5]}):
        made = scene(wall(crack, dimension))
        properties = joint_properties(made.request, made.model)
        found = limit_loads(made.model, properties, law_of(made.request), associated_only=True)
        loads.append(found.associated.multiplier)
    assert loads[1:] == pytest.approx([loads[0]] * 2, rel=1e-5)


@pytest.mark.parametrize(("share", "edges"), [(0.995, 0), (1.003, 1)])
def test_a_stone_cracks_at_its_bending_strength(share, edges):
    """A brittle stone that stands on end, pushed at its top: its edge goes at M = (ft + N/A) b h²/6 at mid length."""
    wide, tall, ft, kn = 0.2, 0.6, 1e5, 1e10
    pressed = 2000.0 * 9.81 * tall / 2
    push = share * (ft + pressed) * wide**2 / 6 / (tall / 2)
    case = {
        "materials": {"stone": {"density": 2000.0}, "rock": {"density": 2000.0}},
        "joints": {
            "dry": {"friction": 0.7},
            "held": {"law": "elastic", "kn": kn, "ks": kn},
            "crack": {
                "law": "fracture", "friction": 0.7, "tension": ft, "cohesion": 1e7, "kn": kn, "ks": kn, "points": 5,
                "fracture_energy_tension": 1.001 * ft**2 / kn, "fracture_energy_shear": 1.001e14 / kn,
            },
        },
        "interface": [{"between": ["stone", "rock"], "joint": "held"}],
        "structure": [{"kind": "column", "id": "c", "material": "stone", "block": [wide, tall], "courses": 1,
                       "base": False, "crack": "crack"}],
        "block": [block("rock", rectangle(-1.0, -0.2, 1.0, 0.0), fixed=True, material="rock")],
        "load": [{"block": "c-1/b", "force": [push, 0.0], "at": [0.0, tall]}],
        "analysis": {"kind": "gravity", "kinematics": "fixed"},
    }  # fmt: skip
    sim = simulation(case)
    sim.use_combined_damping()
    for dead in np.linspace(0.005, 1.0, 200):  # so slowly that it hardly swings
        sim.set_dead_share(dead)
        sim.advance(200, slot.HOLD_LOAD)
    assert sim.unbalanced < 1e-2
    assert int((sim.contacts.memory[:, 0] < 0.999)[sim.joints.owners == 1].sum()) == edges


def test_planes_cross_the_length_whatever_stands_or_leans():
    """Across the longest direction; where none is longer, across x; pieces share the corners of the cut exactly."""
    c, s = np.cos(0.3), np.sin(0.3)
    bar = rectangle(0.0, 0.0, 0.2, 0.6) @ np.array([[c, s], [-s, c]])
    square = np.array(rectangle(1.0, 0.0, 1.5, 0.5))
    solid = polyhedron.box([0.0, 0.0, 0.0], [0.2, 0.2, 0.7])
    found = cracked([Block("bar", (bar,), "", mass=3.0), Block("square", (square,), ""), Block("solid", (solid,), "")],
                    Crack(joint="crack", at=(0.25,)))  # fmt: skip
    low, high, left, _, foot, head = (piece.parts[0] for piece in found)
    assert [piece.mass for piece in found[:2]] == pytest.approx([0.75, 2.25])
    assert np.ptp(low @ [-s, c]) == pytest.approx(0.15)
    assert left[:, 0].max() == 1.125
    assert foot.vertices[:, 2].max() == 0.175
    for one, other in ((low, high), (foot.vertices, head.vertices)):
        assert len({tuple(p) for p in one} & {tuple(p) for p in other}) == 2 * (one.shape[1] - 1)


def test_aliases_name_pieces():
    """ "top-right" is the piece in that corner."""
    assert dict(scene(wall()).model.aliases)["top-right"] == "w-4-3/b"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"crack": "glu"}, "did you mean 'glue'"),
        ({"crack": {"joint": "glu"}}, "structure.0.crack.joint|did you mean 'glue'"),
        ({"crack": {"joint": "glue", "at": [0.5, 0.2]}}, "the shares ascend"),
        ({"crack": {"joint": "glue", "at": [1.0]}}, "must be a number > 0 and < 1"),
    ],
)
def test_cracks_that_cannot_be_are_refused(change, said):
    with pytest.raises(CaseError, match=said):
        scene(wall(**change))


def test_imperfections_know_no_pieces():
    with pytest.raises(CaseError, match="not known beside"):
        scene(wall() | {"imperfection": [{"structure": "w", "position": 0.001}]})


def test_a_joint_without_tension_within_stones_is_worth_a_word():
    case = scene(wall("dry")).case
    made = assembly(case)
    doubts = sanity.doubts(case, made.model, made.blocks, made.loads)
    said = [doubt.message for doubt in doubts if doubt.path[-1] == "crack"]
    assert said == ["joint 'dry' has no tension: the pieces of a stone are stones of their own"]
