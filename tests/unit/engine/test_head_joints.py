"""Head joints of their own: unfilled, of another law, in the loop, in limit analysis and on its path; friction drawn
for each joint. Against the same walls drawn by hand, closed forms, and the thesis's walls with smooth heads."""

from __future__ import annotations

import hashlib

import numpy as np
import pytest
from casefiles import CASES, read
from engine import block, rectangle, scene, solve, tables
from engine.limits import solved
from scipy.stats import lognorm

from dem_cli.core.contact.start import bodies_at_rest, joints_of_start
from dem_cli.core.engine.properties import joint_properties
from dem_cli.core.kernels.records import Joints
from dem_cli.core.model.model import Model
from dem_cli.core.model.places import undeformed
from dem_cli.core.model.scales import smallest_edge
from dem_cli.errors import CaseError
from dem_cli.masonry.assembly.assemble import assembly

GLUE = {"law": "mohr-coulomb", "friction": 1.0, "cohesion": 1e8, "tension": 5e7}
GAP = 1e-4  # between drawn blocks whose heads are open [m]: far more than touches, nothing beside the blocks


def push(dimension: int, **more) -> dict:
    along = [1.0] + [0.0] * (dimension - 1)
    return {"kind": "pushover", "pattern": "mass", "direction": along, "resolution": 1e-3} | more


def wall(dimension: int = 2, joints: dict | None = None, **more) -> dict:
    """Four courses of three blocks in running bond."""
    drawn = {"kind": "wall", "id": "w", "block": [0.4, 0.2], "courses": 4, "blocks_per_course": 3, "thickness": 0.3}
    return {
        "dimension": dimension,
        "materials": {"stone": {"density": 2000.0}},
        "joints": joints or {"dry": {"friction": 0.65}},
        "structure": [drawn],
        "analysis": push(dimension),
        "output": {"frames": 0},
    } | more


def with_heads(head: str, dimension: int = 2, **others) -> dict:
    return wall(dimension, {"dry": {"friction": 0.65, "head": head}, **others})


def open_heads(dimension: int) -> dict:
    """The same wall, drawn block by block, each shortened at both ends by half a gap."""
    made = scene(wall(dimension))
    model, drawn = made.model, []
    for k, name in enumerate(model.block_ids):
        corners = undeformed(model)[model.vertex_blocks == k]
        if not model.fixed[k]:
            middle = 0.5 * (corners[:, 0].min() + corners[:, 0].max())
            corners[:, 0] -= np.sign(corners[:, 0] - middle) * GAP / 2.0
        thick = {"thickness": 0.3} if dimension == 2 else {}
        drawn.append(block(name, corners, **thick) | ({"fixed": True} if model.fixed[k] else {}))
    return {key: value for key, value in wall(dimension).items() if key != "structure"} | {"block": drawn}


def pairs_of(case: dict) -> tuple[Model, np.ndarray, np.ndarray]:
    """Model, pairs of blocks that touch (n, 2), and the normal of each joint."""
    made = scene(case)
    properties = joint_properties(made.request, made.model)
    joints = start_joints(made.model, properties)
    return made.model, joints.blocks, joints.frames[joints.starts[:-1], : made.model.dimension]


def start_joints(model: Model, properties) -> Joints:
    return joints_of_start(model, bodies_at_rest(model), properties, smallest_edge(model)).joints


@pytest.mark.parametrize("dimension", [2, 3])
def test_unfilled_heads_are_open_heads_in_limit_analysis(dimension):
    """Associated load and load of the path of no dilation; filled heads carry more, else this would show nothing."""
    found, drawn = (
        solved(case, associated_only=False) for case in (with_heads("none", dimension), open_heads(dimension))
    )
    assert found.associated.multiplier == pytest.approx(drawn.associated.multiplier, rel=2e-3)
    assert found.non_associated.load == pytest.approx(drawn.non_associated.load, rel=2e-3)
    assert solved(wall(dimension)).associated.multiplier > 1.02 * found.associated.multiplier


