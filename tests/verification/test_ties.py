"""[[tie]]: ties and anchors against closed forms, in the plane and in space: rest, yielding, limit loads, swings."""

from __future__ import annotations

import math

import numpy as np
import pytest
from engine import block, rectangle, scene, simulation, solve, tables
from engine.limits import solved

from dem_cli.core.dynamics.frequencies import modes, system
from dem_cli.core.engine import measures
from dem_cli.core.engine.automatic_stiffness import static_ratio
from dem_cli.core.engine.budget import Budget
from dem_cli.core.engine.dynamic import DynamicSimulation
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.engine.viscous import Damping
from dem_cli.core.kernels import records as slot
from dem_cli.core.kernels.records import Ground
from dem_cli.core.limit.cone import friction_of
from dem_cli.core.limit.matrices import structure_of
from dem_cli.core.limit.path import trace
from dem_cli.core.links.link import FORCE, PLASTIC
from dem_cli.core.records.statuses import FALLS
from dem_cli.core.statics.equilibrium import stand
from dem_cli.core.statics.warm_start import WarmStart

GRAVITY = {"kind": "gravity", "kinematics": "large"}
CEILING = block("ceiling", rectangle(-2, 2, 2, 2.5), fixed=True)
HUNG = block("hung", rectangle(-0.5, 0, 0.5, 1))  # 2000 kg
FLOOR = block("floor", rectangle(-3, -1, 3, 0), fixed=True)
WEIGHT = 2000.0 * 9.81


def prism(name: str, low: tuple[float, float], high: tuple[float, float], y=(-0.5, 0.5), **more) -> dict:
    """A box in space."""
    polygon = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]]
    return {"id": name, "polygon": polygon, "y": list(y), **more}


def hung(at: float = 0.1, **tie) -> dict:
    """A block below a ceiling, held by a point beside its middle."""
    return tables(CEILING, HUNG, tie=[{"ends": [[at, 1.0], [at, 2.0]], **tie}], analysis=GRAVITY)


def test_a_hung_block_swings_below_its_tie():
    """The tie stretches by W/k, and the block turns until its middle is below its end."""
    monitor = [{"tie": "tie-1", "quantity": quantity} for quantity in ("force", "elongation")]
    monitor.append({"block": "hung", "component": "x"})
    summary, records = solve(hung(stiffness=1e6) | {"monitor": monitor})
    force, elongation, aside = records.rows[-1].monitors
    assert summary["status"] == "ok"
    assert force == pytest.approx(WEIGHT, rel=1e-4)
    assert elongation == pytest.approx(WEIGHT / 1e6, rel=1e-4)
    assert aside == pytest.approx(0.1, rel=1e-3)
    assert abs(summary["energy_closure"]) < 1e-3
    assert summary["joint_state"]["ties"]["tie-1"]["yielded"] is False


def test_a_tie_that_yields_below_the_weight_lets_go():
    summary, _ = solve(hung(at=0.0, stiffness=1e6, yield_force=0.9 * WEIGHT))
    assert summary["status"] == FALLS


def test_yield_plateau():
    """A block on a smooth floor is pulled against an anchor: its load is the yield force, and there is no other."""
    push = {"block": "b", "force": [1.0, 0.0], "kind": "live"}
    tie = {"ends": [[0.0, 0.5], [-4.0, 0.5]], "stiffness": 1e7, "anchored": True, "yield_force": 5000.0}
    analysis = {"kind": "pushover", "pattern": "live", "resolution": 0.002}
    summary, _ = solve(
        tables(FLOOR, block("b", rectangle(0, 0, 1, 1)), friction=0.0, load=[push], tie=[tie], analysis=analysis)
    )
    assert summary["failure_load"] == pytest.approx(5000.0, rel=3e-3)
    assert summary["limit_analysis"]["associated"] == pytest.approx(5000.0, rel=1e-6)
    assert summary["failure_load"] <= 5000.0 * (1 + 1e-6)


