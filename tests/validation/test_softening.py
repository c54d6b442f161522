"""Thesis 7.5.5: friction of a sliding block that falls with its slip."""

from __future__ import annotations

import numpy as np
import pytest
from studies.chapter7 import softening


def test_friction_falls_as_the_law_says():
    slip, load, _ = softening.slid(softening.measure())
    # Rows are means over 8 µm of slip, and the fall of 0.372 takes 100 µm.
    np.testing.assert_allclose(load, softening.law(slip), atol=0.5 * 0.372 * 8 / 100)
    assert load[slip < 0.8e-3].mean() == pytest.approx(0.6, rel=1e-4)
    assert load[slip > 1.1e-3].mean() == pytest.approx(0.38 * 0.6, rel=1e-4)
    assert slip[load > 0.6 * (1 - 1e-4)].max() == pytest.approx(0.9e-3, abs=1e-5)
    assert slip[load < 0.38 * 0.6 * (1 + 1e-4)].min() == pytest.approx(1.0e-3, abs=1e-5)
