"""Suites of accelerograms by EN 1998-1 3.2.3.1.2, with motions whose spectra are known in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from dem_cli.case.tables.base_motion import ArtificialTable
from dem_cli.core.motion.eurocode import eurocode
from dem_cli.core.motion.eurocode_suites import meets, verdict
from dem_cli.core.motion.motion import Motion
from dem_cli.core.motion.pulses import SineWave
from dem_cli.core.motion.synthetic import suite

T1 = 0.5  # s


def table(**keys) -> ArtificialTable:
    given = {"spectrum": "EC8-1", "soil": "B", "ag": 2.0, "first_period": T1, "count": 3} | keys
    return ArtificialTable(**{key: value for key, value in given.items() if value is not None})


def met(motions, made) -> dict:
    return {clause.number: clause.met for clause in made.judged(motions)}


def step(amplitude: float) -> Motion:
    """Constant acceleration, to which an oscillator of any period of 0.1 s to 1 s answers with 1 + exp(−πξ/√(1−ξ²))."""
    return Motion(SineWave(amplitude, 1e-3, 50.0, 0.5 * np.pi))


STEP = 1.0 + np.exp(-0.05 * np.pi / np.sqrt(1.0 - 0.05**2))  # of the acceleration: 1.854


@pytest.mark.parametrize(("above", "fits"), [(1.002, True), (0.998, False)])
def test_the_mean_spectrum_for_five_per_cent_decides(above, fits):
    """90 % of the plateau, 2.5 × 1.2 × 2 m/s2, is the highest value that is compared."""
    amplitude = above * 0.9 * 2.5 * 2.4 / STEP
    found = met([step(amplitude)] * 3, table())
    assert found == {"(3)": True, "(4)a": True, "(4)b": True, "(4)c": fits}


def test_a_suite_for_another_damping_is_judged_for_five_per_cent():
    """For 20 % the spectrum is 0.63 of that for 5 %: a suite that fits it at 20 % is compared where the code says."""
    made = table(damping=0.2, ag=3.0)
    motions = [step(0.9 * 2.5 * 2.4 * above / STEP) for above in (0.95, 1.0, 1.06)]
    assert not met(motions, made)["(4)c"]  # ag of 3 m/s2
    assert met(motions, table(damping=0.2))["(4)c"]
    assert eurocode("EC8-1", "B", 2.0, 0.2)(0.3) == pytest.approx(0.6325 * 2.5 * 2.4, rel=1e-4)


def test_the_mean_peak_and_the_number_of_records():
    low, high = Motion(SineWave(2.3, 2.0, 20.0)), Motion(SineWave(2.49, 2.0, 20.0))
    assert not met([low, low, high], table())["(4)b"]  # 2.363 of 2.4 m/s2
    assert met([low, high, high], table())["(4)b"]  # 2.427
    assert not met([high, high], table())["(4)a"]
    assert not met([high] * 3, table(plateau=9.0))["(3)"]


def test_a_listed_spectrum_for_another_damping_is_not_judged():
    points = ((0.0, 1.0), (4.0, 1.0))
    keys = {"spectrum": points, "soil": None, "ag": None}
    strong = [step(2.0)] * 3
    assert meets(table(**keys).judged(strong)) is True
    found = table(**keys, damping=0.02).judged(strong)
    assert meets(found) is None
    assert "(4)c: the spectrum is for 2 %, that for 5 % is not given" in verdict(found)


def test_words_of_a_suite_that_was_made_for_it():
    made = table(count=7)
    found = made.judged([Motion(one) for one in suite(made.asked, 1)])
    assert verdict(found) == "meets EN 1998-1 3.2.3.1.2 (3), (4)a, (4)b, (4)c"
    fewer = made.judged([Motion(one) for one in suite(made.asked, 1)][:2])
    assert "DOES NOT MEET" in verdict(fewer)
    assert "(4)a: 2 records, at least 3 are required" in verdict(fewer)
