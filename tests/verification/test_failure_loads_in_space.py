"""Failure loads of blocks in space with an answer by hand: pushed askew, about oblique edges, across a slope, twisted."""

from __future__ import annotations

import math

import numpy as np
import pytest
from engine import solve
from space import along_x, box, courses, frustum, mirrored, prism, quarter, regular, solid, tables, towards

RESOLUTION = 5e-4
EXACT = 1e-3  # of the load; twisted blocks 3e-3
STICKS = 3.0  # friction of joints that do not slide


def load_of(case: dict, **analysis) -> float:
    """The failure load, the middle of its bracket; bracket, books and overlap are as they should be."""
    case = {**case, "analysis": {**case["analysis"], "resolution": RESOLUTION, **analysis}}
    summary, _ = solve(case)
    assert summary["status"] == "ok", summary["warnings"]
    low, high = summary["failure_load_bracket"]
    assert high - low <= 1.01 * RESOLUTION * high
    assert abs(summary["energy_closure"]) < 0.01
    return 0.5 * (low + high)


def block_on_ground(size, **more) -> dict:
    b, d, h = size
    ground = box("ground", (-b, -d, -h), (2 * b, 2 * d, 0.0), fixed=True)
    return tables(ground, box("block", (0.0, 0.0, 0.0), size), **more)


@pytest.mark.parametrize("azimuth", [0.0, 25.0, 50.0, 90.0, 205.0])
def test_block_turns_over_the_edge_that_gives_first(azimuth):
    b, d, h = 0.6, 0.4, 1.0
    case = block_on_ground((b, d, h), friction=STICKS, direction=towards(azimuth))
    x, y, _ = np.abs(towards(azimuth))
    assert load_of(case) == pytest.approx(min(b / h / max(x, 1e-9), d / h / max(y, 1e-9)), rel=EXACT)


@pytest.mark.parametrize("azimuth", [0.0, 33.0, 110.0])
def test_block_slides_in_any_direction(azimuth):
    case = block_on_ground((0.6, 0.5, 0.1), friction=0.3, direction=towards(azimuth))
    assert load_of(case) == pytest.approx(0.3, rel=EXACT)


def test_prism_turns_over_its_oblique_edge():
    corners = np.array([[0.0, 0.0], [0.7, 0.0], [0.0, 0.4]])
    normal = np.array([0.4, 0.7]) / math.hypot(0.4, 0.7)
    reach = (corners[1] - corners.mean(axis=0)) @ normal  # from the centroid to the long side
    ground = box("ground", (-1.0, -1.0, -0.3), (2.0, 2.0, 0.0), fixed=True)
    case = tables(ground, prism("block", corners, 0.0, 1.0), friction=STICKS, direction=(*normal, 0.0))
    assert load_of(case) == pytest.approx(reach / 0.5, rel=EXACT)


def slope(alpha: float) -> np.ndarray:
    """Rows: along the dip downwards, across it, normal of a plane that falls towards +x."""
    c, s = math.cos(alpha), math.sin(alpha)
    return np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])


@pytest.mark.parametrize("way", ["up", "down", "across"])
def test_block_on_a_slope(way):
    alpha, mu = math.radians(15.0), 0.5
    axes, phi = slope(alpha), math.atan(mu)
    corners = lambda x, y, z: [np.array(p) @ axes for p in np.stack(np.meshgrid(x, y, z), -1).reshape(-1, 3)]  # noqa: E731
    ground, block = corners((-1, 2), (-1, 2), (-0.5, 0)), corners((0.0, 0.8), (0.0, 0.6), (0.0, 0.1))
    exact, direction = {
        "up": (math.tan(phi + alpha), (-1.0, 0.0, 0.0)),
        "down": (math.tan(phi - alpha), (1.0, 0.0, 0.0)),
        "across": (math.sqrt((mu * math.cos(alpha)) ** 2 - math.sin(alpha) ** 2), (0.0, 1.0, 0.0)),
    }[way]
    case = tables(solid("ground", ground, fixed=True), solid("block", block), friction=mu, direction=direction)
    assert load_of(case) == pytest.approx(exact, rel=EXACT)


