"""Elastic blocks lumped into their joints: columns against closed forms, a wall against finite elements, refusals."""

import math

import numpy as np
import pytest
from casefiles import CASES
from engine import rectangle, scene, simulation, solve, tables
from scipy.sparse import diags
from scipy.sparse.linalg import spsolve

from dem_cli.core.contact.compatibility import compatibility
from dem_cli.core.contact.start import bodies_at_rest, joints_of_start
from dem_cli.core.engine.audit import unbending
from dem_cli.core.engine.measures import shares_of_blocks
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.model.scales import smallest_edge
from dem_cli.errors import CaseError
from dem_cli.masonry.assembly.sanity import problems

E, NU, KN, KS = 2e9, 0.25, 4e10, 1e10
G = E / (2.0 * (1.0 + NU))
B, H, T, N = 0.4, 0.2, 0.5, 5  # blocks of the columns [m], and how many
A, I = B * T, T * B**3 / 12.0  # noqa: E741
STONE = {"density": 2000.0, "young": E, "poisson": NU}
GLUE = {"law": "elastic", "kn": KN, "ks": KS}


def column(dimension=2, joint=GLUE, stone=STONE, base="rock", **more):
    """A column of N blocks on a fixed one."""
    blocks = []
    for i in range(N + 1):
        corners = rectangle(-0.5 * B, (i - 1) * H, 0.5 * B, i * H)
        own = {"vertices": corners, "thickness": T} if dimension == 2 else {"polygon": corners, "y": [0.0, T]}
        blocks.append({"id": f"b{i}", "material": "stone" if i else base, "fixed": i == 0, **own})
    materials = {"stone": stone, "rock": {"density": 2000.0}}
    analysis = {"kind": "gravity", "kinematics": "fixed"}
    return tables(*blocks, materials=materials, joints={"dry": joint}, analysis=analysis, dimension=dimension, **more)


def moved(case, force):
    """Of the top block under a generalised force at its centroid, on the joints of the start; linear."""
    made = scene(case)
    model = made.model
    joints = joints_of_start(
        model, bodies_at_rest(model), joint_properties(made.request, model), smallest_edge(model)
    ).joints
    motion = compatibility(model, joints).toarray()
    stiffness = np.column_stack([joints.kn, *[joints.ks] * (model.dimension - 1)]).ravel()
    forces = np.zeros(motion.shape[1])
    forces[-len(force) :] = force
    return np.linalg.solve(motion.T @ (stiffness[:, None] * motion), forces)[-len(force) :]


NORMAL = N / KN + (N - 0.5) * H / E  # a rod of joints and blocks up to the middle of the top one, per stress
SHEAR = N / KS + (N - 0.5) * H / G


@pytest.mark.parametrize("dimension", [2, 3])
def test_uniform_compression_and_bending_are_exact(dimension):
    up, about = dimension - 1, 2 if dimension == 2 else 4
    push, turn = np.zeros((2, 3 if dimension == 2 else 6))
    push[up], turn[about] = -1e5, 1e3
    joint = GLUE | {"points": "vertices+centre"} if dimension == 3 else GLUE
    assert moved(column(dimension, joint), push)[up] == pytest.approx(-1e5 / A * NORMAL, rel=1e-9)
    assert moved(column(dimension, joint), turn)[about] == pytest.approx(1e3 / I * NORMAL, rel=1e-9)


def test_shear_with_its_bending():
    arms = (N - 0.5) * H - np.arange(N) * H  # of the force at the middle of the top block over the joints
    bends = sum(arm**2 * (1 / KN + (H if i else 0.5 * H) / E) for i, arm in enumerate(arms)) / I
    assert moved(column(), np.array([1e3, 0.0, 0.0]))[0] == pytest.approx(1e3 * (SHEAR / A + bends), rel=1e-9)


