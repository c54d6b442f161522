"""Records survive the way through JSON; other files are refused."""

from __future__ import annotations

import json

import pytest
from bench import timing
from bench.record import GroupResult, as_json, group_table, read, record, records_of
from bench.timing import TimedTask, in_turn

from dem_cli.errors import UsageError


def test_records_come_back_from_json(tmp_path):
    found = GroupResult([record("T21", "resolution", 0.002, [0.3, 0.1, 0.2], load=0.6, error=None)], ["a note"])
    path = tmp_path / "benchmarks.json"
    path.write_text(as_json({"precision": group_table(found, {"cores": 2})}), encoding="utf-8")
    group = read(path)["precision"]
    assert records_of(group) == found.records
    assert (group["machine"], group["notes"]) == ({"cores": 2}, ["a note"])
    assert (found.records[0].best, found.records[0].median, found.records[0].repeats) == (0.1, 0.2, 3)


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"format": 0, "groups": {}}'])
def test_other_files_are_refused(tmp_path, text):
    path = tmp_path / "benchmarks.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(UsageError, match=r"benchmarks\.json"):
        read(path)


def test_no_number_that_json_lacks():
    with pytest.raises(ValueError):
        as_json({"precision": group_table(GroupResult([record("a", "b", 1, [float("nan")])]), {})})
    assert json.loads(as_json({}))["groups"] == {}


def test_jobs_take_turns_and_the_long_ones_run_once():
    order = []
    jobs = [TimedTask(lambda name=name: order.append(name) or name) for name in "abc"]
    jobs[1].once()
    jobs[1].seconds[0] = 100.0
    in_turn(jobs, rounds=2)
    assert order == ["b", "a", "c", "a", "c"]
    assert [len(job.seconds) for job in jobs] == [2, 1, 2]
    assert jobs[0].result == "a"


def test_preparation_is_off_the_clock(monkeypatch):
    now = [0.0]
    monkeypatch.setattr(timing.time, "process_time", lambda: now[0])

    def pass_time(seconds):
        now[0] += seconds

    job = TimedTask(lambda: pass_time(2.0), prepare=lambda: pass_time(50.0))
    in_turn([job], rounds=3)
    assert job.seconds == [2.0, 2.0, 2.0]
