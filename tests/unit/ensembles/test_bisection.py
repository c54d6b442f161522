"""The search between what stands and what fails, on functions whose change is known."""

from __future__ import annotations

import pytest

from dem_cli.analyses.ensembles.bisection import Ends, Scale, changes, first_change, search

FACTORS = Scale(0.05, 20.0, ratio=True)


class Asked:
    """Counts the values that are tried; stands below a limit, or above it."""

    def __init__(self, limit: float, above: bool = False):
        self.limit, self.above, self.values = limit, above, []

    def __call__(self, value: float) -> bool:
        self.values.append(value)
        return (value > self.limit) == self.above


@pytest.mark.parametrize("limit", [0.07, 0.6, 0.999, 1.4, 2.4, 19.0])
def test_factors_from_one_outwards(limit):
    asked = Asked(limit)
    stands, fails = search(asked, FACTORS, 0.002, None, 0, 1.0)
    assert stands <= limit < fails <= 1.002 * stands * (1 + 1e-9)
    assert len(asked.values) < 16


@pytest.mark.parametrize(("limit", "end"), [(30.0, Ends(20.0, None)), (0.01, Ends(None, 0.05))])
def test_no_change_in_the_range(limit, end):
    assert search(Asked(limit), FACTORS, 0.002, None, 0, 1.0) == end
    assert search(Asked(limit), FACTORS, 0.002, None, 5, 1.0) == end


@pytest.mark.parametrize("off", [0.0, 0.0005, -0.03, 0.1, -0.6])
@pytest.mark.parametrize("above", [False, True])
def test_guesses_good_and_bad(off, above):
    """A good guess takes two values, a bad one is left behind."""
    scale, asked = Scale(0.5, 4.0, ratio=False), Asked(1.7, above)
    near, far = 1.7 * (1 + off) * 0.9999, 1.7 * (1 + off) * 1.0001
    guess = Ends(far, near) if above else Ends(near, far)
    stands, fails = search(asked, scale, 0.002, guess, 0, None)
    low, high = sorted((stands, fails))
    assert low <= 1.7 <= high <= 1.0021 * low
    assert asked(stands)
    assert not asked(fails)
    assert off or len(asked.values) == 4


def test_whole_numbers_end_next_to_each_other():
    for limit in (2, 7, 11, 28):
        found = search(Asked(limit + 0.5), Scale(1.0, 30.0, False, whole=True), 0.002, None, 0, None)
        assert found == Ends(float(limit), float(limit + 1))
        guess = Ends(10.0, 11.0)
        assert search(Asked(limit + 0.5), Scale(1.0, 30.0, False, whole=True), 0.002, guess, 0, None) == found


def test_the_change_next_to_the_end_that_stands():
    """Stands, fails, stands, fails: the first failure counts."""

    def stands(value: float) -> bool:
        return value < 2.0 or 3.0 < value < 4.0

    found = search(stands, Scale(1.0, 5.0, ratio=False), 0.001, None, 16, None)
    assert found.stands == pytest.approx(2.0, rel=0.001)
    assert found.fails >= 2.0
    mirrored = search(lambda value: stands(6.0 - value), Scale(1.0, 5.0, ratio=False), 0.001, None, 16, None)
    assert mirrored.stands == pytest.approx(4.0, rel=0.001)
    assert first_change([(1.0, False), (2.0, True), (3.0, False)]) == Ends(2.0, 1.0)
    assert changes({1.0: True, 3.0: True, 2.0: False}) == 2


def test_values_around_nothing():
    """A resolution relative to nothing would never be reached."""
    asked = Asked(0.0)
    found = search(asked, Scale(-1.0, 1.0, ratio=False), 0.002, None, 0, None)
    assert found.stands <= 0.0 < found.fails
    assert len(asked.values) < 25
