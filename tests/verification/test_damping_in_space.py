"""Each damping in space against what it is meant to do: decay of all motions of a block on its joint, and rocking."""

from __future__ import annotations

import math

import engine
import numpy as np
import pytest
from engine import block, rectangle, tables
from oracle.maxwell import of_mode
from scipy.optimize import least_squares

from dem_cli.core.contact.start import bodies_at_rest, joints_of_start
from dem_cli.core.dynamics.frequencies import modes, system
from dem_cli.core.dynamics.history import damping_of_start
from dem_cli.core.dynamics.restitution import housner, reference_block, rocked
from dem_cli.core.engine.properties import joint_properties
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.model.scales import smallest_edge
from dem_cli.errors import CaseError
from dem_cli.masonry.assembly.solver_request import solver_request

KN = 2e9
MODES = 6  # of a block on its joint: two of rocking with sliding along each axis, bounce, twist


def box(name: str, x, y, z, **more) -> dict:
    return block(name, [(a, b, c) for a in x for b in y for c in z], **more)


def case(damping: dict, **analysis) -> dict:
    """A block that starts with velocities of all its modes, so small that its joint never opens."""
    parts = [
        {"block": "b", "component": axis, "quantity": quantity}
        for quantity in ("displacement", "rotation")
        for axis in "xyz"
    ]
    start = {"block": "b", "velocity": [2e-4, 1e-4, 3e-5, 2e-4, 5e-4, 8e-4]}
    return {
        "dimension": 3,
        **tables(
            box("base", (-2, 3), (-2, 3), (-1, 0), fixed=True),
            box("b", (0, 0.8), (0, 1.1), (0, 1.0)),
            joints={"j": {"friction": 5.0, "kn": KN, "ks": 0.4 * KN}},
            analysis={"kind": "time-history", "margin": 0.05, "duration": 0.4, **analysis},
            damping=damping,
            initial=[start],
            monitor=parts,
            output={"frames": 0, "rate": 5000.0},
        ),
    }


@pytest.fixture(scope="module")
def vibrations():
    """Frequencies and shapes of the block [Hz], and √(K/M) of its joint [rad/s]."""
    sim = engine.simulation(case({"none": True}), "large")
    found = modes(system(sim), MODES, 3, sim.model.n_blocks)
    free = sim.model.block_ids.index("b")
    rows = found.shapes[:, free] * np.concatenate([[sim.model.masses[free]] * 3, inertias(sim, free)])
    return found.frequencies, rows, math.sqrt(KN * 0.8 * 1.1 / sim.model.masses[free])


def inertias(sim, block: int) -> np.ndarray:
    """Of an upright box about the axes of the world."""
    x, y, z = 0.8, 1.1, 1.0
    return sim.model.masses[block] / 12.0 * np.array([y * y + z * z, x * x + z * z, x * x + y * y])


def decays(damping: dict, vibrations, **analysis) -> tuple[np.ndarray, np.ndarray, dict]:
    """Damping ratio and frequency [Hz] of each mode, from sines fitted to its share of the motion, and the summary."""
    frequencies, rows, _ = vibrations
    summary, records = engine.solve(case(damping, **analysis))
    times, motion = records.history.times, records.history.monitors @ rows.T
    late = times > 0.015  # what elements hold at first is gone
    found = [decay(times[late], motion[late, k], frequencies[k]) for k in range(MODES)]
    ratios, measured = np.array(found).T
    return ratios, measured, summary


def decay(times: np.ndarray, x: np.ndarray, frequency: float) -> tuple[float, float]:
    """Damping ratio and frequency [Hz] of a decaying sine about a place of rest."""
    omega = 2.0 * math.pi * frequency

    def error(p: np.ndarray) -> np.ndarray:
        ratio, speed = p
        phase, fading = speed * omega * math.sqrt(1.0 - ratio * ratio) * times, np.exp(-ratio * speed * omega * times)
        parts = np.column_stack([fading * np.cos(phase), fading * np.sin(phase), np.ones_like(times)])
        return parts @ np.linalg.lstsq(parts, x / np.ptp(x), rcond=None)[0] - x / np.ptp(x)

    fitted = least_squares(error, [0.02, 1.0], bounds=([-0.5, 0.8], [0.5, 1.2]), xtol=1e-14, ftol=1e-14)
    return fitted.x[0], fitted.x[1] * frequency


