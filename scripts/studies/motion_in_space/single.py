"""One block that moves in space, beside closed forms and integrals: rocks, slides, spins, flies, bounces, drops."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from oracle.bouncing import Joint, contact_time
from oracle.sliding_pad import SlidingPad
from oracle.tilting_prism import TiltingPrism

from studies.motion_in_space.book import BookedRun, run
from studies.space.structures import box, prism, solid

GRAVITY, DENSITY = 9.81, 2000.0
ROUGH = 10.0  # friction of what must not slide
STIFF = 1e5  # kn h / (ρ g h): overlap at rest over the height of a block 1 m high

SQUARE = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
FEET = {  # outline, counter-clockwise, and the first corner of the edge that it rocks about
    "box": (SQUARE, 1),
    "triangular prism": (np.array([[0.0, 0.0], [0.7, 0.0], [0.0, 0.4]]), 1),
    "trapezoid": (np.array([[0.0, 0.0], [1.0, 0.0], [0.7, 0.5], [0.1, 0.5]]), 1),
    "hexagon": (np.column_stack([np.cos(k := np.arange(6) * math.pi / 3.0 + 0.2), np.sin(k)]) * 0.5, 0),
}
HEIGHT = 1.0


def history(*blocks: dict, duration: float, friction: float = ROUGH, stiffness: float = STIFF, **more) -> dict:
    """A time history of explicit blocks; `more` adds tables or replaces them."""
    return {
        "dimension": 3,
        "gravity": GRAVITY,
        "materials": {"stone": {"density": DENSITY}},
        "joints": {"dry": {"friction": friction, "kn": stiffness * DENSITY * GRAVITY}},
        "block": list(blocks),
        "analysis": {"kind": "time-history", "duration": duration, "coda": 0.0, "after_collapse": 10.0}
        | more.pop("analysis", {}),
        "damping": {"none": True},
        "output": {"frames": 20, "rate": 5000.0},
        **more,
    }


def ground(reach: float = 4.0) -> dict:
    """A wide fixed slab with its top at height 0."""
    return box("ground", (-reach, -reach, -0.5), (reach, reach, 0.0), fixed=True)


def zero(times: np.ndarray, values: np.ndarray) -> float:
    """When a value first falls below 0, by a straight line between two samples."""
    below = np.flatnonzero(values <= 0.0)
    if not len(below) or below[0] == 0:
        return math.nan
    k = int(below[0])
    return float(times[k - 1] + (times[k] - times[k - 1]) * values[k - 1] / (values[k - 1] - values[k]))


# -- rocking -----------------------------------------------------------------------------------------------------


def tilting(name: str) -> TiltingPrism:
    """A prism with the edge that it rocks about first."""
    foot, first = FEET[name]
    return TiltingPrism(np.roll(foot, -first, axis=0), HEIGHT, GRAVITY)


def rocking_case(name: str, stiffness: float = STIFF, share: float = 0.4, **more) -> dict:
    """A prism tilted by a share of its angle of balance about one edge, and let go."""
    exact = tilting(name)
    angle = share * exact.alpha
    axis = [float(x) for x in (*exact.edge, 0.0)]
    case = history(
        ground(), prism("block", exact.foot, 0.0, HEIGHT), duration=1.3 * exact.lands(angle).time, stiffness=stiffness
    )
    case["initial"] = [{"block": "block", "tilt": angle, "axis": axis}]
    case["monitor"] = [{"block": "block", "quantity": "rotation", "component": c} for c in "xyz"]
    return case | more


def rocking(name: str, stiffness: float = STIFF, **more) -> dict[str, Any]:
    """Time of landing and speed before it, against the rigid body about its edge."""
    exact = tilting(name)
    landing = exact.lands(0.4 * exact.alpha)
    found = run(rocking_case(name, stiffness, **more))
    angles = found.seen.values[:, :2] @ exact.edge
    when = zero(found.seen.times, angles)
    return {
        "name": f"{name}, X {stiffness:.0e}",
        "figure": "time of landing [s]",
        "exact": landing.time,
        "found": when,
    } | found.books


def box_on_corner_case() -> dict:
    """A box that stands on one corner of its foot, tilted about a diagonal: 45° to its sides."""
    alpha = math.atan2(math.sqrt(0.5), 0.5 * HEIGHT)
    case = history(ground(), prism("block", SQUARE, 0.0, HEIGHT), duration=1.2)
    case["initial"] = [{"block": "block", "tilt": 0.4 * alpha, "axis": [1.0, -1.0, 0.0]}]
    case["monitor"] = [{"block": "block", "quantity": "rotation", "component": c} for c in "xyz"]
    return case


def box_on_corner() -> dict[str, Any]:
    """The box on its corner is a rigid body about its diagonal's normal through that corner until it lands."""
    radius, alpha = math.hypot(math.sqrt(0.5), 0.5 * HEIGHT), math.atan2(math.sqrt(0.5), 0.5 * HEIGHT)
    exact = pendulum(1.0 / 12.0 + HEIGHT**2 / 12.0 + radius**2, radius, alpha, 0.4 * alpha)
    found = run(box_on_corner_case())
    angles = found.seen.values[:, :2] @ (np.array([1.0, -1.0]) / math.sqrt(2.0))
    return {
        "name": "box on its corner, 45°",
        "figure": "time of landing [s]",
        "exact": exact,
        "found": zero(found.seen.times, angles),
    } | found.books


