"""What the program costs on this machine: kernels, published failure loads, start-up.

Other work on the machine only ever adds time: everything is repeated in turn (each round measures each
thing once) and the best of all rounds counts; the median says how quiet the machine was.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
CASES = ROOT / "cases" / "verification"
sys.path.insert(0, str(ROOT))

WALLS = ((6, 3), (22, 10), (70, 32))  # courses × blocks: 21, 231 and 2,275 blocks
QUICK_WALLS = ((6, 3),)
POINT_STEPS = 1_000_000  # points × steps of one timing, about 10 ms
LOAD = 0.3  # multiplier at which the walls stand, with sticking, sliding and open points
RUNS = {  # case -> what it is
    "wall_21_mu050": "Table 5-3, μ 0.50",
    "wall_21": "Table 5-3, μ 0.60",
    "wall_21_mu065": "Table 5-3, μ 0.65",
    "wall_21_mu070": "Table 5-3, μ 0.70",
    "wall_21_mu075": "Table 5-3, μ 0.75",
    "wall_21_mu100": "Table 5-3, μ 1.00",
    "wall_1": "WALL1",
    "wall_2": "WALL2",
    "wall_3": "WALL3",
    "column_14": "COL14",
    "arch_21": "ARCH, μ ≥ 0.5",
    "arch_21_mu040": "ARCH, μ 0.4",
}
QUICK_RUNS = ("wall_21", "column_14")


class Nobody:
    """An observer that keeps nothing."""

    def frame(self, frame: Any) -> None: ...
    def row(self, row: Any) -> None: ...
    def progress(self, *where: Any) -> None: ...


def machine() -> dict[str, Any]:
    """Enough to compare figures, nothing that says whose machine it is."""
    import numba
    import numpy

    return {
        "cores": os.cpu_count(),
        "processor": platform.machine(),
        "python": platform.python_version(),
        "numpy": numpy.__version__,
        "numba": numba.__version__,
        "load": round(os.getloadavg()[0], 2) if hasattr(os, "getloadavg") else None,
    }


def wall(courses: int, blocks: int) -> Any:
    """The wall of Table 5-3 in another size: case and model."""
    from dem_cli import api

    sizes = [f"structure.0.courses={courses}", f"structure.0.blocks_per_course={blocks}"]
    loaded = api.load_case(CASES / "wall_21.toml", sizes)
    return loaded.case, api.build_model(loaded)


def simulation(case: Any, model: Any, kinematics: str) -> Any:
    """A compiled simulation of a case under LOAD, some hundred steps old."""
    from dem_cli.kernels import records as slot
    from dem_cli.solve.joints import joint_properties, law_of
    from dem_cli.solve.simulation import Simulation

    sim = Simulation(model, law_of(case), joint_properties(case, model), kinematics)
    sim.compile()
    sim.set_load(LOAD)
    sim.advance(300, slot.HOLD_LOAD)
    return sim


def kernel_table(walls: tuple, repeats: int) -> list[dict[str, Any]]:
    """ns per contact point and step with the ledger on, one core, float64."""
    from dem_cli.kernels import records as slot

    rows, timings = [], []
    for courses, blocks in walls:
        case, model = wall(courses, blocks)
        for kinematics in ("fixed", "large"):
            sim = simulation(case, model, kinematics)
            points = len(sim.joints.kn)
            rows.append({"kinematics": kinematics, "blocks": int((~model.fixed).sum()), "points": points})
            timings.append((sim, sim.save(), max(POINT_STEPS // points, 10), []))
    for _ in range(repeats):
        for sim, start, steps, seconds in timings:
            sim.restore(start)
            begun = time.perf_counter()
            sim.advance(steps, slot.HOLD_LOAD)
            seconds.append(1e9 * (time.perf_counter() - begun) / steps / len(sim.joints.kn))
    for row, (_, _, steps, seconds) in zip(rows, timings, strict=True):
        row |= {"steps": steps, "best_ns": min(seconds), "median_ns": statistics.median(seconds)}
    return rows


def run_table(names: tuple[str, ...], repeats: int) -> list[dict[str, Any]]:
    """Failure load, error against the [reference] of the case, and cost, of published cases (follow = 0)."""
    from dem_cli import api
    from dem_cli.solve.run import run

    rows, jobs = [], []
    for name in names:
        loaded = api.load_case(CASES / f"{name}.toml", ["analysis.follow=0", "output.frames=0"])
        jobs.append((loaded.case, api.build_model(loaded), []))
        rows.append({"case": name, "what": RUNS[name], "reference": loaded.case.reference.failure_load})
    for _ in range(repeats):
        for row, (case, model, seconds) in zip(rows, jobs, strict=True):
            found = run(case, model, Nobody()).summary
            seconds.append(found["solve_seconds"])
            load, keys = found["failure_load"], ("status", "failure_mode", "steps")
            row |= {key: found[key] for key in keys} | {"failure_load": load, "solve_seconds": min(seconds)}
            row["error"] = None if load is None else load / row["reference"] - 1.0
            row["median_seconds"] = statistics.median(seconds)
    return rows


def shell_seconds(words: list[str], cache: str) -> float:
    """From shell to shell: a new process, until it ended."""
    environment = os.environ | {"DEM_CACHE_DIR": cache, "MPLBACKEND": "Agg"}
    begun = time.perf_counter()
    subprocess.run(
        [sys.executable, "-m", "dem_cli", *words], cwd=ROOT, env=environment, check=True, capture_output=True
    )
    return time.perf_counter() - begun


def start_up_table(repeats: int) -> list[dict[str, Any]]:
    """`dem --help`, the first run with an empty cache of compiled code, and later runs."""
    with tempfile.TemporaryDirectory() as folder:
        run = ["run", str(CASES / "wall_21.toml"), "--quiet", "-o", f"{folder}/results"]
        first = shell_seconds(run, folder)
        commands = {"dem --help": ["--help"], "later runs of wall_21": run, "with --plot": [*run, "--plot"]}
        times: dict[str, list[float]] = {"first run of wall_21, nothing compiled": [first]}
        for _ in range(repeats):
            for name, words in commands.items():
                times.setdefault(name, []).append(shell_seconds(words, folder))
    return [{"what": n, "best_s": min(s), "median_s": statistics.median(s)} for n, s in times.items()]


def text_of(found: dict[str, Any]) -> str:
    """The tables as people read them."""
    about = ", ".join(f"{key} {value}" for key, value in found["machine"].items() if value is not None)
    lines = [about, "", "ns per contact point and step, ledger on, one core, float64"]
    lines.append(f"  {'geometry':<9} {'blocks':>7} {'points':>8} {'best':>7} {'median':>7}")
    for row in found["kernels"]:
        lines.append(
            f"  {row['kinematics']:<9} {row['blocks']:>7,} {row['points']:>8,}"
            f" {row['best_ns']:>7.2f} {row['median_ns']:>7.2f}"
        )
    lines += ["", "failure loads, without following the collapse"]
    head = f"  {'case':<18} {'load':>8} {'reference':>9} {'error':>8} {'mode':<8} {'steps':>9} {'solve s':>8}"
    lines.append(f"{head} {'median':>7}")
    for row in found["runs"]:
        load = f"{row['failure_load']:.5f}" if row["failure_load"] is not None else "–"
        error = f"{100 * row['error']:+.2f} %" if row["error"] is not None else row["status"]
        lines.append(
            f"  {row['what']:<18} {load:>8} {row['reference']:>9.5g} {error:>8} {row['failure_mode'] or '–':<8}"
            f" {row['steps']:>9,} {row['solve_seconds']:>8.3f} {row['median_seconds']:>7.3f}"
        )
    if found["start_up"]:
        lines += ["", f"shell to shell{'':<26} best s  median s"]
        lines += [f"  {r['what']:<38} {r['best_s']:>6.2f}    {r['median_s']:>6.2f}" for r in found["start_up"]]
    return "\n".join(lines)


def main(words: list[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="the smallest sizes, once or twice: does it work?")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--no-start-up", action="store_true", help="leave out the runs from shell to shell")
    parser.add_argument("--repeats", type=int, help="rounds; default 15 for kernels, 3 for runs")
    options = parser.parse_args(words)
    quick = options.quick
    found = {
        "machine": machine(),
        "kernels": kernel_table(QUICK_WALLS if quick else WALLS, options.repeats or (2 if quick else 15)),
        "runs": run_table(QUICK_RUNS if quick else tuple(RUNS), options.repeats or (1 if quick else 3)),
        "start_up": [] if options.no_start_up else start_up_table(1 if quick else 5),
    }
    print(json.dumps(found, indent=1) if options.json else text_of(found))


if __name__ == "__main__":
    main()
