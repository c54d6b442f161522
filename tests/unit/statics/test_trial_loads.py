"""Which load is tried next: any exact load is bracketed, also where trials close to it stay undecided."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from dem_cli.core.engine.static_settings import LoadSearchSettings
from dem_cli.core.statics.trial_loads import TrialLoads

SETTINGS = LoadSearchSettings()


def trials(**options) -> TrialLoads:
    given = {"low": 0.0, "levels": [0.5, 0.8, 0.9], "step": 0.001, "resolution": 0.002} | options
    return TrialLoads(SETTINGS, **given)


def searched(wanted: TrialLoads, exact: float, dead_zone: float = 0.0, most: int = 200) -> list[float]:
    """The loads tried for a structure that fails beyond `exact`; nothing is proved within the dead zone about it."""
    tried = []
    while (load := wanted.next()) is not None:
        tried.append(load)
        assert len(tried) < most, tried
        if abs(load - exact) <= dead_zone:
            wanted.leaves(load)
        elif load < exact:
            wanted.carries(load)
        else:
            wanted.fails(load)
    return tried


@settings(max_examples=200, deadline=None)
@given(st.floats(0.01, 3.0), st.floats(0.3, 2.0))
def test_any_load_is_bracketed_as_closely_as_asked_for(exact, guess):
    wanted = trials(levels=[share * guess * exact for share in (0.5, 0.8, 0.9, 0.98)], step=0.001 * guess * exact)
    searched(wanted, exact)
    assert wanted.low <= exact <= wanted.high <= wanted.low * 1.002000001


@settings(max_examples=200, deadline=None)
@given(st.floats(0.1, 3.0), st.floats(0.5, 1.5), st.floats(1e-6, 2e-4))
def test_a_load_that_stays_undecided_is_gone_round(exact, guess, dead_zone):
    """Trials within 2e-4 of the failure load never end: the bracket closes about them all the same."""
    wanted = trials(levels=[share * guess * exact for share in (0.5, 1.0 - 0.0012, 1.0)], step=0.001 * guess * exact)
    searched(wanted, exact, dead_zone * exact)
    assert wanted.low <= exact <= wanted.high
    assert wanted.closed


def test_after_a_short_jump_the_load_right_below_the_failure_is_next():
    """The bracket of halving, in two trials instead of five; where that one fails as well, halving goes on."""
    levels = {"levels": [0.5, 0.98, 0.9988]}
    tried = searched(trials(**levels), 0.9987)
    assert tried == [0.5, 0.98, 0.9988, 0.997625, 0.9988]
    wrong = trials(**levels)
    assert searched(wrong, 0.9955)[3:5] == [0.997625, 0.5 * (0.98 + 0.997625)]
    assert wrong.closed
    assert searched(trials(levels=[0.5, 0.9]), 0.6)[2] == 0.7  # a jump to what was not expected to fail is halved
    assert searched(trials(levels=[0.98], step=0.0188), 0.9987)[2] == 0.5 * (0.98 + 0.9988)


def test_a_wide_dead_zone_ends_in_a_wide_bracket_and_not_never():
    wanted = trials()
    tried = searched(wanted, 0.95, dead_zone=0.02)
    assert wanted.low <= 0.93
    assert len(wanted.undecided) <= SETTINGS.most_undecided + 1
    assert not wanted.closed
    assert len(tried) < 60


def test_a_failure_after_a_jump_is_tried_again_from_close_by():
    """What breaks under a jump of a tenth, and carries 2 % more when raised gently."""
    wanted, tried = trials(levels=[0.9, 1.0]), []
    while (load := wanted.next()) is not None:
        tried.append(load)
        gentle = load - wanted.low < 0.011
        if load <= (1.02 if gentle else 0.99):
            wanted.carries(load)
        else:
            wanted.fails(load)
    assert 1.0 in tried[1:]
    assert wanted.low <= 1.02 <= wanted.high


def test_nothing_is_tried_above_the_limit():
    wanted = trials(limit=0.6)
    assert searched(wanted, 2.0)[-1] == 0.6
    assert wanted.high is None
