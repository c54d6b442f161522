"""Forces in cuts of time histories: mass times acceleration of what is beyond, with all that joints are damped by."""

from __future__ import annotations

import engine
import numpy as np
import pytest
from engine import block, rectangle, tables

from dem_cli.analyses.ensembles.shaken_run import RestedStructure
from dem_cli.analyses.ensembles.variants import Variant
from dem_cli.errors import CaseError
from dem_cli.masonry.assembly.ground_motions import motions_of

G, DENSITY, WIDTH, HEIGHT, COUNT = 9.81, 2000.0, 0.8, 0.4, 3
MASS = DENSITY * WIDTH * HEIGHT  # of one block, 1 m deep
AMPLITUDE, FREQUENCY = 0.5, 0.5  # m/s², 1/s: none slides or rocks, and joints of 1e11 Pa/m are rigid for it
VISCOUS = {"contact_fraction": 0.3, "maxwell": [{"ratio": 0.05, "frequency": 20.0}]}


def column(dimension: int, **more) -> dict:
    """Three blocks on a shaken base; N, V and M above the base and above the first block, then all accelerations."""
    shapes = [("base", -2.0, 2.0, -1.0, 0.0)]
    shapes += [(f"b{k}", 0.0, WIDTH, k * HEIGHT, (k + 1) * HEIGHT) for k in range(COUNT)]
    drawn = []
    for name, left, right, low, high in shapes:
        corners = rectangle(left, low, right, high)
        if dimension == 3:
            corners = [[x, y, z] for x, z in corners for y in (-0.5, 0.5)]
        drawn.append(block(name, corners, **({"fixed": True} if name == "base" else {})))
    monitors = []
    for y in (0.0, HEIGHT):
        cut = [[-0.1, y], [WIDTH + 0.1, y]]
        if dimension == 3:
            cut = [[-0.1, -0.6, y], [WIDTH + 0.1, -0.6, y], [WIDTH + 0.1, 0.6, y], [-0.1, 0.6, y]]
        monitors += [{"cut": cut, "quantity": name} for name in ("normal_force", "shear_force", "moment")]
    monitors += [
        {"block": f"b{k}", "quantity": "acceleration", "component": axis, "absolute": True}
        for axis in ("x", "y" if dimension == 2 else "z")
        for k in range(COUNT)
    ]
    case = {
        "joints": {"dry": {"friction": 0.6, "kn": 1e11}}, "analysis": {"kind": "time-history"},
        "motion": {"kind": "pulse", "shape": "sine", "amplitude": AMPLITUDE, "frequency": FREQUENCY},
        "output": {"frames": 0, "rate": 50.0},
    } | more  # fmt: skip
    return tables(*drawn, dimension=dimension, monitor=monitors, **case)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_rigid_stack_carries_mass_times_acceleration(dimension):
    """N = m g, V = −m a along the cut, M = −m a h: h is that of the mass beyond above the cut."""
    found, records = engine.solve(column(dimension))
    assert found["status"] == "ok"
    samples = records.history
    ground = samples.base[:, 0, 0]
    assert np.abs(ground).max() == pytest.approx(AMPLITUDE, rel=1e-3)
    for first, above in ((0, 3), (3, 2)):
        normal, shear, moment = samples.monitors[:, first : first + 3].T
        mass, arm = above * MASS, 0.5 * above * HEIGHT
        near = {"abs": 2e-3 * mass * AMPLITUDE}
        assert normal == pytest.approx(np.full(len(normal), mass * G), rel=1e-3)
        assert shear == pytest.approx(-mass * ground, **near)
        assert moment == pytest.approx(-mass * ground * arm, **near)


@pytest.mark.parametrize("damping", [{}, VISCOUS])
def test_dashpots_are_part_of_what_a_cut_carries(damping):
    """On soft joints V and N are sums of mass times acceleration, sample by sample, to round-off.

    But for the first sample, at which the acceleration of the base jumps.
    """
    shaken = {"motion": {"kind": "pulse", "shape": "impulse", "amplitude": 3.0, "duration": 0.05}}
    more = {"damping": damping or {"none": True}}
    case = column(
        2, joints={"dry": {"friction": 0.6, "kn": 3e7}}, output={"frames": 0, "rate": 400.0}, **shaken, **more
    )
    _, records = engine.solve(case)
    samples = records.history
    monitors = samples.monitors[1:]
    along, up = monitors[:, 6:9], monitors[:, 9:12]
    for first, beyond in ((0, slice(0, 3)), (3, slice(1, 3))):
        normal, shear = monitors[:, first], monitors[:, first + 1]
        near = {"abs": 1e-8 * COUNT * MASS * G}
        assert np.abs(shear).max() > 0.1 * MASS * G
        assert shear == pytest.approx(-MASS * along[:, beyond].sum(axis=1), **near)
        assert normal == pytest.approx(MASS * (G + up[:, beyond]).sum(axis=1), **near)


def test_runs_of_ensembles_have_the_same_peaks():
    """What repeats and fragility ask for: the largest V and M of the run alone."""
    case = column(2)
    found, records = engine.solve(case)
    each = np.array([samples.extremes for samples in records.stretches])
    ends = np.abs(each[:, :, [0, 2]])
    peaks = np.where(np.isfinite(ends), ends, 0.0).max(axis=(0, 2))  # stretches without a sample have none
    made = engine.scene(case)
    records_of_case = motions_of(made.case)
    rested = RestedStructure(Variant(made.case, made.model, 0), records_of_case, engine.Records())
    run = rested.shaken(records_of_case)
    assert found["status"] == "ok"
    assert run.peaks[1] > 0.9 * COUNT * MASS * AMPLITUDE
    assert np.array(run.peaks[:6]) == pytest.approx(peaks[:6], rel=1e-6)


def test_modes_have_no_forces_in_cuts():
    """Only what happens in time or at rest has forces."""
    with pytest.raises(CaseError, match="normal_force"):
        engine.scene(column(2, analysis={"kind": "modes"}))
