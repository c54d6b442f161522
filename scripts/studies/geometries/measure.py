"""Failure loads of one structure in both geometries, as drawn and with stones that are off, each beside its bound."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from typing import Any

from fuzzing.draw import Tables

from dem_cli.core.engine.settings import DEFAULT, Settings
from dem_cli.errors import DemError
from studies import solution, storage
from studies.geometries.structures import ERROR, off, structure

STEPS = 400_000  # of a run: a tenth of what a case has unless it says otherwise
STIFFER = 10.0
ROUGH = 5.0  # friction with which hardly anything slides
LESS = 0.1  # of the error of stones, where a load above its bound is not explained by where blocks rest
RESOLUTION = 0.002  # of a load, as in any case
KEPT = ("status", "failure_load_bracket", "above_the_bound", "no_bound", "warnings")


def measure(seed: int) -> dict[str, Any]:
    """Run the structure of a seed in both geometries; more often where these disagree or a bound is passed."""
    begun = time.process_time()
    tables, blocks, _ = structure(seed)
    row: dict[str, Any] = {
        "run": f"scripts/study geometries {seed}",
        "kind": tables["structure"][0]["kind"],
        "dimension": tables.get("dimension", 2),
        "blocks": blocks,
        "pattern": tables["analysis"]["pattern"],
        "friction": tables["joints"]["dry"]["friction"],
    }
    others = off(tables)
    for name, of, geometry in (
        ("drawn_fixed", tables, "fixed"), ("drawn_moving", tables, "large"),
        ("off_fixed", others, "fixed"), ("off_moving", others, "large"),
    ):  # fmt: skip
        row[name] = answer(of, geometry)
    if apart(row["drawn_fixed"], row["drawn_moving"]) > RESOLUTION:
        row |= looked_into(tables)
    if not row["off_moving"].get("above_the_bound", {"explained": True})["explained"]:
        row["less_off"] = answer(off(tables, LESS * ERROR), "large")
    return storage.rounded(row | {"seconds": time.process_time() - begun})


def looked_into(tables: Tables) -> dict[str, Any]:
    """Run a structure whose geometries disagree by other ways to the load, on stiffer joints, and without sliding."""
    stiffness = replace(DEFAULT.stiffness, statics=STIFFER * DEFAULT.stiffness.statics)
    return {
        "by_path": answer(tables, "fixed", "analysis.start='path'"),
        "by_limit": answer(tables, "fixed", "analysis.start='limit'"),
        "rough_fixed": answer(tables, "fixed", f"joints.dry.friction={ROUGH}"),
        "rough_moving": answer(tables, "large", f"joints.dry.friction={ROUGH}"),
        "stiffer": answer(tables, "large", settings=replace(DEFAULT, stiffness=stiffness)),
    }


def answer(tables: Tables, geometry: str, *overrides: str, settings: Settings = DEFAULT) -> dict[str, Any]:
    """Run a structure; returns load, status, warnings and the bound, of the start or of where its blocks rest."""
    begun = time.process_time()
    asked = (f"analysis.kinematics={geometry!r}", f"analysis.max_steps={STEPS}", *overrides)
    try:
        summary = solution.solve(solution.from_tables(tables, *asked), settings).summary
    except DemError as error:
        return {"status": f"refused: {error}"}
    found = {key: summary[key] for key in KEPT if summary.get(key)}
    start = (summary.get("limit_analysis") or {}).get("associated")
    rests = (summary.get("bound_where_it_rests") or {}).get("bound")
    return found | {"bound": rests if start is None else start, "seconds": time.process_time() - begun}


def apart(a: dict[str, Any], b: dict[str, Any]) -> float:
    """Return the distance of the brackets of two runs over the lower load; 0 where one of them has none."""
    (low, high), (other_low, other_high) = (run.get("failure_load_bracket") or (None, None) for run in (a, b))
    if not (low and other_low):
        return 0.0
    high, other_high = high or math.inf, other_high or math.inf  # it stands there, and nothing says where it fails
    return float(max(low - other_high, other_low - high, 0.0) / min(low, other_low))
