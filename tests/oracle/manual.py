"""Exact answers of the small cases of the verification manual: closed forms, and the motions of the other oracles.

Sizes and properties are written here once more, from the comments of the case files. Nothing of dem_cli is used.
"""

from __future__ import annotations

from math import acosh, atan, atan2, cos, hypot, log10, pi, radians, sin, sqrt, tan

import numpy as np

from oracle import bouncing, newmark_slider, two_blocks
from oracle.base_motion import pulse, rectangle
from oracle.housner import Block, rock
from oracle.limit_lp import area_and_centroid
from oracle.strong_joints import Points, toppling_load

G = 9.81
LOBATTO_5 = (np.array([0.0, 0.5 - sqrt(3 / 28), 0.5, 0.5 + sqrt(3 / 28), 1.0]), np.array([9, 49, 64, 49, 9]) / 180)
Answers = dict[str, float]  # by their paths in summary.json


def statics() -> dict[str, Answers]:
    """Failure loads and equilibria in closed form."""
    weight = 2000.0 * G  # of a cube of 1 m [N]
    flat = 2000.0 * G * 0.5  # weight per area of a block 0.5 m high [Pa]
    barton = tan(radians(25.0 + 8.0 * log10(20e6 / flat)))
    loads = {
        "slope_of_slip": 0.6,
        "incline_up": tan(atan(0.5) + radians(10.0)),
        "incline_down": tan(atan(0.5) - radians(10.0)),
        "groove_30": tan(radians(30.0) + atan(0.6)),
        "interface_slides": min(0.3, 0.6),
        "stepped_column": min(0.4 / 2.0, 1.8 * 0.5 / (1.0 * 0.5 + 0.8 * 2.0)),  # the upper alone, both
        "lever": 4.0 * 0.2 * 2000.0 * G * 1.0 / (1000.0 * 1.0),  # moments about the edge
        "cohesion_block": 0.5 + 1000.0 / (2000.0 * G * 0.3),
        "tension_block": (30e3 - weight) / 1000.0,
        "crushing_block": (1e6 - weight) / 1000.0,
        "crushing_toe": crushed_toe(0.6, 1.0, 4e4, 2000.0 * G),
        "barton_block": barton * flat / 1000.0,
        "dam_overturns": 2400.0 * 1.2 * 3.0 * 0.6 / (1000.0 * 3.0**3 / 6),  # moments about the toe over g
        "retaining_earth": 2200.0
        * (0.9 * 3 * 0.45 + 0.6 * (0.9 + 0.4 / 3))
        / (1800.0 * (27 / 18 - 0.6 * (1.3 - 0.4 / 3))),
    }
    found: dict[str, Answers] = {name: {"failure_load": load} for name, load in loads.items()}
    found["spring_penetration"] = {"monitors.block displacement y.value": -weight / 1e9}
    found["dam_level"] = {"critical_value": 21.6 ** (1 / 3)}
    turn = radians(1.0)
    found["settlement_group"] = {
        "monitors.pair displacement y.value": -0.02,
        "monitors.second displacement y.value": sin(turn) - 0.02,
        "monitors.beam rotation.value": turn,
    }
    found["settlement_two_blocks"] = leaning_blocks(0.1)
    return found


def crushed_toe(width: float, height: float, strength: float, gravity: float) -> float:
    """λ at which a block turns over five points of a Gauss-Lobatto rule that are crushed one after the other."""
    return toppling_load(Points(*LOBATTO_5, 0.9, compression=strength), width, height, gravity * width * height)


def leaning_blocks(apart: float) -> Answers:
    """Two blocks that lean on each other, when their feet, 2 m apart, are moved apart [m]; the crown is 1.4 m above."""
    half = 1.0 + 0.5 * apart
    turn = atan2(sqrt(1.0 + 1.4**2 - half**2), half) - atan2(1.4, 1.0)
    corners = np.array([(-1.4, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, 1.4)])
    x, y = area_and_centroid(corners)[1] - corners[1]
    return {
        "monitors.left rotation.value": turn,
        "monitors.right rotation.value": -turn,
        "monitors.left displacement y.value": x * sin(turn) + y * cos(turn) - y,
    }


