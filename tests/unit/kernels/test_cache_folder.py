"""Compiled code stays in the folder with the hash of its sources, whatever happens to the environment of numba."""

from __future__ import annotations

import os
import subprocess
import sys

PROGRAM = """
import os
from dem_cli.kernels.jit import cache_folder
from dem_cli.kernels.planar_geometry import measure  # any kernel
import numba
os.environ["NUMBA_NUM_THREADS"] = "1"  # as `dem bench` does
numba.config.reload_config()
assert numba.config.CACHE_DIR == str(cache_folder()), numba.config.CACHE_DIR
"""


def test_settings_that_are_read_again_keep_it(tmp_path):
    environment = os.environ | {"DEM_CACHE_DIR": str(tmp_path)}
    environment.pop("NUMBA_NUM_THREADS", None)
    subprocess.run([sys.executable, "-c", PROGRAM], env=environment, check=True)