# c = a0 m + a1 k with a0 = ζω and a1 = ζ/ω: ζ (ω₀/ω + ω/ω₀)/2
RAYLEIGH = {"ratio": 0.02, "frequency": 100.0, "mass": True}
LINEAR = {
    "stiffness": ({"stiffness": 5e-5}, lambda f: math.pi * f * 5e-5, "dashpots"),
    "mass": ({"mass": 10.0}, lambda f: 10.0 / (4.0 * math.pi * f), "mass"),
    "fraction": ({"contact_fraction": 0.02}, lambda f: 0.02 * f / (500.0 / math.pi), "dashpots"),
    "of a block": ({"contact_fraction": 0.02, "block": "b"}, lambda f: 0.02 * f / (500.0 / math.pi), "dashpots"),
    "rayleigh": ({"rayleigh": RAYLEIGH}, lambda f: 0.01 * (f / 100.0 + 100.0 / f), "dashpots mass"),
}


@pytest.mark.parametrize("kind", list(LINEAR))
def test_every_mode_has_its_ratio(vibrations, kind):
    """Measured 3e-3 at most, of the highest modes: the fit of a sine that leapfrog makes 4e-4 faster."""
    damping, ratio, ways = LINEAR[kind]
    assert vibrations[2] == pytest.approx(1000.0, rel=1e-12)
    ratios, measured, summary = decays(damping, vibrations)
    assert ratios == pytest.approx(np.array([ratio(f) for f in vibrations[0]]), rel=5e-3)
    assert measured == pytest.approx(vibrations[0], rel=1e-3)
    assert set(summary["energy_shares"]) == set(ways.split())
    assert abs(summary["energy_closure"]) < 2e-3  # half a step of the weight at the speed of the throw


def test_without_damping_vibrations_go_on(vibrations):
    ratios, _, summary = decays({"none": True}, vibrations)
    assert np.abs(ratios).max() < 1e-6
    assert summary["energy_shares"] == {}


@pytest.mark.parametrize("elements", [[(0.02, 100.0)], [(0.02, 30.0), (0.02, 100.0), (0.02, 300.0)]])
def test_maxwell_elements(vibrations, elements):
    """Ratios and frequencies of all modes as the complex stiffness has them."""
    damping = {"maxwell": [{"ratio": ratio, "frequency": frequency} for ratio, frequency in elements]}
    ratios, measured, summary = decays(damping, vibrations)
    expected = np.array([of_mode(f, elements) for f in vibrations[0]])
    assert ratios == pytest.approx(expected[:, 0], rel=1e-2)
    assert measured == pytest.approx(expected[:, 1], rel=2e-3)
    assert set(summary["energy_shares"]) == {"maxwell"}
    assert abs(summary["energy_closure"]) < 2e-3


def test_local_damping(vibrations):
    """Bounce and twist have one degree of freedom each: from one turn to the next (1 + a)/(1 − a) less."""
    ratios, _, summary = decays({"local": 0.05}, vibrations)
    decrement = math.log(1.05 / 0.95)
    alone = np.abs(vibrations[1][:, [2, 5]]).max(axis=1) > 1e-3 * np.abs(vibrations[1]).max(axis=1)
    assert alone.sum() == 2
    assert ratios[alone] == pytest.approx(np.full(2, decrement / (2.0 * math.pi)), rel=1e-2)
    assert set(summary["energy_shares"]) == {"local"}