def prestressed(force: float, **analysis) -> dict:
    """A block of 0.5 m x 2 m pressed to the floor by a tie through its middle whose force never changes."""
    tie = {"ends": [[0.25, 1.5], [0.25, -0.5]], "block": "b", "stiffness": 1e7, "prestress": force}
    tie["yield_force"] = force
    return tables(
        FLOOR, block("b", rectangle(0, 0, 0.5, 2)), friction=2.0, tie=[tie],
        analysis={"kind": "pushover", "resolution": 0.002, **analysis},
    )  # fmt: skip


def test_a_prestressed_block_rocks_later():
    """λ W h/2 = (W + N) b/2."""
    case = prestressed(10e3)
    expected = (WEIGHT + 10e3) * 0.25 / WEIGHT
    assert solved(case).associated.multiplier == pytest.approx(expected, rel=1e-6)
    summary, _ = solve(case)
    assert summary["failure_load"] == pytest.approx(expected, rel=3e-3)
    assert summary["limit_analysis"]["associated"] == pytest.approx(expected, rel=1e-6)


def test_prestress_of_the_start_is_in_the_books():
    """An elastic tie squeezes the joint by its force, and nothing is lost or made."""
    case = prestressed(10e3) | {"analysis": GRAVITY}
    sim = simulation(case, "large")
    assert sim.links[0].state[0, FORCE] == 10e3
    assert stand(sim, Budget(100_000)).state == "equilibrium"
    assert sim.links[0].state[0, FORCE] == pytest.approx(10e3, rel=1e-3)
    assert sim.contacts.normal.sum() == pytest.approx(WEIGHT + 10e3, rel=1e-3)
    assert abs(measures.closure(sim)) < 1e-4


def house(yields: float, **analysis) -> dict:
    """Two walls of a house in space, held together by two ties near their top; the thin one is pushed outwards."""
    blocks = (
        prism("base", (-1, -0.5), (5, 0), (-2, 2), fixed=True),
        prism("wall", (0, 0), (0.4, 2), (-1, 1)),
        prism("far", (2, 0), (4, 2), (-1, 1)),
    )
    tie = [
        {"ends": [[0.4, y, 1.5], [2.0, y, 1.5]], "area": 1e-4, "young": 2e11, "yield_force": yields}
        for y in (-0.5, 0.5)
    ]
    mass = {"kind": "pushover", "direction": [-1.0, 0.0, 0.0], "resolution": 0.005, **analysis}
    return tables(*blocks, dimension=3, tie=tie, analysis=mass)


def test_tied_walls_of_a_house():
    """λ W h/2 = W b/2 + 2 N z, as long as the far wall is not pulled over; the explicit solver within 1 %."""
    weight = 0.4 * 2 * 2 * WEIGHT
    expected = (0.2 * weight + 2 * 1e3 * 1.5) / weight
    case = house(1e3)
    assert solved(case).associated.multiplier == pytest.approx(expected, rel=1e-6)
    summary, _ = solve(case)
    assert summary["failure_load"] == pytest.approx(expected, rel=1e-2)
    assert summary["limit_analysis"]["associated"] == pytest.approx(expected, rel=1e-6)


def arch(yields: float) -> dict:
    """A semicircular arch of twelve stones on smooth supports, held together at its feet; a load at a haunch."""
    angles = np.linspace(math.pi, 0.0, 13)
    ring = [np.column_stack([r * np.cos(angles), r * np.sin(angles)]).round(12) for r in (1.7, 2.1)]
    stones = [
        block(f"v{i}", [ring[0][i + 1], ring[0][i], ring[1][i], ring[1][i + 1]][::-1], material="stone")
        for i in range(12)
    ]
    bases = [
        block(name, rectangle(left, -0.5, left + 2.0, 0), fixed=True, material="roller")
        for name, left in (("left", -3.0), ("right", 1.0))
    ]
    return tables(
        *bases, *stones,
        materials={"stone": {"density": 2000.0}, "roller": {"density": 2000.0}},
        joints={"dry": {"friction": 0.7}, "smooth": {"friction": 0.01}},
        interface=[{"between": ["roller", "stone"], "joint": "smooth"}],
        tie=[{"ends": [[-1.9, 0.05], [1.9, 0.05]], "area": 1e-4, "young": 2e11, "yield_force": yields}],
        load=[{"at": [0.2, 2.2], "force": [0.0, -1000.0], "kind": "live"}],
        analysis={"kind": "pushover", "pattern": "live", "resolution": 0.005},
    )  # fmt: skip