def pendulum(inertia: float, radius: float, alpha: float, angle: float) -> float:
    """Time in which a body of this inertia per mass falls back upright from rest at an angle."""
    from scipy.integrate import solve_ivp

    def upright(_, state):
        return state[0]

    upright.terminal = True
    pull = GRAVITY * radius / inertia
    found = solve_ivp(
        lambda _, y: [y[1], -pull * math.sin(alpha - y[0])], (0, 100.0), [angle, 0.0], events=upright, rtol=1e-12
    )
    return float(found.t_events[0][0])


# -- sliding and spinning --------------------------------------------------------------------------------------------

PAD = SlidingPad(1.0, 0.6, 0.4, 0.5, GRAVITY)


def thrown(velocity: tuple[float, float], spin: float, stiffness: float = STIFF) -> BookedRun:
    """A pad on the ground with a velocity and a spin; margin small enough for stops."""
    a, b = 0.5 * PAD.length, 0.5 * PAD.width
    stops = PAD.stops(velocity, spin)
    case = history(
        ground(6.0),
        box("block", (-a, -b, 0.0), (a, b, PAD.height)),
        duration=1.2 * stops.time + 0.05,
        friction=PAD.friction,
        stiffness=stiffness,
    )
    case["initial"] = [{"block": "block", "velocity": [*map(float, velocity), 0.0, 0.0, 0.0, float(spin)]}]
    place = [{"block": "block", "component": c} for c in "xy"]
    case["monitor"] = [*place, {"block": "block", "quantity": "rotation", "component": "z"}]
    return run(case)


def sliding(azimuth: float) -> list[dict[str, Any]]:
    """v² / 2 μ g in any direction, and how straight."""
    speed, angle = 2.0, math.radians(azimuth)
    found = thrown((speed * math.cos(angle), speed * math.sin(angle)), 0.0)
    x, y = found.column(0)[-1], found.column(1)[-1]
    name, books = f"slides at {azimuth:g}°", found.books
    return [
        {"name": name, "figure": "distance [m]", "exact": speed**2 / (2.0 * PAD.friction * GRAVITY),
         "found": float(np.hypot(x, y))} | books,
        {"name": name, "figure": "direction [°]", "exact": azimuth,
         "found": float(np.degrees(np.arctan2(y, x)))} | books,
    ]  # fmt: skip


def spinning() -> dict[str, Any]:
    """Four corners brake a spin at μ g r / i, nearly twice as much as pressure that is uniform."""
    found = thrown((0.0, 0.0), 3.0)
    exact = PAD.stops((0.0, 0.0), 3.0).angle
    return {"name": "spins on four corners", "figure": "angle [rad]", "exact": exact,
            "found": float(found.column(2)[-1])} | found.books  # fmt: skip


def sliding_and_spinning() -> list[dict[str, Any]]:
    """Both, against the differential equations of four corners."""
    found, exact = thrown((2.0, 1.0), 3.0), PAD.stops((2.0, 1.0), 3.0)
    ends = (*map(float, exact.place), exact.angle)
    figures = zip(("x [m]", "y [m]", "angle [rad]"), ends, found.seen.values[-1], strict=True)
    return [
        {"name": "slides and spins", "figure": figure, "exact": value, "found": float(end)} | found.books
        for figure, value, end in figures
    ]


# -- flight and impacts ----------------------------------------------------------------------------------------------


def flying_case(turns: float = 100.0) -> dict:
    """A box far above the ground that tumbles about its middle axis."""
    speed = 20.0
    case = history(
        ground(0.5),
        box("block", (-0.5, -0.3, 0.0), (0.5, 0.3, 0.4)),
        duration=turns / speed,
        analysis={"settle": False, "fallen_deg": 1e9, "dropped": 1e9},
    )
    start = {"displacement": [0.0, 0.0, 2000.0], "velocity": [1.0, 2.0, 3.0, 0.1, speed, 0.2]}
    case["initial"] = [{"block": "block"} | start]
    case["monitor"] = [{"block": "block", "component": c} for c in "xyz"]
    return case


def flying() -> dict[str, Any]:
    """Energy over 100 rad; the centroid falls by g t²/2."""
    found = run(flying_case())
    t = found.seen.times[-1]
    return {"name": "tumbles freely, 100 rad", "figure": "fall [m]", "exact": 2000.0 + 3.0 * t - 0.5 * GRAVITY * t**2,
            "found": float(found.column(2)[-1])} | found.books  # fmt: skip


