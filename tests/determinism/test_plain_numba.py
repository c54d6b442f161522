"""Numba as it comes gives the bytes of the package's own way: where threads were asked for, and in space."""

from __future__ import annotations

import os
import subprocess
import sys

from casefiles import CASES

ROCKING = CASES / "verification" / "space" / "rocking_oblique_edge.toml"
PROGRAM = """
import hashlib, sys
from pathlib import Path
from engine import running_wall, simulation, solve, tables
from dem_cli.engine.threads.crew import crew_of
from dem_cli.kernels import records as slot
from dem_cli.kernels.compilation.switch import SWITCH

with crew_of(2) as crew:
    sim = simulation(tables(*running_wall(40, 40)))
    assert sim.tiled
    sim.set_load(0.55)
    sim.use(0.6, 0.3, 0.3)
    sim.advance(12, slot.FIRE)
stepped = [*sim.bodies[:5], *sim.contacts[:4], sim.ledger]
_, rocked = solve(Path(sys.argv[1]), "analysis.duration=0.05", "output.frames=2")
shaken = [rocked.history.monitors, *(frame.velocities for frame in rocked.frames)]
print(crew.used, SWITCH.reason)
for arrays in (stepped, shaken):
    print(hashlib.sha256(b"".join(array.tobytes() for array in arrays)).hexdigest())
"""


def test_the_same_bytes_either_way():
    """Two threads step the wall of 1,600 blocks the own way; numba as it comes has one alone."""
    said, found = {}, {}
    for plain in ("", "1"):
        environment = os.environ | {"DEM_PLAIN_NUMBA": plain, "NUMBA_NUM_THREADS": "2"}
        command = [sys.executable, "-c", PROGRAM, str(ROCKING)]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        said[plain], *found[plain] = done.stdout.splitlines()
    assert said == {"": "2 None", "1": "1 DEM_PLAIN_NUMBA is set"}
    assert found["1"] == found[""]
    assert len(set(found[""])) == 2