def test_tied_arch():
    """The tie decides, and both methods agree; with a tie twice as strong the arch carries nearly twice the load."""
    bound = solved(arch(1.5e4)).associated
    assert bound.links == pytest.approx([1.5e4], rel=1e-6)
    assert solved(arch(3e4)).associated.multiplier > 1.7 * bound.multiplier
    summary, _ = solve(arch(1.5e4))
    assert summary["failure_load"] == pytest.approx(bound.multiplier, rel=1e-2)


def test_the_path_ends_where_ties_yield():
    """It knows ties that only pull: their elastic part is stretched first, prestress is there from the start."""
    expected = (2.0 * 0.75 * WEIGHT * 0.25 + 6000.0 * 2.25) / (2.0 * 0.75 * WEIGHT * 1.5)
    for dimension in (2, 3):
        path = solved(tied_stack(dimension), associated_only=False).non_associated
        assert path.finished
        assert path.load == pytest.approx(expected, rel=1e-5)
    path = solved(prestressed(10e3), associated_only=False).non_associated
    assert path.load == pytest.approx((WEIGHT + 10e3) * 0.25 / WEIGHT, rel=1e-5)
    path = solved(arch(1.5e4), associated_only=False).non_associated
    assert path.load == pytest.approx(solved(arch(1.5e4)).associated.multiplier, rel=1e-4)


def box(name: str, dimension: int, low: tuple[float, float], high: tuple[float, float], **more) -> dict:
    """A block 1 m deep, in 2D or 3D."""
    return block(name, rectangle(*low, *high), **more) if dimension == 2 else prism(name, low, high, **more)


def across(dimension: int, x: float, z: float) -> list[float]:
    return [x, z] if dimension == 2 else [x, 0.0, z]


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize(("side", "held"), [(-1.0, True), (3.0, True), (3.0, False)])
def test_the_path_knows_rods_that_also_push(dimension, side, held):
    """A block is pushed along its bed by λ W; a rod before or behind it holds its yield force, a tie before it none."""
    blocks = box("floor", dimension, (-5, -1), (5, 0), fixed=True), box("b", dimension, (0, 0), (2, 0.5))
    at = across(dimension, 0.0 if side < 0.0 else 2.0, 0.05)
    rod = {"ends": [at, across(dimension, side, 0.05)], "block": "b", "anchored": True, "stiffness": 1e7}
    rod |= {"yield_force": 3000.0, "prestress": 500.0, "compression": held}
    case = tables(*blocks, friction=0.5, dimension=dimension, tie=[rod], analysis={"kind": "pushover"})
    found = solved(case, associated_only=False)
    weight = 2000.0 * 9.81 * 2.0 * 0.5
    expected = 0.5 + (3000.0 / weight if held or side < 0.0 else 0.0)
    assert found.non_associated.finished
    assert found.non_associated.load == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("lean", [0.0, 0.3, -0.3])
def test_the_path_knows_bars(dimension, lean):
    """A block slides on a bed that a bar crosses, of force F and the angle θ to its normal: μ (W + F cos θ) + F sin θ.

    F is 0 where the bar is square to the bed, which does not stretch it. One that leans against the push is pressed
    later, and lifts the block: the load is highest before.
    """
    blocks = box("floor", dimension, (-5, -1), (5, 0), fixed=True), box("b", dimension, (0, 0), (2, 0.5))
    path = [across(dimension, 1.0 + lean * z, z) for z in (-0.9, 0.45)]
    bars = {"bar": {"area": 1e-4, "young": 2e11, "yield_stress": 4e7, "bond_stiffness": 1e9}}
    case = tables(*blocks, friction=0.5, dimension=dimension, bars=bars, analysis={"kind": "pushover"})
    found = solved(case | {"reinforcement": [{"bar": "bar", "path": path}]}, associated_only=False)
    weight, force = 2000.0 * 9.81 * 2.0 * 0.5, 4000.0 * (lean > 0.0)
    pull = force * np.array([math.cos(math.atan(lean)), math.sin(math.atan(lean))])
    assert found.non_associated.finished
    expected = 0.5 + (0.5 * pull[0] + pull[1]) / weight
    assert found.non_associated.load == pytest.approx(expected, rel=1e-3)  # the bar takes some of the weight


