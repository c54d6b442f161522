"""Jobs on a Dask cluster: one that kills its workers is found out, and its neighbours are not blamed."""

from __future__ import annotations

import os
import struct
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from dem_cli.app.cli.main import main
from dem_cli.app.sweep.cluster import connected, doubt
from dem_cli.errors import UsageError

ROOT = Path(__file__).resolve().parents[3]
SCRIPT = """
import os, signal
from pathlib import Path
from typing import NamedTuple

class Job(NamedTuple):
    id: str
    number: int

def work(job):
    if job.number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return {"number": job.number}

if __name__ == "__main__":
    import deadly
    from dask.distributed import LocalCluster
    from dem_cli.app.sweep.cluster import connected, on_cluster

    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, host="127.0.0.1") as cluster:
        with connected(cluster.scheduler_address, Path(".")) as client:
            for number, result in on_cluster(client, deadly.work, [deadly.Job(f"job-{n}", n) for n in range(6)]):
                print("result", number, result["number"] if isinstance(result, dict) else type(result).__name__)
"""


@pytest.mark.parametrize(
    ("address", "alone"),
    [
        ("tcp://127.0.0.1:8786", True),
        ("localhost:8786", True),
        ("tcp://[::1]:8786", True),
        ("tls://head:8786", True),
        ("inproc://10.0.0.5/1/1", True),
        ("tcp://head:8786", False),
        ("tcp://10.0.0.5:8786", False),
        ("0.0.0.0:8786", False),
        ("ws://head:80/x", False),
    ],
)
def test_a_scheduler_that_others_may_reach_is_doubted(address, alone):
    assert (doubt(address) is None) is alone


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (MemoryError("Unable to allocate 3.07 EiB"), "Unable to allocate 3.07 EiB"),
        (
            struct.error("unpack_from requires a buffer of at least 8 bytes"),
            "unpack_from requires a buffer of at least",
        ),
        (OSError("in a stream\nof two lines"), "in a stream)"),
        (TimeoutError(), "TimeoutError"),
    ],
    ids=["length", "end", "lines", "nothing"],
)
def test_servers_that_are_no_scheduler(monkeypatch, error, said):
    """Dask takes what a web server says, such as its dashboard, for lengths: want of memory, or a fault of dem."""

    def client(*_, **__):
        raise error

    monkeypatch.setattr(pytest.importorskip("dask.distributed"), "Client", client)
    with pytest.raises(UsageError) as refused, connected("tcp://127.0.0.1:8787", Path()):
        pass
    assert str(refused.value).startswith(f"--scheduler tcp://127.0.0.1:8787: no Dask scheduler answers ({said}")


def test_a_sweep_says_so(tmp_path, monkeypatch):
    def away(address, folder):
        raise UsageError("no scheduler")

    monkeypatch.setattr("dem_cli.app.sweep.cluster.connected", away)
    (tmp_path / "case.toml").write_text(CliRunner().invoke(main, ["new", "sweep"]).stdout, encoding="utf-8")
    words = ["sweep", str(tmp_path / "case.toml"), "-q", "-o", str(tmp_path / "out"), "--scheduler", "tcp://head:8786"]
    said = CliRunner().invoke(main, words).stderr
    assert "warning: --scheduler tcp://head:8786: whoever reaches this scheduler can run code on its workers" in said


def test_a_job_that_kills_its_workers(tmp_path):
    pytest.importorskip("distributed")
    (tmp_path / "deadly.py").write_text(SCRIPT, encoding="utf-8")
    path = os.pathsep.join([str(ROOT), str(tmp_path)])
    done = subprocess.run(
        [sys.executable, "deadly.py"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    found = sorted(line for line in done.stdout.splitlines() if line.startswith("result"))
    expected = [f"result {n} {n}" for n in range(6)]
    expected[3] = "result 3 WorkerDeath"
    assert found == expected, done.stderr
