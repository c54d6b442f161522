"""Agreement of methods: which loads are said to differ, with made-up searches."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from dem_cli.core.statics.agreement import CREEP, PATH, PATH_OF_START, doubts, histories, load_range, percent, unique

RESOLUTION = 0.002


def search(path: float, finished: bool = True, bound: float = 1.0, slides: bool = False) -> SimpleNamespace:
    """A load of 0.36 raised from gravity, beside a path and the bound by limit analysis."""
    limits = SimpleNamespace(slides=slides, followed=True, path=SimpleNamespace(load=path, finished=finished))
    return SimpleNamespace(
        start={},
        found=True, low=0.36, high=0.3607, carried=0.36, wide=False, earlier=None, limits=limits, bound=bound,
        crept_beyond=False, crept=None, path_of_start=None, alone=False, peak_displacement=0.0017,
    )  # fmt: skip


def test_bound_of_joints_that_lock_is_no_history_beside_a_path_that_agrees():
    assert load_range(search(0.3602), RESOLUTION) is None
    assert load_range(search(0.3602, slides=True), RESOLUTION) is None


@pytest.mark.parametrize(("path", "finished"), [(0.30, False), (0.40, True)])
def test_bound_without_sliding_counts_where_no_path_agrees(path, finished):
    assert load_range(search(path, finished), RESOLUTION)["highest"] == 1.0


def test_path_that_ends_elsewhere_is_said():
    found = load_range(search(0.34, slides=True), RESOLUTION)
    assert (found["lowest"], found["highest"]) == (0.34, 0.36)


def test_path_that_a_search_began_at_is_no_second_history():
    begun_there = search(0.3602, slides=True)
    begun_there.start = {"kind": "path"}
    assert [(one.method, one.load) for one in histories(begun_there)] == [(PATH, 0.36)]
    assert load_range(begun_there, RESOLUTION) is None
    begun_there.crept_beyond, begun_there.crept, begun_there.scale = True, 0.4, 1.0
    assert [one.method for one in histories(begun_there)] == [PATH, CREEP]
    assert load_range(begun_there, RESOLUTION)["why"].startswith(
        "0.36 from the end of the zero-dilation path, at least 0.4"
    )


@pytest.mark.parametrize(
    ("path", "finished", "kind", "said"),
    [(0.317, False, "path", True), (0.3602, False, "path", False), (0.317, True, "path", False)],
)
def test_load_raised_beyond_an_unfinished_path_is_one_history_alone(path, finished, kind, said):
    raised = search(path, finished, slides=True)
    raised.start = {"kind": kind}
    assert any("no second history" in word for word in doubts(raised, RESOLUTION, None)) is said


def test_path_of_the_start_is_a_second_history_of_blocks_that_move():
    moving = search(0.3602)
    moving.limits, moving.bound, moving.path_of_start = None, None, 0.33
    assert histories(moving)[1].summary() == {"method": PATH_OF_START, "load": 0.33, "finished": True}
    found = load_range(moving, RESOLUTION)
    assert (found["lowest"], found["highest"]) == (0.33, 0.36)
    said = doubts(moving, RESOLUTION, found)[0]
    assert "0.33 by the zero-dilation path in the geometry of the start" in said
    assert "0.36 raised from gravity in steps (blocks have moved by 0.0017 m there)" in said
    moving.path_of_start = 0.3603
    assert load_range(moving, RESOLUTION) is None


def test_shares_are_written_in_full():
    """A bracket of 100 % was "1e+02 %"."""
    assert [percent(share) for share in (0.00184, 0.02, 0.994, 0.996, 1.07, -3.0)] == [
        "0.18 %", "2 %", "99 %", "100 %", "107 %", "-300 %",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("bracket", "none_slides", "expected"),
    [
        ((0.36, 0.3607), True, True),
        ((0.36, 0.3607), False, False),  # some mechanism of the bound slides
        ((0.3611, 0.3618), True, False),  # above the bound
        ((0.35, 0.3507), True, False),  # fails below it
        ((0.3593, 0.36), True, True),  # at its edge
        ((0.36, None), True, False),
    ],
)
def test_no_other_load_is_possible_where_the_bracket_holds_the_bound_and_nothing_slides(bracket, none_slides, expected):
    asked = search(0.36, bound=0.3602 if bracket[0] != 0.3593 else 0.36)
    asked.low, asked.high = bracket
    asked.limits.none_slides = none_slides
    assert unique(asked) is expected


def test_a_load_of_blocks_that_move_with_no_second_history_says_so():
    """A herringbone wall in space ended 7 % above the load of its fixed geometry, and its run had no warning."""
    moving = search(0.3602)
    moving.limits, moving.bound = None, None
    assert doubts(moving, RESOLUTION, None) == []
    moving.alone = "the zero-dilation path in the geometry of the start was not followed to its end"
    assert doubts(moving, RESOLUTION, None)[0].startswith("no second history says whether others end lower")
