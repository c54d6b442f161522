"""The second run of a case loads no numba, which takes longer than most short cases: all that they call is kept."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
from casefiles import CASES

from dem_cli.kernels.compilation.kept_code import may_be_kept

SHORT = 0.2  # s, of docs/data/verification.json
LARGE = ("wall_110", "wall_3_21_courses")  # fronts of limit analysis, joints in tiles
KNOWN = json.loads((CASES.parent / "docs" / "data" / "verification.json").read_text(encoding="utf-8"))["cases"]
PROGRAM = """
import sys
import dem_cli
numba = []
for case in sys.argv[1:]:
    dem_cli.run(case, set={"output.frames": 0})
    if "numba" in sys.modules and not numba:
        numba.append(case)
print("LOADED", numba)
"""


def short_cases() -> list[str]:
    named = {(CASES.parent / "docs" / each["case"]).resolve(): each["seconds"] for each in KNOWN}
    of_all = sorted((CASES / "verification").rglob("*.toml"))
    return [str(case) for case in of_all if named.get(case, 9.0) <= SHORT or case.stem in LARGE]


@pytest.mark.skipif(not may_be_kept(), reason="code is kept on Linux and x86-64 alone")
def test_later_runs_of_short_cases_load_no_numba():
    """In one process for all of them; where it had to compile, once more."""
    cases = short_cases()
    assert len(cases) > 70
    for _ in range(2):
        done = subprocess.run([sys.executable, "-c", PROGRAM, *cases], capture_output=True, text=True, check=True)
        last = done.stdout.splitlines()[-1]
        if last == "LOADED []":
            break
    assert last == "LOADED []"
