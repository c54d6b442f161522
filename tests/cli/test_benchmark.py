"""scripts/benchmark.py runs and says everything; nothing is asserted about time."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "benchmark.py"


def test_quick_benchmark_prints_every_table():
    done = subprocess.run(
        [sys.executable, str(SCRIPT), "--quick", "--json", "--no-start-up"], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert [(row["kinematics"], row["blocks"]) for row in found["kernels"]] == [("fixed", 21), ("large", 21)]
    assert all(0.0 < row["best_ns"] <= row["median_ns"] for row in found["kernels"])
    assert [row["case"] for row in found["runs"]] == ["wall_21", "column_14"]
    assert all(abs(row["error"]) < 0.01 for row in found["runs"])
    assert {"cores", "numpy", "numba"} <= set(found["machine"])