@pytest.mark.parametrize("damping", [{"contact_fraction": 0.35}, {"maxwell": [{"ratio": 0.05, "frequency": 20.0}]}])
def test_energy_of_a_trilith_on_a_support_that_moves(damping):
    """Work of the support through joints and dashpots is what they lose and what moves; measured 1.3e-5 and 1.5e-4."""
    stones = [
        box("left", (-1, 0.95), (-1, 1), (-1, 0), fixed=True),
        box("right", (1.05, 3), (-1, 1), (-1, 0), fixed=True),
        box("pillar", (0.2, 0.7), (-0.25, 0.25), (0, 1.2)),
        box("other", (1.3, 1.8), (-0.25, 0.25), (0, 1.2)),
        box("lintel", (0.2, 1.8), (-0.25, 0.25), (1.2, 1.5)),
    ]
    motion = {"kind": "harmonic", "amplitude": 2.5, "frequency": 3.0, "cycles": 2.0, "phase_deg": 90.0}
    shaken = {
        "dimension": 3,
        **tables(
            *stones,
            joints={"j": {"friction": 0.7, "kn": 3e9, "ks": 2e9}},
            analysis={"kind": "time-history", "duration": 1.0},
            damping=damping,
            motion={**motion, "direction": [1.0, 0.4, 0.3], "blocks": ["right"]},
        ),
    }
    summary, _ = engine.solve(shaken)
    assert summary["largest_displacement"] > 1e-3
    assert abs(summary["energy_closure"]) < 5e-4
    assert set(summary["energy_shares"]) == {"friction", "dashpots" if "contact_fraction" in damping else "maxwell"}


def test_unknown_block(vibrations):
    with pytest.raises(CaseError, match="block"):
        engine.solve(case({"contact_fraction": 0.02, "block": "nobody"}))


# -- blocks that rock --------------------------------------------------------------------------------


def prism(outline: np.ndarray, height: float, turn: float) -> dict:
    """On the ground, turned about the vertical."""
    c, s = math.cos(turn), math.sin(turn)
    foot = np.asarray(outline) @ np.array([[c, s], [-s, c]])
    return block("b", [(x, y, z) for x, y in foot for z in (0.0, height)])


def on_ground(stone: dict, **damping):
    """A case, its model and the block that rocks."""
    ground = box("base", (-4, 4), (-4, 4), (-1, 0), fixed=True)
    analysis = {"kind": "time-history", "duration": 1.0}
    made = engine.scene({"dimension": 3, **tables(ground, stone, damping=damping, analysis=analysis)})
    properties = joint_properties(made.request, made.model, DEFAULT.stiffness.dynamics)
    start = joints_of_start(made.model, bodies_at_rest(made.model), properties, smallest_edge(made.model))
    return made.case, made.model, reference_block(made.model, start, made.case.damping)


RECTANGLE = [(-0.5, -0.85), (0.5, -0.85), (0.5, 0.85), (-0.5, 0.85)]


@pytest.mark.parametrize("turn", [0.0, 0.3, 1.2])
def test_housner_about_an_oblique_edge(turn):
    _, model, reference = on_ground(prism(RECTANGLE, 2.0, turn), restitution="housner")
    rocking = reference.rocks()
    assert np.linalg.norm(rocking.ends[:, :2], axis=1) == pytest.approx([0.5, 0.5])
    assert rocking.ends[:, 2] == pytest.approx([-1.0, -1.0])
    assert rocking.ends[0, :2] + rocking.ends[1, :2] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert abs(rocking.axis @ rocking.ends[0]) < 1e-12
    assert np.cross(rocking.axis, [0.0, 0.0, 1.0]) @ rocking.ends[0] > 0.0  # it tilts over what it stands on
    assert housner(model, reference) == pytest.approx(1.0 - 1.5 / (1.0 + 2.0**2), rel=1e-12)


