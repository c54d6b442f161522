"""Blocks that slide or bounce, against closed forms; the books of energy of a column. More is in docs/rocking.md."""

from __future__ import annotations

import numpy as np
import pytest
from casefiles import CASES
from oracle.base_motion import pulse
from oracle.newmark_slider import Slope, slide
from studies.rocking import single_block, sliding

DAMPING = {"contact_fraction": 0.35}


@pytest.mark.parametrize("name", sliding.SLIDES)
def test_newmarks_slider(name):
    """Final slip within 0.5 %; of a block that comes back, of its way."""
    found = sliding.sliding(name, damping=DAMPING)
    scale = abs(found["exact"]) if "comes back" not in name else found["path"]
    assert abs(found["slip"] - found["exact"]) < 0.005 * scale


def test_case_of_sliding():
    exact = slide(Slope(0.2), pulse(9.0, 1.0), 2.0).final
    assert exact == pytest.approx(-0.38063, abs=1e-5)
    found = single_block.solve_file(CASES / "verification" / "sliding_pulse.toml")
    assert found.values[-1, 0] == pytest.approx(exact, rel=0.005)


def test_bounce_without_dashpot():
    """Heights within 0.5 % at a fifth of the default step, and the better the smaller the step."""
    coarse, fine = (
        sliding.bounce(output={"rate": 50_000.0}, analysis={"margin": margin, "duration": 0.7}) for margin in (0.5, 0.1)
    )
    assert np.abs(fine["heights"]).max() < 0.005
    assert abs(fine["time"]) < 1e-3
    assert abs(fine["overlap"]) < 0.002
    assert np.abs(coarse["heights"]).max() > np.abs(fine["heights"]).max()


def test_case_of_the_bouncing_block():
    found = single_block.solve_file(CASES / "verification" / "bouncing_block.toml")
    times, sizes = found.extremes()
    up = np.array([found.at(t) > 0.0 for t in times])
    assert times[up][0] == pytest.approx(0.20292, rel=1e-3)
    assert sizes[up][:2] == pytest.approx(0.05, rel=0.005)


def test_energy_closure_is_of_second_order(tmp_path):
    """Half the step, a quarter of the error or less: a column of 8 blocks that rocks for 20 s, mean of two records."""
    errors = [
        np.sqrt(np.mean([sliding.column(tmp_path, margin, seed, damping=DAMPING) ** 2 for seed in (0, 3)]))
        for margin in (0.5, 0.25)
    ]
    assert np.log2(errors[0] / errors[1]) > 1.5
    assert errors[1] < 2e-3