def springs() -> dict[str, Answers]:
    """A cube of 1 m on springs: all over the joint; what only goes up and down does not ask where they are."""
    mass, kn, ks = 2000.0, 1e9, 4e8
    stiffness = np.array([[ks, 0.5 * ks], [0.5 * ks, kn / 12.0 + 0.25 * ks - 0.5 * mass * G]])
    sideways = np.linalg.eigvalsh(stiffness / np.sqrt(np.outer(*2 * ([mass, mass / 6.0],))))
    squares = np.sort([*sideways, kn / mass])
    period, rest = 2.0 * pi * sqrt(mass / kn), mass * G / kn
    stop = 0.5 * pi / sqrt(2.0 * 2e10 / mass)  # v t_c / 2 of two cubes that collide with 1 m/s [m]
    fall = bouncing.Joint(2e10, mass)
    return {
        "modes_block": {f"frequencies.{i}": sqrt(square) / (2.0 * pi) for i, square in enumerate(squares)},
        "vertical_vibration": {
            "peaks.block displacement y.min": -rest - 1e-5,
            "peaks.block displacement y.min_time": 0.5 * period,
            "peaks.block displacement y.residual": -rest,
        },
        "collision": {
            "peaks.first displacement x.residual": 0.05 + stop,
            "peaks.second displacement x.residual": 0.15 - 0.05 - stop,
            "peaks.second velocity x.residual": 1.0,
        },
        "bouncing_block": {
            "peaks.block displacement y.max": 0.05,
            "peaks.block displacement y.min": -bouncing.peak_overlap(fall, 0.05),
        },
    }


def sliding() -> dict[str, Answers]:
    """Blocks that slide, from rest, pushed, or on a base in motion."""
    back_and_forth = newmark_slider.slide(newmark_slider.Slope(0.2), pulse(9.0, 1.0), 2.0)
    left_behind = newmark_slider.slide(newmark_slider.Slope(0.3), rectangle(6.0, 0.2), 1.0).final
    assert abs(left_behind + 0.5 * 6.0 * 0.2**2 * (6.0 / (0.3 * G) - 1.0)) < 1e-12
    slope = radians(30.0)
    return {
        "incline_slide": {"peaks.top displacement.residual": 0.5 * G * (sin(slope) - 0.3 * cos(slope))},
        "push_stop": {"peaks.block displacement x.residual": 1.0 / (2.0 * 0.5 * G)},
        "sliding_rectangle": {"peaks.block displacement x.residual": left_behind},
        "sliding_pulse": {
            "peaks.block displacement x.residual": back_and_forth.final,
            "peaks.block displacement x.min": float(back_and_forth.slips.min()),
        },
    }


def rocking() -> dict[str, Answers]:
    """Blocks that rock: Housner's, and two on each other."""
    low, tall = Block(0.5, 1.0), Block(0.5, 2.0)
    times, angles = rock(low, angle=0.25, duration=1.6).extremes()
    after = rock(tall, angle=1e-3, speed=-0.5, duration=0.6, step=1e-4).extremes()
    pushed = rock(tall, rectangle(1.2 * 0.25 * G, 0.3), duration=0.6, step=2e-4).extremes()
    lower, upper = two_blocks.Rectangle(0.5, 1.0, 2000.0), two_blocks.Rectangle(0.4, 1.2, 2000.0)
    pair = two_blocks.rock(lower, upper, (0.06, -0.04), duration=0.1).angles[-1]
    return {
        "rocking_free": {"peaks.block rotation.min": angles[0], "peaks.block rotation.min_time": times[0]},
        "housner_ratio": {"peaks.block rotation.min": after[1][0], "peaks.block rotation.min_time": after[0][0]},
        "rocking_rectangle": {"peaks.block rotation.peak": pushed[1][0], "peaks.block rotation.time": pushed[0][0]},
        "two_blocks_angles": {
            "peaks.block rotation.residual": pair[0],
            "peaks.upper rotation.residual": pair[1],
        },
    }


def quarter_period() -> tuple[float, float]:
    """Of a block of 0.5 m x 2 m from half the angle at which it falls [s]: exact, and with small angles."""
    block = Block(0.5, 2.0)
    exact = rock(block, angle=0.5 * block.alpha, duration=0.6, step=1e-4).impacts[0]
    return float(exact), acosh(1.0 / (1.0 - 0.5)) / block.p


def largest_overhang(blocks: int) -> float:
    """Of equal blocks of length 1."""
    return 0.5 * sum(1.0 / k for k in range(1, blocks + 1))


def square_on_polygon(corners: np.ndarray, rolls: int) -> float:
    """How far the centroid of a cube of 1 m moves that rolls on its polygonal foot, by so many sides [m]."""
    points, first = np.vstack([corners, [0.0, 0.5]]), np.array([0.0, 0.5])
    middle = (len(corners) - 1) // 2
    for side in range(middle + 1, middle + 1 + rolls):
        pivot, edge = points[side].copy(), points[side + 1] - points[side]
        c, s = edge / hypot(*edge)
        points = pivot + (points - pivot) @ np.array([[c, -s], [s, c]])
    return float(np.hypot(*(points[-1] - first)))
