"""The journal of finished runs: what a kill leaves, and when it is of no use."""

from __future__ import annotations

import pytest

from dem_cli.errors import UsageError
from dem_cli.results.output.resume.journal import Journal

WHAT = {"the case": "a", "the program": "b"}


def journal(folder, resume=False, what=WHAT):
    return Journal(folder, "out", what, resume)


def test_runs_come_back_exactly(tmp_path):
    with journal(tmp_path) as first:
        first.add((0, 1, 0.1 + 0.2), (True, 1.0 / 3.0, "", (1e-300, 2.0)))
        first.add((0, 2, 1.0), (None, None, "why", ()))
    with journal(tmp_path, resume=True) as second:
        assert second.known() == {
            (0, 1, 0.1 + 0.2): (True, 1.0 / 3.0, "", (1e-300, 2.0)),
            (0, 2, 1.0): (None, None, "why", ()),
        }
        assert second.count == 2


@pytest.mark.parametrize("cut", [1, 5, 20])
def test_a_line_cut_short_is_dropped_and_the_next_one_is_whole(tmp_path, cut):
    with journal(tmp_path) as first:
        first.add((0,), ("whole",))
        first.add((1,), ("cut short by a kill",))
    path = tmp_path / ".out.dem-runs"
    path.write_bytes(path.read_bytes()[:-cut])
    with journal(tmp_path, resume=True) as second:
        assert second.known() == {(0,): ("whole",)}
        second.add((2,), ("more",))
    with journal(tmp_path, resume=True) as third:
        assert third.known() == {(0,): ("whole",), (2,): ("more",)}


def test_a_changed_case_is_not_resumed_but_may_start_anew(tmp_path):
    with journal(tmp_path) as first:
        first.add((0,), (1,))
    changed = {"the case": "x", "the program": "b"}
    with pytest.raises(UsageError, match="cannot resume: the case changed"):
        journal(tmp_path, resume=True, what=changed)
    with journal(tmp_path, what=changed) as second:
        assert second.known() == {}


def test_runs_are_not_thrown_away_by_accident(tmp_path):
    with journal(tmp_path) as first:
        first.add((0,), (1,))
    with pytest.raises(UsageError, match="left 1 runs in"):
        journal(tmp_path)
    with journal(tmp_path, resume=True) as second:
        assert second.count == 1


def test_two_runs_cannot_write_the_same(tmp_path):
    with journal(tmp_path), pytest.raises(UsageError, match="another run"):
        journal(tmp_path, resume=True)


def test_nothing_stays_of_a_journal_without_runs_or_one_that_is_done(tmp_path):
    with journal(tmp_path):
        pass
    assert not list(tmp_path.iterdir())
    with journal(tmp_path) as done:
        done.add((0,), (1,))
        done.remove()
    assert not list(tmp_path.iterdir())


def test_a_line_that_the_disk_changed(tmp_path):
    with journal(tmp_path) as first:
        first.add((0,), ("whole",))
        first.add((1,), ("whole",))
    path = tmp_path / ".out.dem-runs"
    header, row, other = path.read_text().splitlines()
    path.write_text(f"{header}\n5\n{other}\n")
    with journal(tmp_path, resume=True) as second:
        assert second.known() == {(1,): ("whole",)}
    path.write_text(f"5\n{row}\n")
    with pytest.raises(UsageError, match="is damaged; delete it"):
        journal(tmp_path, resume=True)
