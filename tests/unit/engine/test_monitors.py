"""Monitors against motion that is known in closed form: a block that turns about a corner on a base that moves."""

from __future__ import annotations

import numpy as np
import pytest

from dem_cli.app.api import build_model, load_case
from dem_cli.core.engine.monitors import Monitors
from dem_cli.masonry.assembly.solver_request import solver_request

CASE = """
[materials.stone]
density = 2000.0
[joints.dry]
friction = 0.6
[[structure]]
kind = "column"
courses = 1
block = [0.4, 1.2]
id = "c"
origin = [{far}, 0.0]
"""
FAR = 1e5
TIMES = np.linspace(0.0, 1.0, 401)
STEP = TIMES[1]


def monitored(tmp_path, tables: str, far: float = 0.0) -> Monitors:
    path = tmp_path / "case.toml"
    path.write_text(CASE.format(far=far) + tables, encoding="utf-8")
    loaded = load_case(path)
    return Monitors(solver_request(loaded.case).monitors, build_model(loaded))


def rocking(monitors: Monitors, angle, spin, change, slide=0.0) -> np.ndarray:
    """Samples of the block, turned by `angle` about its lower right corner, which slid by `slide` on the base."""
    model = monitors.model
    samples = np.zeros((len(angle), len(monitors.watched), 3, 3))
    samples[:, :, 0, :2] = model.centroids[monitors.watched] - monitors.origin
    row = list(monitors.watched).index(int(np.flatnonzero(~model.fixed)[0]))
    arm = np.array([-0.2, 0.6])  # from the corner to the centroid
    c, s = np.cos(angle), np.sin(angle)
    turned = np.stack([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]], axis=1)
    across = np.stack([-turned[:, 1], turned[:, 0]], axis=1)
    samples[:, row, 0, :2] += turned - arm + np.stack([np.full(len(angle), slide), np.zeros(len(angle))], axis=1)
    samples[:, row, 1, :2] = spin[:, None] * across
    samples[:, row, 2, :2] = change[:, None] * across - spin[:, None] ** 2 * turned
    samples[:, row, :, 2] = np.stack([angle, spin, change], axis=1)
    return samples


ANGLE = -0.3 * np.sin(3.0 * TIMES) ** 2
SPIN = -0.9 * np.sin(6.0 * TIMES)
CHANGE = -5.4 * np.cos(6.0 * TIMES)
BASE = np.stack([np.stack([k * TIMES**2, -k * TIMES], axis=1) for k in (1.0, 2.0, 3.0)], axis=1)


@pytest.mark.parametrize("far", [0.0, FAR])
def test_a_corner_that_the_block_turns_about_is_at_rest(tmp_path, far):
    quantities = ("displacement", "velocity", "acceleration")
    tables = [f"[[monitor]]\npoint = [{far + 0.2}, 1e-6]\nquantity = '{quantity}'\n" for quantity in quantities]
    monitors = monitored(tmp_path, "".join(tables), far)
    found = monitors.series(rocking(monitors, ANGLE, SPIN, CHANGE), BASE)
    assert found.shape == (401, 3)
    np.testing.assert_allclose(found, 0.0, atol=1e-5)  # 1e-6 m above the corner


def test_velocity_and_acceleration_are_the_derivatives_of_displacement(tmp_path):
    tables = "".join(
        f"[[monitor]]\npoint = [-0.2, 1.2]\nquantity = '{quantity}'\ncomponent = '{component}'\n"
        for component in "xy"
        for quantity in ("displacement", "velocity", "acceleration")
    )
    monitors = monitored(tmp_path, tables)
    found = monitors.series(rocking(monitors, ANGLE, SPIN, CHANGE), BASE)
    for place in (0, 3):
        np.testing.assert_allclose(np.gradient(found[:, place], STEP)[1:-1], found[1:-1, place + 1], atol=3e-4)
        np.testing.assert_allclose(np.gradient(found[:, place + 1], STEP)[1:-1], found[1:-1, place + 2], atol=3e-3)
    arm = np.array([-0.4, 1.2])  # from the corner
    x = np.cos(ANGLE) * arm[0] - np.sin(ANGLE) * arm[1] - arm[0]
    np.testing.assert_allclose(found[:, 0], x, atol=1e-14)


def test_absolute_adds_the_motion_of_the_base(tmp_path):
    tables = "".join(
        f"[[monitor]]\nblock = 'c-1'\nquantity = '{quantity}'\ncomponent = 'y'\nabsolute = {flag}\n"
        for quantity in ("acceleration", "velocity", "displacement")
        for flag in ("true", "false")
    )
    monitors = monitored(tmp_path, tables)
    found = monitors.series(rocking(monitors, ANGLE, SPIN, CHANGE), BASE)
    np.testing.assert_allclose(found[:, ::2] - found[:, 1::2], BASE[:, :, 1], atol=1e-13)


@pytest.mark.parametrize("between", ["['c-base', 'c-1']", "['c-1', 'c-base']"])
def test_opening_and_slip_of_the_joint(tmp_path, between):
    tables = "".join(f"[[monitor]]\nbetween = {between}\nquantity = '{q}'\n" for q in ("opening", "slip"))
    monitors = monitored(tmp_path, tables)
    samples = rocking(monitors, ANGLE, SPIN, CHANGE, slide=0.05)
    opening, slip = monitors.series(samples, BASE).T
    if between.startswith("['c-base"):  # frame of the ground: the far corner rises by b sin φ, the middle slides back
        np.testing.assert_allclose(opening, 0.4 * np.sin(-ANGLE), atol=1e-14)
        np.testing.assert_allclose(slip, -(0.05 + 0.2 * (1 - np.cos(ANGLE))), atol=1e-14)
    else:  # frame of the block: its left corner is 0.45 m from where the base was below it
        np.testing.assert_allclose(opening, 0.45 * np.sin(-ANGLE), atol=1e-14)
        assert slip[0] == pytest.approx(-0.05)


def test_a_joint_that_is_pressed_has_a_negative_opening(tmp_path):
    monitors = monitored(tmp_path, "[[monitor]]\nbetween = ['c-base', 'c-1']\nquantity = 'opening'\n")
    samples = rocking(monitors, np.zeros(1), np.zeros(1), np.zeros(1))
    samples[0, -1, 0, 1] -= 1e-5
    assert monitors.series(samples, BASE[:1])[0, 0] == pytest.approx(-1e-5)
    assert monitors.series(samples[:0], BASE[:0]).shape == (0, 1)


def test_without_monitors_nothing_is_watched(tmp_path):
    monitors = monitored(tmp_path, "")
    assert monitors.watched.tolist() == []
    assert monitors.series(np.zeros((5, 0, 3, 3)), BASE[:5]).shape == (5, 0)