@pytest.mark.parametrize(
    ("dimension", "kinematics"),
    [(2, "fixed"), (3, "fixed"), (2, "large")],
)
def test_unfilled_heads_are_open_heads_in_the_loop(dimension, kinematics):
    how = f"analysis.kinematics={kinematics!r}"
    found, drawn = (solve(case, how)[0] for case in (with_heads("none", dimension), open_heads(dimension)))
    assert found["failure_load"] == pytest.approx(drawn["failure_load"], rel=2e-3)
    low, high = found["failure_load_bracket"]
    assert low <= solved(with_heads("none", dimension)).associated.multiplier * (1 + 1e-6)
    assert high - low <= 2e-3


@pytest.mark.parametrize("friction", [0.65, 0.75])
def test_smooth_heads_are_those_of_the_thesis(friction):
    """Table 5-3: heads without friction. Another joint in the heads gives the same as leaving it out of their law."""
    case = read(CASES / "verification" / f"wall_21_mu{100 * friction:03.0f}.toml")
    known = solved(case, heads_frictionless=True)
    smooth = case | {"joints": {"dry": case["joints"]["dry"] | {"head": "smooth"}, "smooth": {"friction": 0.0}}}
    found = solved(smooth)
    assert found.associated.multiplier == pytest.approx(known.associated.multiplier, rel=1e-6)
    assert found.associated.multiplier < 0.999 * solved(case).associated.multiplier


def two_stacks(dimension: int, by_hand: bool) -> dict:
    """Two stacks side by side; by hand: drawn as two structures of two materials, with an interface between them."""
    stack = {"kind": "wall", "block": [0.4, 0.4], "courses": 2, "bond": "stack", "thickness": 0.3, "base": False}
    heads = {"friction": 0.1, "kn": 3e9, "ks": 1e9}
    ground = {"ground": {"material": "stone"}}
    if not by_hand:
        joints = {"dry": {"friction": 0.7, "kn": 5e9, "head": "perpend"}, "perpend": heads}
        return wall(dimension, joints, structure=[stack | {"id": "w", "blocks_per_course": 2}], **ground)
    right = [0.4] + [0.0] * (dimension - 1)
    both = [{"id": "a", "material": "stone"}, {"id": "b", "material": "other", "origin": right}]
    return wall(
        dimension, {"dry": {"friction": 0.7, "kn": 5e9}, "perpend": heads},
        structure=[stack | {"blocks_per_course": 1} | one for one in both],
        materials={"stone": {"density": 2000.0}, "other": {"density": 2000.0}},
        interface=[{"between": ["stone", "other"], "joint": "perpend"},
                   {"between": ["other", "other"], "joint": "dry"}],
        ground={"material": "stone"},
    )  # fmt: skip


@pytest.mark.parametrize("dimension", [2, 3])
def test_another_joint_in_the_heads(dimension):
    """Law, stiffness and friction of each contact point as in the structure of two materials, so the load as well."""
    from_heads, by_hand = two_stacks(dimension, False), two_stacks(dimension, True)
    by_hand["interface"].append({"between": ["stone", "other"], "joint": "perpend"})
    made = [scene(case) for case in (from_heads, by_hand)]
    joints = [start_joints(one.model, joint_properties(one.request, one.model)) for one in made]
    # the ground meets the right stack in an interface as well, so only joints between blocks that can move are compared
    rows = []
    for one, found in zip(made, joints, strict=True):
        free = ~one.model.fixed[found.blocks].any(axis=1)
        points = free[found.owners]
        rows.append(
            np.sort(np.column_stack([found.law[found.owners][points, 0], found.kn[points], found.ks[points]]), 0)
        )
    assert rows[0] == pytest.approx(rows[1])
    assert set(np.round(rows[0][:, 0], 6)) == {0.1, 0.7}


@pytest.mark.parametrize(("dimension", "kinematics"), [(2, "fixed"), (2, "large"), (3, "fixed"), (3, "large")])
def test_unfilled_heads_take_no_load_across_but_beds_stay(dimension, kinematics):
    """Two slender blocks side by side tip at b/h of one; with glue in their head as one block, at that of both."""
    stack = {"kind": "wall", "id": "w", "block": [0.2, 0.6], "courses": 1, "blocks_per_course": 2, "bond": "stack"}
    joints, how = {"dry": {"friction": 5.0, "head": "none"}}, f"analysis.kinematics={kinematics!r}"
    summary, _ = solve(wall(dimension, joints, structure=[stack]), how)
    assert summary["failure_load"] == pytest.approx(0.2 / 0.6, rel=2e-3)
    glued = {"dry": {"friction": 5.0, "head": "glue"}, "glue": GLUE}
    together, _ = solve(wall(dimension, glued, structure=[stack]), how)
    assert together["failure_load"] == pytest.approx(0.4 / 0.6, rel=2e-3)