def test_states_of_the_path_are_held_with_their_ties():
    """Put into the simulation the tie has its force and what it was stretched for good, and all forces balance."""
    made = scene(tied_stack(2))
    sim = simulation(tied_stack(2), "fixed")
    structure = structure_of(made.model, sim.joints)
    path = trace(structure, friction_of(sim.joints, law_of(made.request)))
    start = WarmStart("path", path.load, path.normal, path.shear, path.gaps, path.displacements, 0.0)
    start.put_into(sim)
    sim.advance(1, slot.HOLD_LOAD)
    stretched, longer, force = sim.links[0].state[0]
    assert force == pytest.approx(6000.0, rel=1e-6)
    assert stretched > 0.0
    assert force == pytest.approx(5e6 * (longer - stretched), rel=1e-6)
    assert sim.unbalanced < 1e-5


def pendulum(k: float) -> np.ndarray:
    """Frequencies of HUNG on a tie of 1 m to its top [Hz], taut by its weight: swings, then up and down."""
    mass, inertia, arm, length = 2000.0, 2000.0 / 6.0, 0.5, 1.0
    # The end goes to u − arm θ sideways: N/L of it squared, and the weight's own N arm θ².
    stiff = WEIGHT * np.array([[1 / length, -arm / length], [-arm / length, arm**2 / length + arm]])
    roots = np.sqrt([mass, inertia])
    swings = np.linalg.eigvalsh(stiff / np.outer(roots, roots))
    return np.sqrt(np.sort([*swings, k / mass])) / (2 * math.pi)


def test_frequencies_of_a_hung_block():
    """In space tests/unit/links/test_tie.py has the stiffness."""
    sim = simulation(hung(at=0.0, stiffness=1e9), "large")
    sim.links[0].state[0, FORCE] = WEIGHT  # as if it were at rest
    found = modes(system(sim, np.zeros(0, bool), geometric=True), 3, 2, 2).frequencies
    assert found == pytest.approx(pendulum(1e9), rel=1e-4)


def shaken(case: dict, dt: float) -> DynamicSimulation:
    made = scene(case)
    sim = DynamicSimulation(
        made.model,
        law_of(made.request),
        joint_properties(made.request, made.model, 1e5),
        Damping(),
    )
    sim.begin(dt)
    return sim


def run(sim: DynamicSimulation, steps: int) -> np.ndarray:
    """State of the links after each step, (n, n_links, 3)."""
    d, n_dof = sim.model.dimension, sim.bodies.velocities.shape[1]
    watch = sim.watch(np.zeros(0, np.int64), 1, steps)
    sim.shake(Ground(np.zeros((steps, d)), np.zeros(0, np.int64), np.zeros((steps, 0, n_dof))), steps, watch)
    return watch.links


def test_a_swing_keeps_its_energy():
    """A block thrown on its tie: weight, swing and spring add up; at rest at the end of a swing, N = m g cos φ."""
    case = hung(at=0.0, stiffness=1e7)
    sim = shaken(case, 1e-4)
    sim.bodies.velocities[sim.free, 0] = 1.0
    sim.links[0].state[:] = 0.0
    start = sim.kinetic_energy() + sim.elastic_energy()
    sim.ledger[0] += start
    states = run(sim, 20_000)
    sim.note_kinetic_energy()
    assert abs(measures.closure(sim)) < 1e-3
    assert states[:, 0, FORCE].min() >= 0.0
    assert states[:, 0, FORCE].max() > WEIGHT