def wedge_in_groove(half: float, mu: float) -> dict:
    """A wedge in a horizontal groove along x, pushed along it; half: angle between its sides and the vertical [rad]."""
    width, length, t = 0.3, 0.5, math.tan(half)
    depth = width / t
    left = [(-1.0, 0.0), (0.0, 0.0), (-width, depth), (-1.0, depth)]
    sides = [[(y, z) for y, z in left], [(-y, z) for y, z in left]]
    extruded = lambda outline, low, high: [(x, y, z) for x in (low, high) for y, z in outline]  # noqa: E731
    banks = [solid(f"bank-{i}", extruded(side, -1.0, 2.0), fixed=True) for i, side in enumerate(sides)]
    return tables(*banks, solid("wedge", extruded([(0.0, 0.0), (width, depth), (-width, depth)], 0.0, length)), friction=mu)


def test_wedge_in_a_groove_does_not_dilate():
    """μ / sin h; joints that dilate as they slide would carry 2 % more (0.33378 here)."""
    half = math.radians(50.0)
    assert load_of(wedge_in_groove(half, 0.25)) == pytest.approx(0.25 / math.sin(half), rel=EXACT)


def panel(n: int = 6, blocks: int = 6, t: float = 0.15) -> list[dict]:
    runs = lambda k: along_x(0.0, 2 * t * blocks, 2 * t if k % 2 == 0 else t, t)  # noqa: E731
    return courses(runs, n, t, (-t, 2 * t * blocks + t, -2 * t, 3 * t))


@pytest.mark.parametrize("azimuth", [90.0, 60.0])
def test_panel_turns_over_its_foot(azimuth):
    height, t = 6 * 0.15, 0.15
    case = tables(*panel(), friction=0.6, direction=towards(azimuth))
    assert load_of(case) == pytest.approx(t / height / math.sin(math.radians(azimuth)), rel=EXACT)


@pytest.mark.parametrize(("azimuth", "arm"), [(0.0, 1.0), (22.5, 1.0 / math.cos(math.pi / 8))])
def test_column_of_octagonal_drums(azimuth, arm):
    apothem, h, n = 0.4, 0.5, 4
    outline = regular(8, apothem)
    ground = box("ground", (-1.0, -1.0, -0.3), (1.0, 1.0, 0.0), fixed=True)
    drums = [prism(f"drum-{k}", outline, k * h, (k + 1) * h) for k in range(n)]
    case = tables(ground, *drums, friction=STICKS, direction=towards(azimuth))
    assert load_of(case) == pytest.approx(arm * apothem / (0.5 * n * h), rel=EXACT)


def twisted(a: float = 0.5, mu: float = 0.4) -> dict:
    """A cube on the ground under a couple about the vertical."""
    case = block_on_ground((a, a, a), friction=mu)
    pair = [((0.0, 0.5 * a, 0.5 * a), -1.0), ((a, 0.5 * a, 0.5 * a), 1.0)]
    loads = [{"block": "block", "force": [0.0, sign, 0.0], "at": list(at), "kind": "live"} for at, sign in pair]
    return {**case, "load": loads, "analysis": {"kind": "pushover", "pattern": "live", "max_load": 1e5}}


def test_block_twists_on_its_four_corners():
    """Points at the corners carry μ N a/√2 (uniform pressure 0.383 μ N a: the convention of the layout)."""
    a, mu = 0.5, 0.4
    weight = 2000.0 * 9.81 * a**3
    assert load_of(twisted(a, mu)) == pytest.approx(mu * weight * a / math.sqrt(2.0) / a, rel=3e-3)


def tapered_drums() -> dict:
    ground = box("ground", (-1.0, -1.0, -0.3), (1.0, 1.0, 0.0), fixed=True)
    radii = [0.40, 0.36, 0.32, 0.28]
    drums = [
        frustum(f"drum-{k}", regular(6, low), regular(6, high), 0.5 * k, 0.5 * (k + 1))
        for k, (low, high) in enumerate(zip(radii, radii[1:]))
    ]
    return tables(ground, *drums, friction=0.7, direction=towards(20.0))


@pytest.mark.parametrize("change", [quarter, mirrored])
def test_turned_and_mirrored(change):
    case = tapered_drums()
    assert load_of(change(case)) == pytest.approx(load_of(case), rel=RESOLUTION)


@pytest.mark.parametrize("axis", [0.0, 90.0, 30.0])
def test_tilting_table_about_any_axis(axis):
    """A block on a table that tilts stands until tan θ is the same load as pushed in that direction."""
    b, d, h = 0.6, 0.4, 1.0
    case = block_on_ground((b, d, h), friction=STICKS, direction=towards(axis))
    x, y, _ = np.abs(towards(axis))
    exact = min(b / h / max(x, 1e-9), d / h / max(y, 1e-9))
    assert load_of(case, pattern="tilt") == pytest.approx(exact, rel=EXACT)