VAULTS = [
    {"kind": "vault", "shape": "dome", "radius": 3.0, "thickness": 0.4, "courses": 5, "per_course": 8},
    {"kind": "vault", "shape": "barrel", "span": 3.0, "thickness": 0.4, "voussoirs": 6, "length": 2.0, "rows": 3},
    {"kind": "vault", "shape": "groin", "span": 3.0, "thickness": 0.4, "voussoirs": 6, "rows": 4},
]


@pytest.mark.parametrize("vault", VAULTS, ids=lambda vault: vault["shape"])
def test_heads_of_vaults_stand_across_their_courses(vault):
    """All joints of a course are upright and none of the beds is among them, the crown of an even barrel included."""
    joints = {"dry": {"friction": 0.65, "head": "other"}, "other": {"friction": 0.1}}
    model, blocks, normals = pairs_of(wall(3, joints, structure=[vault]))
    heads = model.side_by_side(blocks)
    assert heads.any()
    assert not heads.all()
    assert np.abs(normals[heads, 2]) == pytest.approx(0.0, abs=1e-9)
    if vault["shape"] == "barrel":  # x is the direction of the arch, y that of the courses
        assert np.abs(normals[heads, 1]) == pytest.approx(1.0)
        assert np.abs(normals[~heads, 1]) == pytest.approx(0.0, abs=1e-9)


def test_leaves_are_no_heads():
    """Stones of two leaves in one course meet in a collar joint, with its normal across the wall."""
    joints = {"dry": {"friction": 0.65, "head": "other"}, "other": {"friction": 0.1}}
    drawn = {"kind": "wall", "id": "w", "block": [0.4, 0.2], "courses": 3, "length": 1.6, "thickness": 0.4, "leaves": 2}
    model, blocks, normals = pairs_of(wall(3, joints, structure=[drawn | {"bond": "english"}]))
    heads, across = model.side_by_side(blocks), np.abs(normals[:, 1]) > 0.5
    beds = np.abs(normals[:, 2]) > 0.5
    assert across.any()
    assert not heads[across].any()
    assert heads[~across & ~beds].all()
    assert not heads[beds].any()


def test_heads_of_a_house():
    """Upright joints within each course of both walls and their corner are heads, beds are not."""
    house = {
        "kind": "building", "id": "h", "block": [0.5, 0.25, 0.25], "courses": 4,
        "walls": [{"id": "a", "axis": [[0.0, 0.0], [2.5, 0.0]]}, {"id": "b", "axis": [[0.0, 0.0], [0.0, 2.0]]}],
    }  # fmt: skip
    joints = {"dry": {"friction": 0.65, "head": "other"}, "other": {"friction": 0.1}}
    model, blocks, normals = pairs_of(wall(3, joints, structure=[house]))
    heads = model.side_by_side(blocks)
    assert (heads == (np.abs(normals[:, 2]) < 0.5)).all()
    assert heads.any()


@pytest.mark.parametrize(
    ("joints", "said"),
    [
        ({"dry": {"friction": 0.6, "head": "dyr"}, "wet": {"friction": 0.1}}, "unknown joint 'dyr'"),
        ({"dry": {"friction": 0.6, "head": "dry"}}, "'dry' is the joint itself"),
        (
            {"dry": {"friction": 0.6, "head": "wet"}, "wet": {"friction": 0.1, "head": "dry"}},
            "'wet' has a 'head' of its own ('dry')",
        ),
        ({"dry": {"friction": 0.6, "head": "none"}, "none": {"friction": 0.1}}, "give that another name"),
    ],
)
def test_heads_that_are_refused(joints, said):
    with pytest.raises(CaseError) as raised:
        scene(wall(2, joints))
    assert said in str(raised.value)
    assert "joints.dry.head" in str(raised.value)