def test_rigid_joints_leave_the_blocks_alone():
    assert moved(column(joint={"law": "elastic"}), np.array([0.0, -1e5, 0.0]))[1] == pytest.approx(
        -1e5 / A * (N - 0.5) * H / E, rel=1e-9
    )
    sim = simulation(column(joint={"friction": 0.6}))
    assert not sim.properties.rigid.any()
    assert sim.properties.given
    assert np.isinf(shares_of_blocks(sim, sim.properties.compliance)).all()


@pytest.mark.parametrize("stone", [{"density": 2000.0}, STONE | {"deformation": "none"}])
def test_rigid_blocks_are_as_before(stone):
    properties = simulation(column(stone=stone)).properties
    assert properties.compliance is None
    assert properties.rows is None
    assert moved(column(stone=stone), np.array([0.0, -1e5, 0.0]))[1] == pytest.approx(-1e5 / A * N / KN, rel=1e-9)


@pytest.mark.parametrize(("deformation", "ratio", "said"), [
    ("uniform-strain", 4.0, "4"), ("uniform-strain", 0.44, "0.44"), ("uniform-strain", 0.09, ""),
    ("quadratic", 4.0, ""), ("joints", 4.0, ""),
])  # fmt: skip
def test_blocks_that_do_not_bend_beside_stiff_joints_say_so(deformation, ratio, said):
    """By kn h/E; at 0.44 a column that bends is 27 % too stiff."""
    joint = {"friction": 0.6, "kn": ratio * E / H}
    made = scene(column(stone=STONE | {"deformation": deformation}, joint=joint))
    sim = Simulation(made.model, law_of(made.request), joint_properties(made.request, made.model), "fixed")
    found = unbending(made.request, sim)
    assert len(found) == bool(said)
    assert all(f"deform {said} times as much as joint 'dry'" in text and "do not bend" in text for text in found)


def test_fixed_blocks_are_supports_whatever_their_material():
    push = np.array([0.0, -1e5, 0.0])
    assert moved(column(base="stone"), push)[1] == moved(column(), push)[1]


def test_joints_of_two_kinds_of_blocks():
    made = scene(column(joint={"friction": 0.6, "kn": KN}))
    properties, model = joint_properties(made.request, made.model), made.model
    joints = joints_of_start(model, bodies_at_rest(model), properties, smallest_edge(model)).joints
    kn = np.add.reduceat(joints.kn, joints.starts[:-1]) / A
    below = joints.blocks.min(axis=1)
    assert kn[below == 0] == pytest.approx(1.0 / (1 / KN + 0.5 * H / E))
    assert kn[below > 0] == pytest.approx(1.0 / (1 / KN + H / E))
    assert joints.integrated.tolist() == [1] * N  # bending counts


def test_strength_follows_area_and_not_stiffness():
    """Laws turn stresses into forces by the kn of each joint."""
    joint = {"law": "mohr-coulomb", "friction": 0.6, "cohesion": 2e5, "tension": 1e5, "kn": KN}
    sim = simulation(column(joint=joint))
    strength = sim.law.envelope(sim.joints.law[sim.joints.owners], sim.joints.kn)
    assert np.add.reduceat(strength.tension, sim.joints.starts[:-1]) == pytest.approx(1e5 * A)
    assert len(np.unique(sim.joints.law[:, 0].round(-3))) == 2


def test_blocks_deform_where_geometry_moves():
    """Joints found anew have their blocks as well: a column closes as fixed geometry says."""
    monitor = [{"block": f"b{N}", "component": "y"}]
    case = column(joint={"friction": 0.6, "kn": 4e7, "ks": 4e7}, stone=STONE | {"young": 2e7}, monitor=monitor)
    closes = [
        solve(case | {"analysis": {"kind": "gravity", "kinematics": kinematics}})[1].rows[-1].monitors[0]
        for kinematics in ("fixed", "large")
    ]
    weight = 2000.0 * 9.81 * H
    exact = -weight * sum((N - i) * (1 / 4e7 + (H if i else 0.5 * H) / 2e7) for i in range(N))
    assert closes == pytest.approx([exact, exact], rel=2e-3)


