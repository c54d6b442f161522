"""Measurement of stages: each command in a process of its own, its CPU seconds and the most memory that it held."""

from __future__ import annotations

import json
import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import tomli_w

from dem_cli.app.api import make_case_model
from dem_cli.case.reader import CaseSource, validate
from dem_cli.masonry.structures.registry import generated_blocks
from studies.buildings import plans

PUSH = {"direction": [0.0, -1.0, 0.0], "resolution": 0.01}


def house() -> dict[str, Any]:
    """A house of 1,000 blocks from plan to report."""
    return stages(plans.case(plans.house(), "gravity"), plans.case(plans.house(), "pushover", **PUSH))


def town() -> dict[str, Any]:
    """10,000 blocks generated, checked and put to rest."""
    return stages(plans.case(plans.town(), "gravity"), None)


def bonds() -> list[dict[str, Any]]:
    """Blocks, whether it stands, failure load of a house of two rooms in each bond."""
    found = []
    with tempfile.TemporaryDirectory() as name:
        for bond, keys in plans.BONDS.items():
            folder = Path(name) / str(len(found))
            file = folder.with_suffix(".toml")
            file.write_text(tomli_w.dumps(plans.case(plans.two_rooms(keys), "pushover", **PUSH)), encoding="utf-8")
            row = command("pushover", "run", str(file), "-o", str(folder))
            summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
            told = ("blocks", "status", "failure_load_bracket", "failure_mode")
            found.append({"bond": bond, **{key: summary.get(key) for key in told}, "seconds": row["seconds"]})
    return found


def stages(at_rest: dict[str, Any], pushed: dict[str, Any] | None) -> dict[str, Any]:
    """Blocks, points, and what each stage took."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        rows = [{"stage": "generate", "seconds": generation(at_rest), "megabytes": None}]
        for stem, tables in (("gravity", at_rest), ("pushover", pushed)):
            if tables is None:
                continue
            file = folder / f"{stem}.toml"
            file.write_text(tomli_w.dumps(tables), encoding="utf-8")
            if stem == "gravity":
                rows.append(command("check", "check", str(file)))
            rows.append(command(stem, "run", str(file), "-o", str(folder / stem)))
        last = folder / ("gravity" if pushed is None else "pushover")
        if pushed is not None:
            rows.append(command("render", "render", str(last), "-o", str(folder / "picture.png")))
            rows.append(command("report", "report", str(last)))
        summary = json.loads((last / "summary.json").read_text(encoding="utf-8"))
        told = ("blocks", "joints", "contacts", "steps", "status", "failure_load_bracket", "failure_mode")
        return {**{key: summary.get(key) for key in told}, "stages": rows}


def generation(tables: dict[str, Any]) -> float:
    """CPU seconds from the tables of a building to its blocks."""
    given = {key: value for key, value in tables.items() if key != "analysis"}
    case = validate(given, make_case_model(), CaseSource(Path("case.toml"), ""))
    begun = time.process_time()
    generated_blocks(case.structure[0], case.seed)
    return round(time.process_time() - begun, 2)


def command(stage: str, *words: str) -> dict[str, Any]:
    """What a command of `dem` took, from start-up on. Raises RuntimeError where it fails."""
    program = [sys.executable, "-m", "dem_cli", *words]
    process = os.posix_spawn(sys.executable, program, os.environ, file_actions=QUIET)
    _, status, used = os.wait4(process, 0)
    if os.waitstatus_to_exitcode(status) not in (0, 1):
        raise RuntimeError(f"dem {' '.join(words)}: exit code {os.waitstatus_to_exitcode(status)}")
    return {
        "stage": stage,
        "seconds": round(used.ru_utime + used.ru_stime, 2),
        "megabytes": round(used.ru_maxrss / 1024),
    }


QUIET = [(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0), (os.POSIX_SPAWN_DUP2, 1, 2)]
