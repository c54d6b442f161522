"""The same bytes whatever BLAS and NumPy have for a processor: results and answers of a dozen runs."""

from __future__ import annotations

import json
import os
import subprocess
import sys

from casefiles import CASES
from numpy._core._multiarray_umath import __cpu_dispatch__

PROGRAM = """
import hashlib, json, sys
from pathlib import Path
from casefiles.stored import datasets, without_times
from dem_cli.app.cli.main import main

for number, (case, *sets) in enumerate(json.loads(sys.argv[1])):
    folder = Path(f"{number}")
    words = [word for one in sets for word in ("--set", one)]
    try:
        main(args=["run", case, "-q", "-o", str(folder), *words])
    except SystemExit as end:
        assert end.code in (None, 0, 1), case  # 1: a reference, of a run that is longer
    found = {name: hashlib.sha256(raw).hexdigest() for name, raw in datasets(folder).items()}
    found["summary"] = without_times(json.loads((folder / "summary.json").read_text(encoding="utf-8")))
    Path(f"{number}.json").write_text(json.dumps(found), encoding="utf-8")
"""
OF_3D = """
dimension = 3
[materials.stone]
density = 2300.0
"""
WALL_OF_CELLS = f"""{OF_3D}
[joints.dry]
friction = 0.7
[[structure]]
kind = "voronoi-wall"
size = [2.0, 1.2, 0.45]
cells = 10
relax = 3
seed = 4
base_height = 0.4
base_extension = 0.9
[analysis]
kind = "pushover"
direction = [0.0, -1.0, 0.0]
resolution = 0.02
follow = 0.0
"""
ELASTIC_WALL = f"""{OF_3D}
young = 2e9
poisson = 0.2
deformation = "uniform-strain"
[joints.dry]
friction = 0.7
kn = 5e9
ks = 3e9
[[structure]]
kind = "wall"
block = [0.5, 0.3]
courses = 3
blocks_per_course = 2
thickness = 0.4
[analysis]
kind = "pushover"
direction = [1.0, 0.0, 0.0]
follow = 0.0
"""
SHAKEN_ARCH = """
[materials.stone]
density = 2300.0
[joints.dry]
friction = 0.6
[[structure]]
kind = "arch"
shape = "circular"
included_angle_deg = 120.0
voussoirs = 7
inner_radius = 0.23
ring = 0.10
thickness = 0.08
base_extension = 0.15
[analysis]
kind = "KIND"
[motion]
kind = "artificial"
spectrum = "EC8-1"
soil = "B"
ag = 5.0
duration = 14.0
COUNT[damping]
contact_fraction = 0.35
"""
HISTORY = SHAKEN_ARCH.replace('"KIND"', '"time-history"\nduration = 0.3').replace("COUNT", "")
FRAGILITY = SHAKEN_ARCH.replace('"KIND"', '"fragility"\nunit_acceleration = 3.0\nintensities = [2.0, 4.0]').replace(
    "COUNT", "count = 2\n"
)
FILES = [  # with what makes them short
    ("wall_21", "analysis.follow=0.0"),
    ("wall_21_imperfect_a", "analysis.follow=0.0"),
    ("arch_21", "analysis.follow=0.0"),
    ("drum_column", "analysis.follow=0.0"),
    ("groove", "analysis.follow=0.0"),
    ("rocking_free", "analysis.duration=0.5"),
    ("rocking_quarter", "analysis.duration=0.3"),
    ("settlement_group",),
    ("safety_groove",),
    ("modes_block",),
    ("modes_elastic_block",),
    ("bar_yields",),
]
MADE = [WALL_OF_CELLS, ELASTIC_WALL, HISTORY, FRAGILITY]


def results(folder, environment: dict[str, str]) -> list[dict]:
    """Of all cases, done by one process."""
    folder.mkdir()
    cases = [[str(CASES / "verification" / f"{name}.toml"), *sets] for name, *sets in FILES]
    for number, text in enumerate(MADE):
        (folder / f"made-{number}.toml").write_text(text, encoding="utf-8")
        cases.append([f"made-{number}.toml"])
    command = [sys.executable, "-c", PROGRAM, json.dumps(cases)]
    subprocess.run(command, cwd=folder, env=os.environ | environment, check=True, capture_output=True)
    return [json.loads((folder / f"{number}.json").read_text(encoding="utf-8")) for number in range(len(cases))]


def test_no_byte_depends_on_the_processor(tmp_path):
    """Kernels of BLAS for this processor and for one of 2004, and NumPy's functions for AVX-512 and without."""
    newest = " ".join(name for name in __cpu_dispatch__ if "512" in name or name == "X86_V4")
    here = results(tmp_path / "here", {})
    there = results(
        tmp_path / "there",
        {"OPENBLAS_CORETYPE": "Prescott", "NPY_DISABLE_CPU_FEATURES": newest, "OPENBLAS_NUM_THREADS": "2"},
    )
    assert len(here) == len(FILES) + len(MADE)
    for one, other in zip(here, there, strict=True):
        assert len(one) > 10
        assert one.keys() == other.keys()
        assert [name for name in one if one[name] != other[name]] == [], one["summary"]["title"]
