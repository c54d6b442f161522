"""The same case solved twice, and what differs between the results."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import h5py

from studies.places import CASES, ROOT

TIMES = {"solve_seconds", "solve_cpu_seconds", "compile_seconds", "wall_seconds", "started", "finished", "output"}


def differences(stem: str) -> list[str]:
    """Names of datasets of results.h5 and keys of summary.json that differ between two runs."""
    with tempfile.TemporaryDirectory() as folder:
        found = [run(stem, Path(folder) / f"out-{seed}", seed) for seed in ("1", "2")]
    one, two = found
    return sorted(name for name in one.keys() | two.keys() if one.get(name) != two.get(name))


def run(stem: str, folder: Path, seed: str) -> dict[str, Any]:
    """Every dataset as bytes and every figure of the summary but its times."""
    command = [
        sys.executable,
        "-m",
        "dem_cli",
        "run",
        str(CASES / "verification" / f"{stem}.toml"),
        "-q",
        "-o",
        str(folder),
    ]
    environment = os.environ | {"PYTHONHASHSEED": seed, "PYTHONPATH": str(ROOT)}
    subprocess.run(command, env=environment, check=True, capture_output=True)
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    found: dict[str, Any] = {f"summary {key}": value for key, value in summary.items() if key not in TIMES}

    def collect(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset):
            value = item[()]
            raw = value.tobytes() if hasattr(value, "tobytes") and value.dtype != object else repr(value)
            found[f"results {name}"] = (str(item.dtype), item.shape, raw)

    with h5py.File(folder / "results.h5", "r") as file:
        file["dem"].visititems(collect)
    return found