def bouncing_case(friction: float, spin: float = 10.0, fall: float = 0.05) -> dict:
    """A flat box that spins about the vertical and falls flat; joints stiff enough for a short contact."""
    case = history(
        ground(),
        box("block", (-0.5, -0.5, 0.0), (0.5, 0.5, 0.5)),
        duration=3.0 * math.sqrt(2.0 * fall / GRAVITY),
        friction=friction,
        stiffness=1e6,
        analysis={"margin": 0.1},
    )
    case["initial"] = [
        {"block": "block", "displacement": [0.0, 0.0, fall], "velocity": [0.0, 0.0, 0.0, 0.0, 0.0, spin]}
    ]
    case["monitor"] = [
        {"block": "block", "component": "z"},
        {"block": "block", "quantity": "rotation", "component": "z"},
    ]
    return case


def bouncing(friction: float = 0.1, spin: float = 10.0, fall: float = 0.05) -> list[dict[str, Any]]:
    """It comes back to its height; the impulse N of the impact takes μ N r of its spin, r: from axis to corner."""
    found = run(bouncing_case(friction, spin, fall))
    speed, mass = math.sqrt(2.0 * GRAVITY * fall), DENSITY * 0.5
    joint = Joint(1e6 * DENSITY * GRAVITY, mass, gravity=GRAVITY)
    impulse = mass * (2.0 * speed + GRAVITY * contact_time(joint, speed))
    lost = friction * impulse * math.sqrt(0.5) / (mass / 6.0)
    times = found.seen.times
    meets, after = speed / GRAVITY, times > speed / GRAVITY + 0.02
    slope = np.polyfit(times[after], np.unwrap(found.column(1)[after]), 1)[0]
    top = float(found.column(0)[times > 1.5 * meets].max())
    name = f"spinning bounce, μ {friction:g}"
    return [
        {"name": name, "figure": "height [m]", "exact": fall, "found": top} | found.books,
        {"name": name, "figure": "spin after it [rad/s]", "exact": spin - lost, "found": float(slope)} | found.books,
    ]


def cube_on_corner(damping: dict | None = None, size: float = 0.1) -> dict[str, Any]:
    """A cube that falls on its corner: it ends flat, half a side above the ground."""
    case = history(
        ground(1.0),
        box("block", (-0.5 * size, -0.5 * size, 0.0), (0.5 * size, 0.5 * size, size)),
        duration=3.0,
        friction=0.6,
        analysis={"settle": False, "fallen_deg": 1e9, "dropped": 1e9},
        stiffness=STIFF,
        **({"damping": damping} if damping else {}),
    )
    case["monitor"] = [{"block": "block", "component": "z"}]
    start = {"tilt": math.atan(math.sqrt(2.0)), "axis": [1.0, -1.0, 0.0]}  # a diagonal of the cube stands upright
    start |= {"displacement": [0.0, 0.0, 0.02], "velocity": [0.0, 0.0, 0.0, 0.3, 0.1, 0.0]}
    case["initial"] = [{"block": "block"} | start]
    found = run(case)
    height = float(found.column(0)[-1]) + 0.5 * size
    words = "dashpots" if damping else "no dashpots"
    return {"name": f"cube dropped on its corner, {words}", "figure": "height at the end [m]", "exact": 0.5 * size,
            "found": height} | found.books  # fmt: skip


def beam_on_ridge(margin: float = 0.25, roll: float = 0.2) -> dict[str, Any]:
    """A beam across a ridge, at 40° to it, rolled about its axis and let go: an edge that rolls on an edge."""
    ridge = solid(
        "ridge", [(x, y, z) for x in (-2.0, 2.0) for y, z in ((-0.5, -0.5), (0.5, -0.5), (0.0, 0.0))], fixed=True
    )
    c, s = math.cos(math.radians(40.0)), math.sin(math.radians(40.0))
    along, across = np.array([c, s, 0.0]), np.array([-s, c, 0.0])
    signs = np.array([(i, j, k) for i in (-1, 1) for j in (-1, 1) for k in (0, 2)])
    corners = signs * [1.0, 0.1, 0.1] @ np.array([along, across, np.eye(3)[2]])
    case = history(
        ridge,
        solid("beam", corners),
        duration=0.5,
        friction=0.7,
        analysis={"margin": margin, "settle": False, "fallen_deg": 1e9, "dropped": 1e9},
    )
    case["initial"] = [{"block": "beam", "tilt": roll, "axis": along.tolist(), "displacement": [0.0, 0.0, 0.01]}]
    case["monitor"] = [{"block": "beam", "component": "z"}]
    found = run(case)
    return {"name": f"beam rolled by {math.degrees(roll):.0f}° on a ridge, margin {margin:g}", "figure": "book",
            "exact": None, "found": found.books["book"]} | found.books  # fmt: skip
