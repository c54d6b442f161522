"""Compiled code that comes from the cache is the code that was asked for, whichever process compiled it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from itertools import product

from dem_cli.core.kernels.compilation.machine_code import cache_folder
from dem_cli.core.kernels.contact_forces import make_contact_forces
from dem_cli.core.kernels.planar_forces import make_planar_forces
from dem_cli.core.kernels.planar_profiles import make_profiled_forces
from dem_cli.core.laws.mixed import mixed
from dem_cli.core.laws.registry import LAWS
from dem_cli.core.laws.softening import FRICTION_SOFTENING

COLUMN = """\
import sys
from engine import block, rectangle, simulation, tables
from dem_cli.core.kernels import records as slot
law, profile = sys.argv[1:]
joint = {"law": law, "friction": 0.6} | ({"compression": 1e9} if law == "crushing" else {})
if profile == "profile":
    joint["profile"] = {"sides": 3, "aperture": 1e-3}
base = block("base", rectangle(-1, -1, 2, 0), fixed=True)
case = tables(base, block("b", rectangle(0, 0, 1, 1)), joints={"dry": joint}, analysis={"kind": "gravity"})
sim = simulation(case, "large")
sim.set_load(0.0)
sim.advance(300, slot.HOLD_LOAD)
print(sim.contacts.normal.sum())
"""


def test_each_loop_has_a_name_of_its_own():
    """Numba numbers functions of one name from one in each process: the name must tell closures apart."""
    laws = [*LAWS.values(), FRICTION_SOFTENING]
    laws += [mixed((one, other)) for one, other in product(laws[:3], laws[:3]) if one is not other]
    laws.append(mixed(tuple(laws[:3])))
    loops = [make_contact_forces(law.function, law.bonded) for law in laws]
    loops += [make_planar_forces(law.function, law.bonded) for law in laws]
    loops += [make_profiled_forces(law.function, law.bonded, places) for law in laws for places in (False, True)]
    assert len({loop.__qualname__ for loop in loops}) == len(loops)


def test_second_law_of_a_machine(tmp_path):
    """Four processes share a cache; in the last two the loop over profiles was compiled by two of them."""
    script = tmp_path / "column.py"
    script.write_text(COLUMN, encoding="utf-8")
    environment = os.environ | {"DEM_CACHE_DIR": str(tmp_path / "cache")}
    here = cache_folder()  # all but loops, which are made of parts, may come from here
    ignored = shutil.ignore_patterns("*locals*", "*.tmp.*")
    shutil.copytree(here, tmp_path / "cache" / "dem-cli" / here.name, ignore=ignored)

    def weight(*words: str) -> float:
        command = [sys.executable, str(script), *words]
        return float(subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout)

    first = weight("crushing", "plane")
    for law in ("crushing", "coulomb", "coulomb"):
        assert abs(weight(law, "profile") - first) < 0.05 * first