def test_housner_of_a_trapezoid():
    """Two parallel sides not as far from the centroid: moments of inertia and both arms by hand."""
    b, t, depth, height = 1.0, 0.6, 1.6, 3.0
    _, model, reference = on_ground(
        prism([(-b / 2, 0.0), (b / 2, 0.0), (t / 2, depth), (-t / 2, depth)], height, 0.7), restitution="housner"
    )
    ends = np.linalg.norm(reference.rocks().ends[:, :2], axis=1)
    middle = depth * (b + 2.0 * t) / (3.0 * (b + t))
    # A side that is not parallel to any other is nearer to the centroid: across it the furthest corner counts.
    slant = math.hypot(depth, (b - t) / 2)
    beside = ((b / 2) * depth - middle * (b - t) / 2) / slant
    assert beside < min(middle, depth - middle)
    assert ends[0] == pytest.approx(beside, rel=1e-12)
    assert 0.0 < housner(model, reference) < 1.0


@pytest.mark.parametrize(("fraction", "planar"), [(0.35, 0.7429), (2.0, 0.6993)])
def test_rocking_about_an_oblique_edge_is_that_of_the_plane(fraction, planar):
    """Measured 0.7420 and 0.6996: on the same soft joints the prism h/b = 2 in the plane has 0.7429 and 0.6993."""
    case_, model, reference = on_ground(prism(RECTANGLE, 2.0, 0.3), restitution="housner")
    assert rocked(solver_request(case_), model, reference, fraction) == pytest.approx(planar, abs=2e-3)


def test_wanted_restitution():
    case_, model, reference = on_ground(prism(RECTANGLE, 2.0, 0.3), restitution=0.72)
    damping = damping_of_start(solver_request(case_), model)
    assert rocked(solver_request(case_), model, reference, damping.fraction) == pytest.approx(0.72, abs=1e-3)
    assert "restitution 0.72 of block 'b'" in damping.words


def beside(*stones: dict, dimension: int = 3, **damping) -> str:
    """Words about the damping of stones on a slab."""
    ground = rectangle(-9, -1, 9, 0)
    slab = box("slab", (-9, 9), (-9, 9), (-1, 0), fixed=True) if dimension == 3 else block("slab", ground, fixed=True)
    analysis = {"kind": "time-history", "duration": 1.0}
    made = engine.scene({"dimension": dimension, **tables(slab, *stones, damping=damping, analysis=analysis)})
    return damping_of_start(made.request, made.model).words


V = [(0.0, 0.0), (1.0, 2.0), (-1.0, 2.0)]  # it stands on its lower corner, along y on an edge
ON_EDGE = block("v", [(x, y, z) for x, z in V for y in (0.0, 3.0)])
ON_CORNER = block("v", [(0.0, 0.0, 0.0), (1.0, 2.0, 2.0), (-1.0, 2.0, 2.0), (0.0, -2.0, 2.0)])
SMALL = box("small", (4.0, 4.5), (0.0, 4.0), (0.0, 1.0))


@pytest.mark.parametrize(
    ("dimension", "pointed", "small"),
    [(3, ON_EDGE, SMALL), (3, ON_CORNER, SMALL), (2, block("v", V), block("small", rectangle(4.0, 0.0, 4.5, 1.0)))],
    ids=["edge", "corner", "plane"],
)
def test_a_block_on_an_edge_or_a_corner_is_no_reference(dimension, pointed, small):
    """It was, where it was the heaviest: an internal error in space, and a ratio of 1 in the plane."""
    words = beside(pointed, small, dimension=dimension, restitution="housner")
    assert words == "restitution of Housner, 0.7 for block 'small'"  # 1 − 1.5 sin²α, h/b = 2
    with pytest.raises(CaseError, match="no block rests on a support with more than a corner or an edge; name one"):
        beside(pointed, dimension=dimension, restitution="housner")
    with pytest.raises(CaseError, match="'v' rests on a corner, an edge or an upright face: it does not rock"):
        beside(pointed, small, dimension=dimension, restitution="housner", block="v")