def test_heads_of_drawn_blocks_change_nothing_and_are_said():
    case = tables(block("base", rectangle(-1, -1, 1, 0), fixed=True), block("a", rectangle(0, 0, 1, 1)))
    case["joints"]["dry"]["head"] = "none"
    made = scene(case)
    from dem_cli.masonry.assembly import sanity

    said = [one.message for one in sanity.doubts(made.case, made.model, assembly(made.case).blocks, ())]
    assert [text for text in said if text.startswith("'none' changes nothing")]


# -- friction of each joint


def sliding(dimension: int, variation: float = 0.2, seed: int = 1, **more) -> dict:
    """A flat block on a base, that slides at the friction of their joint."""
    if dimension == 2:
        shapes = [rectangle(-2, -1, 2, 0), rectangle(-0.5, 0, 0.5, 0.1)]
    else:
        shapes = [
            [[x, y, z] for z in (bottom, top) for y in (-half, half) for x in (-half, half)]
            for half, bottom, top in ((2.0, -1.0, 0.0), (0.5, 0.0, 0.1))
        ]
    return tables(
        block("base", shapes[0], fixed=True), block("a", shapes[1]), dimension=dimension, seed=seed,
        joints={"dry": {"friction": 0.6, "variation": variation}}, analysis=push(dimension), **more,
    )  # fmt: skip


def drawn_by_hand(seed: int, a: str, b: str, mean: float = 0.6, variation: float = 0.2) -> float:
    """Log-normal of that mean and coefficient of variation, at a share of its distribution that names and seed give."""
    text = f"{seed} friction dry {' '.join(sorted((a, b)))}"
    share = ((int.from_bytes(hashlib.blake2b(text.encode(), digest_size=8).digest(), "big") >> 12) + 0.5) / 2**52
    sigma = np.sqrt(np.log(1.0 + variation**2))
    return float(lognorm.ppf(share, sigma, scale=mean * np.exp(-0.5 * sigma**2)))


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_block_slides_at_its_own_friction(dimension):
    """Loop, limit analysis and its path; another seed gives another load, the same one the same."""
    found = {}
    for seed in (1, 3):
        expected = drawn_by_hand(seed, "base", "a")
        loads = solved(sliding(dimension, seed=seed), associated_only=False)
        assert loads.associated.multiplier == pytest.approx(expected, rel=1e-6)
        assert loads.non_associated.load == pytest.approx(expected, rel=1e-4)
        summary, _ = solve(sliding(dimension, seed=seed))
        assert summary["failure_load"] == pytest.approx(expected, rel=2e-3)
        found[seed] = expected
    assert abs(found[1] - found[3]) > 0.01


def test_friction_of_many_joints():
    """Mean and coefficient of variation of 1,000 joints within three standard errors; each as its names say, whatever
    other blocks there are."""
    more = {"kind": "wall", "id": "w", "block": [0.4, 0.2], "courses": 20, "blocks_per_course": 20}
    case = wall(2, {"dry": {"friction": 0.6, "variation": 0.2}}, structure=[more])
    made = scene(case)
    joints = start_joints(made.model, joint_properties(made.request, made.model))
    friction, n = joints.law[:, 0], len(joints.law)
    assert n > 1000
    assert friction.mean() == pytest.approx(0.6, abs=3 * 0.12 / np.sqrt(n))
    assert friction.std() / 0.6 == pytest.approx(0.2, abs=3 * 0.2 / np.sqrt(2 * n))
    for k in (0, 17, n - 1):
        assert friction[k] == pytest.approx(drawn_by_hand(1, *(made.model.block_ids[i] for i in joints.blocks[k])))


def test_other_strengths_stay_where_the_law_has_them():
    """Cohesion stays; the residual friction goes along; the tensile strength ends at the tip of the new cone."""
    joint = {"law": "mohr-coulomb", "friction": 0.6, "cohesion": 1e5, "tension": 1.5e5, "friction_residual": 0.5}
    made = scene(wall(2, {"dry": joint | {"variation": 0.3}}))
    law = start_joints(made.model, joint_properties(made.request, made.model)).law
    cohesion, tension, friction, residual = law[:, [1, 2, 3, 6]].T
    assert cohesion == pytest.approx(1e5)
    assert residual / friction == pytest.approx(0.5 / 0.6)
    assert tension == pytest.approx(np.minimum(1.5e5, 1e5 / friction))
    assert np.ptp(friction) > 0.1
