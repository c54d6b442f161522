"""Work in processes: results, deaths, a caller that stops."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from dem_cli.app.sweep.pool import WorkerDeath, each_done

ROOT = Path(__file__).resolve().parents[3]


def square_or_die(task: tuple[int, str]) -> int:
    number, what = task
    if what:
        flag = Path(what)
        if not flag.exists():  # the first time only
            flag.write_text("")
            os.kill(os.getpid(), signal.SIGKILL)
        if flag.name == "always":
            os.kill(os.getpid(), signal.SIGKILL)
    return number * number


def fail(number: int) -> int:
    if number == 2:
        raise ValueError("two")
    return number


@pytest.mark.parametrize("jobs", [1, 2])
def test_every_result_comes_once(jobs):
    found = list(each_done(square_or_die, [(n, "") for n in range(20)], jobs, first_alone=True))
    assert sorted(found) == [(n, n * n) for n in range(20)]


def test_a_death_is_tried_again_and_stops_nobody(tmp_path):
    tasks = [(n, "") for n in range(12)]
    tasks[3] = (3, str(tmp_path / "once"))
    tasks[7] = (7, str(tmp_path / "always"))
    found = dict(each_done(square_or_die, tasks, 2))
    assert isinstance(found.pop(7), WorkerDeath)
    assert found == {n: n * n for n in range(12) if n != 7}


def test_an_error_of_the_function_comes_to_the_caller():
    with pytest.raises(ValueError, match="two"):
        list(each_done(fail, [1, 2, 3, 4, 5], 2))


PARENT = """
import sys, time
from dem_cli.app.sweep.pool import each_done
def sleep_long(n):
    import os
    print(os.getpid(), flush=True)
    time.sleep(60)
if __name__ == "__main__":
    list(each_done(sleep_long, [1, 2, 3], 2))
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="looks at processes as POSIX has them")
def test_children_leave_with_a_parent_that_is_killed(tmp_path):
    script = tmp_path / "parent.py"
    script.write_text(PARENT)
    parent = subprocess.Popen(
        [sys.executable, str(script)], stdout=subprocess.PIPE, text=True, env=os.environ | {"PYTHONPATH": str(ROOT)}
    )
    assert parent.stdout is not None
    children = [int(parent.stdout.readline()) for _ in range(2)]
    parent.kill()
    parent.wait()
    parent.stdout.close()
    deadline = time.monotonic() + 20.0
    while time.monotonic() < deadline and any(map(is_alive, children)):
        time.sleep(0.05)
    assert not any(map(is_alive, children))


def is_alive(process: int) -> bool:
    """Whether a process runs (one that waits to be buried by its parent does not)."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False