def test_a_turned_column_is_as_stiff():
    """The extent across a joint is that of the block, whatever its direction."""
    case = column()
    c, s = math.cos(0.3), math.sin(0.3)
    for one in case["block"]:
        one["vertices"] = [[c * x - s * y, s * x + c * y] for x, y in one["vertices"]]
    along = moved(case, np.array([1e5 * s, -1e5 * c, 0.0]))
    assert c * along[1] - s * along[0] == pytest.approx(-1e5 / A * NORMAL, rel=1e-9)


def test_a_word_where_joints_are_stiff_beside_the_blocks():
    case = column(joint={"friction": 0.6, "kn": 4e10, "ks": 4e10})  # kn h/E = 4
    said = [word for word in solve(case)[0]["warnings"] if "lumped into the joints" in word]
    assert len(said) == 1
    assert "4 times" in said[0]
    soft = column(joint={"friction": 0.6, "kn": 1e9, "ks": 1e9})
    assert not [word for word in solve(soft)[0]["warnings"] if "lumped into the joints" in word]


def test_modulus_in_another_unit():
    made = scene(column(stone=STONE | {"young": 2.0}))
    (problem,) = problems(made.case, made.model)
    assert problem.path == ("materials", "stone", "young")
    assert "2 Pa is too soft" in problem.message
    assert "did you mean 2 GPa" in problem.message


HALVES = ("materials.stone.young=1e9", "joints.dry.kn=2e9")  # 1/kn' = 1/2e9 + 0.5 m/1e9 Pa


def test_natural_frequencies_are_those_of_joints_as_soft_as_that():
    """The references of modes_block.toml, whose joint has 1e9 and 4e8 Pa/m; 1/ks' = 1.3e-9 + 0.5 m · 2.4/1e9 Pa."""
    softer = f"joints.dry.ks={1 / 1.3e-9!r}"
    summary = solve(CASES / "verification" / "modes_block.toml", *HALVES, softer)[0]
    assert summary["frequencies"] == pytest.approx([43.2814, 112.5395, 130.8576], rel=1e-5)


def displacement(*overrides):
    """Of the beam on a wall of 51 blocks per unit of its push, no joint open; the largest of its translations."""
    made = scene(CASES / "validation" / "shear_wall_sw100.toml", *overrides)
    model = made.model
    built = joints_of_start(
        model, bodies_at_rest(model), joint_properties(made.request, model), smallest_edge(model)
    ).joints
    motion = compatibility(model, built)
    stiffness = diags(np.column_stack([built.kn, built.ks]).ravel())
    forces = model.live_loads[~model.fixed].ravel()
    return spsolve((motion.T @ stiffness @ motion).tocsc(), forces) @ forces


@pytest.mark.parametrize(("ratio", "rigid", "lumped", "within"), [
    (0.05, -0.047, 0.0, 0.003), (0.1, -0.088, 0.003, 0.006), (0.44, -0.28, 0.03, 0.02), (1.0, -0.47, 0.063, 0.04),
])  # fmt: skip
def test_a_wall_against_finite_elements(ratio, rigid, lumped, within):
    """The error of rigid blocks against an FE model of the whole wall (Q2, elastic interfaces; see docs/deformable.md)
    says what lumping has to give; the prototype, which lumped the whole base as well, had the errors `lumped`."""
    kn = ratio * 15.5e9 / 0.1
    joints = (f"joints.dry.kn={kn!r}", f"joints.dry.ks={0.417 * kn!r}")
    blocks = [f"materials.{name}.young=15.5e9" for name in ("sandstone", "concrete")]
    error = displacement(*joints, *blocks) / displacement(*joints) * (1.0 + rigid) - 1.0
    assert error == pytest.approx(0.0, abs=within)
    assert error < lumped


def test_blocks_without_modulus_cannot_deform():
    with pytest.raises(CaseError, match="deformation: 'joints' is not allowed without 'young'"):
        scene(column(stone={"density": 2000.0, "deformation": "joints"}))