def test_a_tie_stops_what_it_can():
    """A block on a smooth floor flies from its anchor: what it had goes into yielding, ½ m v² = Ny p + Ny²/2k."""
    tie = {"ends": [[0.0, 0.5], [-2.0, 0.5]], "stiffness": 1e7, "anchored": True, "yield_force": 2e4}
    case = tables(FLOOR, block("b", rectangle(0, 0, 1, 1)), friction=0.0, tie=[tie], gravity=0.0, analysis=GRAVITY)
    sim = shaken(case, 1e-5)
    sim.bodies.velocities[sim.free, 0] = 1.0
    states = run(sim, 15_000)
    expected = (0.5 * 2000.0 - 0.5 * 2e4**2 / 1e7) / 2e4
    assert states[-1, 0, PLASTIC] == pytest.approx(expected, rel=1e-3)
    assert sim.ledger[3] == pytest.approx(2e4 * expected, rel=1e-3)
    assert states[-1, 0, FORCE] == 0.0  # it came back, and the tie hangs
    sim.restore(saved := sim.save())
    assert np.array_equal(sim.links[0].state, saved.links[0])


def tied_stack(dimension: int, stiffness: float = 5e6, **more) -> dict:
    """Two blocks, each 0.5 m wide and 1.5 m high, the upper one held at its middle by an anchor of 6 kN."""
    if dimension == 2:
        blocks = [block("base", rectangle(-3, -1, 6, 0), fixed=True)]
        blocks += [block(f"b{k}", rectangle(0.0, 1.5 * k, 0.5, 1.5 * (k + 1))) for k in (0, 1)]
    else:
        blocks = [prism("base", (-3, -1), (6, 0), (-2.0, 2.0), fixed=True)]
        blocks += [prism(f"b{k}", (0.0, 1.5 * k), (0.5, 1.5 * (k + 1))) for k in (0, 1)]
    flat = [0.0] * (dimension - 2)
    ends = [[0.0, *flat, 2.25], [-4.0, *flat, 2.25]]
    tie = {"ends": ends, "block": "b1", "anchored": True, "stiffness": stiffness, "yield_force": 6000.0}
    push = {"kind": "pushover", "direction": [1.0, 0.0, *flat]}
    return tables(*blocks, dimension=dimension, friction=0.7, tie=[tie], analysis=push, **more)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("stiffness", [5e5, 5e6, 5e7])
def test_a_stack_on_stiff_joints_comes_to_rest_on_its_tie(dimension, stiffness):
    """Both blocks turn about the toe once the tie yields: λ 2W 1.5 = 2W 0.25 + 6000 · 2.25, however soft it is beside
    the joints; loads before are at rest within steps that a structure without it takes as well."""
    expected = (2.0 * 0.75 * WEIGHT * 0.25 + 6000.0 * 2.25) / (2.0 * 0.75 * WEIGHT * 1.5)
    summary, _ = solve(tied_stack(dimension, stiffness))
    assert expected == pytest.approx(0.47248, abs=1e-5)
    assert summary["status"] == "ok"
    assert summary["failure_load"] == pytest.approx(expected, rel=2e-3)
    assert summary["limit_analysis"]["associated"] == pytest.approx(expected, rel=1e-6)
    assert summary["steps"] < 200_000


def test_automatic_joints_beside_ties():
    """As stiff as digits allow; with ties stiff beside the stiffest of them, and no more than they need."""
    ways = DEFAULT.stiffness
    ratio = static_ratio(scene(tied_stack(2)).model, "fixed", ways)
    assert ratio == ways.statics
    model = scene(tied_stack(2, 1e10)).model
    weight, edge = 0.75 * WEIGHT, 0.5
    assert static_ratio(model, "fixed", ways) == pytest.approx(100.0 * 1e10 * edge / weight)
    bare = {key: value for key, value in tied_stack(2).items() if key != "tie"}
    assert static_ratio(scene(bare).model, "fixed", ways) == ways.fixed
