"""Elastic joints in time histories: pressure over the face, as in all other analyses, and dashpots where it presses.

Frequencies of small vibrations against those of kind = "modes", rocking against the differential equation of a block on
an elastic bed without tension, the plane against space, energy, damping ratios, and what an impact leaves.
"""

from __future__ import annotations

import numpy as np
import pytest
from engine import Records, block, rectangle, scene, solve, tables
from oracle.winkler_block import WinklerBlock
from studies.space.structures import box

from dem_cli.core.dynamics.history import damping_of_start
from dem_cli.core.dynamics.restitution import RockingBlock, rocked

KN, DENSITY = 1e9, 2000.0
JOINT = {"friction": 5.0, "kn": KN, "ks": 0.4 * KN}
NONE = {"none": True}
WIDTH, HEIGHT, SOFT = 0.5, 1.0, 1e8  # of the block that rocks, and its bed


def ground(dimension: int) -> dict:
    if dimension == 2:
        return block("base", rectangle(-3.0, -0.5, 3.5, 0.0), fixed=True)
    return box("base", (-3.0, -2.0, -0.5), (3.5, 2.0, 0.0), fixed=True)


def column(dimension: int, count: int, side: float = 0.5) -> dict:
    """Cubes of half a metre on each other; a slice of them in the plane."""
    if dimension == 2:
        stones = [block(f"b{k}", rectangle(0.0, side * k, side, side * (k + 1))) for k in range(count)]
        return tables(ground(2), *stones, density=DENSITY, joints={"dry": JOINT})
    stones = [box(f"b{k}", (0.0, 0.0, side * k), (side, side, side * (k + 1))) for k in range(count)]
    return tables(ground(3), *stones, density=DENSITY, joints={"dry": JOINT}, dimension=3)


def wall(dimension: int) -> dict:
    """Four courses in running bond, whose head joints are not filled; in the plane along it."""
    made = tables(density=DENSITY, joints={"dry": JOINT | {"head": "none"}})
    shape = {"kind": "wall", "block": [0.5, 0.25], "courses": 4, "blocks_per_course": 2, "thickness": 0.5, "id": "w"}
    return {key: value for key, value in made.items() if key != "block"} | {
        "structure": [shape], **({"dimension": 3} if dimension == 3 else {}),
    }  # fmt: skip


def first_frequency(case: dict) -> float:
    summary, _ = solve(case | {"analysis": {"kind": "modes", "count": 1}})
    return float(summary["frequencies"][0])


def swung(case: dict, velocity: dict, monitor: dict, frequency: float, **more) -> tuple[dict, np.ndarray, np.ndarray]:
    """Summary, times and motion of a structure that is let go with a velocity: a dozen cycles."""
    shaken = {"kind": "time-history", "duration": 12.0 / frequency}
    output = {"frames": 0, "rate": 100.0 * frequency}
    summary, records = solve(
        case
        | {"analysis": shaken, "damping": NONE, "initial": [velocity], "monitor": [monitor], "output": output}
        | more
    )
    history = records.history
    return summary, history.times, history.monitors[:, 0]


def leading(times: np.ndarray, motion: np.ndarray) -> float:
    """Frequency that a motion has most of [Hz]."""
    seen, n = (motion - motion.mean()) * np.hanning(len(motion)), 1 << 20
    return float(np.fft.rfftfreq(n, times[1] - times[0])[np.abs(np.fft.rfft(seen, n)).argmax()])


STRUCTURES = {
    "block": lambda d: (column(d, 1), "b0"),
    "column": lambda d: (column(d, 4), "b3"),
    "wall": lambda d: (wall(d), "w-4-1"),
}


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("structure", STRUCTURES)
def test_small_vibrations_have_the_frequency_of_modes(structure, dimension):
    """With points at the ends a block had 1.35 times, a column 1.66 times that frequency."""
    case, top = STRUCTURES[structure](dimension)
    frequency = first_frequency(case)
    if structure == "wall" and dimension == 3:  # it swings out of its plane
        velocity, component = [0.0, 1e-6, 0.0], "y"
    else:
        velocity, component = [1e-6, *[0.0] * (dimension - 1)], "x"
    start = {"blocks": [top], "velocity": velocity + [0.0] * (1 if dimension == 2 else 3)}
    summary, times, motion = swung(case, start, {"block": top, "component": component}, frequency)
    assert leading(times, motion) == pytest.approx(frequency, rel=5e-3)
    assert abs(summary["energy_closure"]) < 1e-6


def test_a_block_twists_as_modes_say():
    """About its vertical axis, on a face that has the torsion of a spread pressure."""
    case = column(3, 1)
    summary, _ = solve(case | {"analysis": {"kind": "modes", "count": 3}})
    frequency = float(summary["frequencies"][2])
    polar = np.sqrt(0.4 * KN * 0.25 / (DENSITY * 0.125)) / (2.0 * np.pi)  # of an elastic layer that sticks everywhere
    assert 0.93 * polar < frequency < polar
    start = {"block": "b0", "velocity": [0.0, 0.0, 0.0, 0.0, 0.0, 1e-6]}
    monitor = {"block": "b0", "quantity": "rotation", "component": "z"}
    _, times, motion = swung(case, start, monitor, frequency)
    assert leading(times, motion) == pytest.approx(frequency, rel=5e-3)


