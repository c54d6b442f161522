"""Ctrl-C, kill -9, a full disk, a read-only folder: what is done is kept, or nothing has the final name."""

from __future__ import annotations

import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest
import synthetic.runs

from dem_cli.errors import UsageError
from dem_cli.results.output.reader import read

RUNS = Path(synthetic.runs.__file__)
ROOT = RUNS.parents[2]
pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals and limits of POSIX systems")


def hear_signals():
    """A test run in the background of a shell ignores Ctrl-C, and so would its children."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


def start(folder, mode, output=None, **options):
    """A `dem run` with a made-up solver, in a process of its own."""
    paths = os.pathsep.join((str(ROOT), str(ROOT / "tests")))
    env = {**os.environ, "PYTHONPATH": paths, **options.pop("env", {})}
    options.setdefault("preexec_fn", hear_signals)
    command = [sys.executable, str(RUNS), str(folder / "case.toml"), str(output or folder / "out"), mode]
    return subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=env,
        restore_signals=True,
        **options,
    )


def wait_for_frame(process, number):
    for line in process.stdout:
        if line.strip() == f"frame {number}":
            return
    pytest.fail(f"ended early: {process.stderr.read()}")


def finish(process):
    """Exit code and what was said on stderr."""
    _, said = process.communicate(timeout=60)
    return process.returncode, said


def names(folder):
    return sorted(path.name for path in folder.iterdir())


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_interrupted(tmp_path, number):
    process = start(tmp_path, "slow")
    wait_for_frame(process, 3)
    process.send_signal(number)
    code, said = finish(process)
    assert (code, said) == (130, "")
    results = read(tmp_path / "out")
    assert results.status == results.summary["status"] == "interrupted"
    assert len(results.frames) >= 4
    assert results.summary["reached"]["load"] == results.history["load"][-1]
    assert names(tmp_path) == ["case.toml", "out"]


def test_ctrl_c_twice_does_not_spoil_the_end(tmp_path):
    process = start(tmp_path, "slow")
    wait_for_frame(process, 1)
    for _ in range(5):
        process.send_signal(signal.SIGINT)
        time.sleep(0.002)
    code, said = finish(process)
    assert (code, said) == (130, "")
    assert read(tmp_path / "out").status == "interrupted"


def test_killed(tmp_path):
    process = start(tmp_path, "slow")
    wait_for_frame(process, 3)
    process.kill()
    assert finish(process)[0] == -signal.SIGKILL
    (hidden,) = tmp_path.glob(".out.dem-new-*")
    assert names(tmp_path) == [".out.dem-lock", hidden.name, "case.toml"]
    results = read(hidden)
    assert results.status == "running"
    assert len(results.frames) >= 4
    assert finish(start(tmp_path, "quick"))[0] == 0
    assert names(tmp_path) == ["case.toml", "out"]


def test_killed_at_any_moment_the_file_stays_readable(tmp_path):
    """But for the fraction of a millisecond in which tables are replaced: one kill of four may hit it."""
    numbers, readable = random.Random(1), 0
    for i in range(4):
        folder = tmp_path / str(i)
        folder.mkdir()
        process = start(folder, "huge")
        wait_for_frame(process, 2)
        time.sleep(numbers.uniform(0.0, 0.3))
        process.kill()
        finish(process)
        (hidden,) = folder.glob(".out.dem-new-*")
        assert "out" not in names(folder)
        try:
            results = read(hidden)
        except UsageError:
            continue
        readable += 1
        assert len(results.frames) >= 80
        assert results.frames[len(results.frames) - 1].positions.shape == (22, 2)
    assert readable >= 3


def test_killed_earlier_results_are_intact(tmp_path):
    assert finish(start(tmp_path, "quick"))[0] == 0
    before = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    process = start(tmp_path, "slow")
    wait_for_frame(process, 2)
    process.kill()
    finish(process)
    assert {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()} == before


@pytest.fixture
def small_disk(tmp_path):
    """A file system of 2 MB; only root can make one."""
    disk = tmp_path / "disk"
    disk.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", str(disk)]
    if os.geteuid() != 0 or shutil.which("mount") is None or subprocess.run(command, capture_output=True).returncode:
        pytest.skip("a small file system cannot be mounted here")
    yield disk
    subprocess.run(["umount", "-l", str(disk)], check=True)


def test_full_disk(small_disk):
    assert finish(start(small_disk, "quick", small_disk / "out")) == (0, "")
    before = (small_disk / "out" / "summary.json").read_bytes()
    new = small_disk / "new"
    code, said = finish(start(small_disk, "huge", new))
    assert said == f"error: cannot write results to {new}: no space left on the device\n"
    assert code == 3
    code, said = finish(start(small_disk, "huge", small_disk / "out"))
    assert code == 3
    assert names(small_disk) == ["case.toml", "out"]
    assert (small_disk / "out" / "summary.json").read_bytes() == before
    assert read(small_disk / "out").status == "ok"


def test_the_output_folder_is_a_full_disk(tmp_path, small_disk):
    code, said = finish(start(tmp_path, "huge", small_disk))
    assert said == f"error: cannot write results to {small_disk}: no space left on the device\n"
    assert code == 3
    assert names(small_disk) == []
    assert finish(start(tmp_path, "quick", small_disk)) == (0, "")
    assert read(small_disk).status == "ok"


def test_a_file_size_limit(tmp_path):
    """Stands in for a full disk where nothing can be mounted."""
    limit = 500_000
    process = start(tmp_path, "huge", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
    code, said = finish(process)
    assert said == f"error: cannot write results to {tmp_path / 'out'}: the file size limit is reached\n"
    assert code == 3
    assert names(tmp_path) == ["case.toml"]


@pytest.fixture
def open_folder():
    """A folder that every user can look into."""
    folder = Path(tempfile.mkdtemp())
    folder.chmod(0o755)
    yield folder
    (folder / "locked").chmod(0o755)
    shutil.rmtree(folder)


def test_a_read_only_folder(open_folder):
    (open_folder / "case.toml").touch(mode=0o666)
    (open_folder / "case.toml").chmod(0o666)
    locked = open_folder / "locked"
    locked.mkdir()
    locked.chmod(0o555)
    env = {"AS_USER": "65534"} if os.geteuid() == 0 else {}
    code, said = finish(start(open_folder, "quick", locked / "out", env=env))
    assert said == f"error: cannot write results to {locked / 'out'}: permission denied\n"
    assert code == 3
    assert names(locked) == []
