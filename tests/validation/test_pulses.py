"""Published pulse tests of a column and an arch of voussoirs, by other discrete element programs; see docs/pulses.md.

Tolerances are those of the comparison: their damping (column) and the exact areas of their contact points (arch) are
not known.
"""

from __future__ import annotations

import numpy as np
import pytest
from oracle import maxwell, tapered_column
from reference import result, value
from studies.pulses import column, domain, voussoirs

COLUMN, ARCH = "dimitri_column_arch", "lemos_arch_pulse"
UDEC = dict(zip(result(COLUMN, "col_domain_udec")["tp_s"], result(COLUMN, "col_domain_udec")["value"], strict=True))


@pytest.fixture(scope="module")
def shaker():
    return domain.Shaker(domain.table_of(column.CASE), domain.DAMPINGS[column.MAIN], column.LASTS, column.MARGIN)


def test_static_load_of_the_column():
    """Half the foot over the height of the centroid, as `drum_column` without a cap; 0.3 %."""
    block, _ = tapered_column.block()
    assert np.tan(block.alpha) == pytest.approx(value(COLUMN, "col_static"), abs=5e-5)
    assert np.mean(column.static()["bracket"]) == pytest.approx(value(COLUMN, "col_static"), rel=3e-3)


@pytest.mark.parametrize("tp", [0.15, 0.2, 0.25, 0.3, 0.32])
def test_overturning_while_it_is_pushed(shaker, tp):
    """UDEC's least amplitude within 5 %; damping hardly matters."""
    assert not shaker.falls(0.95 * UDEC[tp], tp)
    assert shaker.falls(1.05 * UDEC[tp], tp)


@pytest.mark.parametrize("tp", [0.4, 0.5, 0.6, 0.8, 1.0])
def test_overturning_after_impact(shaker, tp):
    """UDEC's least amplitude within 12 %: damping, which is not known, matters."""
    assert not shaker.falls(0.88 * UDEC[tp], tp)
    assert shaker.falls(1.12 * UDEC[tp], tp)


def test_it_falls_to_the_other_side_after_impact():
    """Above the jump it falls to the side of the first push, below it to the other."""
    case, damping = domain.table_of(column.CASE), domain.DAMPINGS[column.MAIN]
    sides = [
        domain.way_of_falling(case, damping, amplitude, tp, column.MARGIN)["side"]
        for amplitude, tp in ((0.95, 0.3), (0.35, 0.4))
    ]
    assert sides == [-1, 1]


def test_overturning_is_not_monotone(shaker):
    """At tp = 0.37 s it falls after impact, stands at more, and falls at once at still more."""
    assert [shaker.falls(amplitude, 0.37) for amplitude in (0.30, 0.42, 0.58, 0.75)] == [False, True, False, True]


@pytest.mark.parametrize(
    ("name", "peak", "time"),
    [("elastic_s5", 0.03, 0.02), ("elastic_mx5", 0.05, 0.03), ("s5", 0.02, 0.02), ("mx5", 0.08, 0.03)],
)
def test_arch_under_a_half_sine(name, peak, time):
    """3DEC's peaks and their times, to both sides; that to the other side with Maxwell elements changes by 3 % with the
    time step.
    """
    found, book = voussoirs.peaks(voussoirs.run(name)), result(ARCH, f"pulse_{name}")
    theirs = np.atleast_1d(book["value"])
    assert found["values"][: len(theirs)] == pytest.approx(theirs, rel=peak)
    assert found["times"][: len(theirs)] == pytest.approx(np.atleast_1d(book["time_s"]), rel=time)
    assert abs(found["closure"]) < 1e-3


def test_elastic_arch_swings_as_published():
    """After the pulse, read from 3DEC's series: 11.08 Hz, 5.05 %. Ours is 1.5 % lower, so a little less damped."""
    found = voussoirs.free()
    first = voussoirs.frequencies(domain.table_of(voussoirs.ELASTIC))[0]
    assert first == pytest.approx(11.08, rel=0.02)
    assert found["elastic_s5"]["frequency"] == pytest.approx(first, rel=5e-3)
    assert found["elastic_s5"]["ratio"] == pytest.approx(0.05 * first / 11.0, rel=0.02)
    ratio, frequency = maxwell.of_mode(first)
    assert found["elastic_mx5"]["frequency"] == pytest.approx(frequency, rel=5e-3)
    assert found["elastic_mx5"]["ratio"] == pytest.approx(ratio, rel=0.05)


def test_three_maxwell_elements_damp_5_percent_over_two_decades():
    """0.0385 at 1 Hz, 0.0335 at 7.1 Hz, 0.052 at 50 Hz: within a fifth of 5 % from 1 to 50 Hz."""
    found = [maxwell.of_mode(f)[0] for f in np.geomspace(1.0, 50.0, 25)]
    assert min(found) > 0.04
    assert max(found) < 0.06
    ratio, frequency = maxwell.of_mode(3.0, [(0.02, 3.0)])
    assert ratio == pytest.approx(0.02, rel=0.03)
    assert frequency > 3.0
    assert maxwell.stiffness(3.0, [(0.02, 3.0)]).imag == pytest.approx(0.04, rel=1e-12)