def bed(dimension: int, delay: float, duration: float = 1.5, **shaken) -> dict:
    """A block of 0.5 × 1 m, a metre thick, that starts to turn with 0.9 rad/s about the middle of its foot."""
    spin = 0.9
    if dimension == 2:
        stone, velocity = block("b", rectangle(-WIDTH / 2, 0.0, WIDTH / 2, HEIGHT)), [-spin * HEIGHT / 2, 0.0, spin]
        upright, turn = {"component": "y"}, {}
    else:
        stone = box("b", (-WIDTH / 2, -0.5, 0.0), (WIDTH / 2, 0.5, HEIGHT))
        velocity = [-spin * HEIGHT / 2, 0.0, 0.0, 0.0, -spin, 0.0]
        upright, turn = {"component": "z"}, {"component": "y"}
    monitors = [
        {"block": "b", "component": "x"},
        {"block": "b"} | upright,
        {"block": "b", "quantity": "rotation"} | turn,
    ]
    return tables(
        ground(dimension), stone, density=DENSITY, joints={"dry": {"friction": 10.0, "kn": SOFT, "ks": SOFT}},
        analysis={"kind": "time-history", "duration": duration} | shaken, monitor=monitors,
        damping={"stiffness": delay} if delay else NONE, initial=[{"block": "b", "velocity": velocity}],
        output={"frames": 0, "rate": 500.0}, **({"dimension": 3} if dimension == 3 else {}),
    )  # fmt: skip


def of_block(records: Records, dimension: int) -> tuple[np.ndarray, np.ndarray]:
    """Times, and x, y and counter-clockwise rotation of the block that rocks."""
    history = records.history
    return history.times, history.monitors * [1.0, 1.0, 1.0 if dimension == 2 else -1.0]


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("delay", [0.0, 2e-3, 1e-2])
def test_a_block_rocks_on_an_elastic_bed(delay, dimension):
    """Four to six landings; at its ends alone it would lift off a third as soon."""
    summary, records = solve(bed(dimension, delay))
    times, motion = of_block(records, dimension)
    exact = WinklerBlock(WIDTH, HEIGHT, DENSITY, SOFT, SOFT, delay).motion((-0.9 * HEIGHT / 2, 0.0, 0.9), times)
    assert np.abs(motion - exact).max(axis=0) == pytest.approx(0.0, abs=0.01 * np.abs(exact).max())
    assert np.abs(motion - exact)[:, 2].max() < 0.01 * np.abs(exact[:, 2]).max()
    assert abs(summary["energy_closure"]) < 3e-3
    lost = summary["energy_shares"]
    assert lost.get("dashpots", 0.0) == (pytest.approx(1.0, abs=1e-3) if delay else 0.0)


def test_a_prism_rocks_as_its_section():
    found = []
    for dimension in (2, 3):
        _, records = solve(bed(dimension, 2e-3, duration=1.0, time_step=1e-4))
        found.append(of_block(records, dimension)[1])
    assert np.abs(found[0] - found[1]).max(axis=0) == pytest.approx(0.0, abs=2e-3 * np.abs(found[0]).max())


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("damping", ["stiffness", "maxwell"])
def test_damping_ratios_are_those_asked_for(damping, dimension):
    """Of a block that swings on its joint, closed as it is: three times as much with dashpots at the ends."""
    case, ratio = column(dimension, 1), 0.02
    frequency = first_frequency(case)
    asked = {
        "stiffness": {"stiffness": ratio / (np.pi * frequency)},
        "maxwell": {"maxwell": [{"ratio": ratio, "frequency": frequency}]},
    }[damping]
    start = {"block": "b0", "velocity": [1e-6, *[0.0] * (2 if dimension == 2 else 5)]}
    summary, times, motion = swung(case, start, {"block": "b0", "component": "x"}, frequency, damping=asked)
    early, late = (np.ptp(motion[(times >= at / frequency) & (times < (at + 1.5) / frequency)]) for at in (0.0, 8.0))
    assert np.log(early / late) / (2.0 * np.pi * 8.0) == pytest.approx(ratio, rel=0.15)  # by cycles
    assert abs(summary["energy_closure"]) < 1e-6


@pytest.mark.parametrize("slenderness", [2.0, 4.0])
def test_a_landing_takes_less_than_that_of_housners_block(slenderness):
    """The blow is spread over what lands, not at its edge; the same in the plane as in space."""
    found, rigid = [], 1.0 - 1.5 / (1.0 + slenderness**2)
    for dimension in (2, 3):
        case = bed(dimension, 0.0)
        if dimension == 2:
            case["block"][1] = block("b", rectangle(-0.25, 0.0, 0.25, 0.5 * slenderness))
        else:
            case["block"][1] = box("b", (-0.25, -0.25, 0.0), (0.25, 0.25, 0.5 * slenderness))
        case |= {"joints": {"dry": {"friction": 10.0, "kn": 2e10}}, "damping": {"contact_fraction": 0.5}}
        made = scene(case)
        foot = np.array([[-0.25, -0.25 * slenderness], [0.25, -0.25 * slenderness]])
        if dimension == 3:
            foot = np.array([[x, y, -0.25 * slenderness] for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
            foot[:, :2] *= 0.25
        found.append(rocked(made.request, made.model, RockingBlock(1, 0, 1.0, foot), 0.5))
    assert found[0] == pytest.approx(found[1], abs=2e-3)
    blow = 2.0 / 3.0  # of half the width: where that of a face that closes evenly fast from one edge acts
    size = (1.0 + slenderness**2) / 3.0 + slenderness**2
    evenly = (size - blow) / (size + blow)
    assert rigid + 0.02 < found[0] < evenly + 0.06


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_restitution_lands_on_the_ends(dimension):
    """It is that of a block that lands on its edge, and the run says so."""
    case = bed(dimension, 0.0) | {"damping": {"restitution": "housner"}}
    made = scene(case)
    words = damping_of_start(made.request, made.model).words
    assert words.endswith("for block 'b', which lands on the ends of its joints")
    stiff = scene(case | {"joints": {"dry": {"friction": 0.6}}})
    assert damping_of_start(stiff.request, stiff.model).words.endswith("for block 'b'")
