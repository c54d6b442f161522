"""The second run of a case loads no numba, which takes longer than most short cases: all that they call is kept."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
from casefiles import CASES

from dem_cli.core.kernels.compilation.kept_code import may_be_kept

SHORT = 0.15  # s, of docs/data/verification.json
KNOWN = json.loads((CASES.parent / "docs" / "data" / "verification.json").read_text(encoding="utf-8"))["cases"]
LARGE = CASES / "verification" / "wall_110.toml"  # fronts of limit analysis; joints in tiles, where these are asked for
PROGRAM = """
import sys
from dataclasses import replace
import dem_cli
from dem_cli.app import api
from dem_cli.analyses.solve import solve
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.records.ports import Observer

large, *cases = sys.argv[1:]
tiles = replace(DEFAULT, detection=replace(DEFAULT.detection, tiled_from=1))
loaders = []

def did(case):
    if "numba" in sys.modules and not loaders:
        loaders.append(case)

dem_cli.run(large)
did(large + ", with its results")
for case, settings in [(large, tiles), *((each, DEFAULT) for each in cases)]:
    loaded = api.load_case(case)
    solve(loaded.case, api.build_model(loaded), Observer(), settings=settings)
    did(case)
print("LOADED", loaders)
"""


def short_cases() -> list[str]:
    named = {(CASES.parent / "docs" / each["case"]).resolve(): each["seconds"] for each in KNOWN}
    return [str(case) for case in sorted((CASES / "verification").rglob("*.toml")) if named.get(case, 9.0) <= SHORT]


@pytest.mark.skipif(not may_be_kept(), reason="code is kept on Linux and x86-64 alone")
def test_later_runs_of_short_cases_load_no_numba():
    """In one process for all of them, most without files; where it had to compile, once more."""
    cases = short_cases()
    assert len(cases) > 60
    for _ in range(2):
        command = [sys.executable, "-c", PROGRAM, str(LARGE), *cases]
        last = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[-1]
        if last == "LOADED []":
            break
    assert last == "LOADED []"
