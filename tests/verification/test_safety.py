"""kind = "safety": factors and least thicknesses against closed forms, the data book and the oracle."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from casefiles import CASES, allowance, blocks_of, case_id, read
from engine import Records, block, rectangle, scene, solve, tables
from oracle.limit_lp import limit_load
from reference import result

from dem_cli.analyses import solve as solver

FILES = sorted((CASES / "verification").glob("safety_*.toml")) + sorted(
    (CASES / "verification").glob("least_thickness_*.toml")
)
QUICK = ("analysis.follow=0.0", "output.frames=0")
STATUS = "status"


@pytest.mark.parametrize("path", FILES, ids=case_id)
def test_known_answers(path):
    """By the [reference] of the file, with the proofs: what stands is at rest, what fails releases energy."""
    reference = read(path)["reference"]
    summary, _ = solve(path, *QUICK)
    name, value = reference["quantity"], reference["value"]
    if name == STATUS:
        assert summary["status"] == value
        return
    low, high = summary[f"{name}_bracket"]
    assert summary["status"] == "ok"
    if isinstance(value, list):
        assert value[0] <= summary[name] <= value[1]
    else:
        slack = allowance(path, reference)
        assert summary[name] == pytest.approx(value, abs=slack)
        assert low - slack <= value <= high + slack
    assert high - low <= summary_resolution(path) * high
    runs = {run["value"]: run for run in summary["runs"]}
    assert runs[summary["stands_at"]]["stands"] is True
    assert runs[summary["fails_at"]]["stands"] is False
    assert runs[summary["stands_at"]]["unbalanced"] < 1e-5
    assert summary["proof_of_failure"]["released_share_of_work"] > 0.0
    assert abs(summary["energy_closure"]) < 0.01


def summary_resolution(path: Path) -> float:
    return read(path)["analysis"].get("resolution", 0.002)


@pytest.mark.parametrize("key", ["arch_min_t", "arch_min_t_mu0.38", "arch_min_t_mu0.31"])
def test_the_oracle_has_the_data_books_least_thickness(key):
    """Our own limit analysis, independent of dem_cli, on either side of the published figure."""
    entry = result("classical_benchmarks", key)
    friction = entry.get("friction", 0.7)
    slack = 2.0 * entry["tolerance"]
    assert carries(arch(entry["value"] + slack), friction)
    assert not carries(arch(entry["value"] - slack), friction)


def arch(thickness: float) -> list[tuple]:
    """The blocks of the arch of the case files, thickness over radius."""
    case = read(CASES / "verification" / "least_thickness_arch.toml")
    case["structure"][0]["ring"] = 10.0 * thickness
    return blocks_of(case)


def carries(blocks: list[tuple], friction: float, load: float = 0.0) -> bool:
    polygons = [part for found in blocks for part in found[1]]
    found = limit_load(polygons, [b[4] for b in blocks], friction).multiplier
    return bool(found >= load)  # not a number: it does not stand at all


def test_pushed_arch_against_the_oracle():
    reference = read(CASES / "verification" / "least_thickness_arch_pushed.toml")["reference"]["value"]
    assert carries(arch((reference + 1e-4) / 10.0), 0.7, 0.1)
    assert not carries(arch((reference - 1e-4) / 10.0), 0.7, 0.1)


def incline(friction: float, slope: float, **more) -> dict:
    """A flat block on a turned table."""
    analysis = {"kind": "safety", "pattern": "tilt", "load": slope, **more}
    base = block("base", rectangle(-2.0, -0.5, 2.0, 0.0), fixed=True)
    return tables(base, block("b", rectangle(-0.5, 0.0, 0.5, 0.2)), friction=friction, analysis=analysis)


@pytest.mark.parametrize(("friction", "slope"), [(0.2, 0.5), (0.5, 0.499), (0.9, 0.1)])
def test_factors_below_and_above_one(friction, slope):
    summary, _ = solve(incline(friction, slope))
    assert summary["safety_factor"] == pytest.approx(friction / slope, rel=0.002)
    assert summary["strengths_needed"]["dry"]["friction"] == pytest.approx(slope, rel=0.0021)
    assert summary["failure_mode"] == "sliding"


def test_the_guess_saves_runs_and_changes_nothing():
    guided, _ = solve(incline(0.6, 0.25))
    alone, _ = solve(incline(0.6, 0.25, limit=False))
    assert "limit_analysis" not in alone
    assert len(guided["runs"]) == 2 < len(alone["runs"])
    assert alone["safety_factor"] == pytest.approx(guided["safety_factor"], rel=0.002)
    assert alone["steps"] > 2 * guided["steps"]


def test_least_friction_and_steepest_slope_by_key():
    """Stands above one, below the other."""
    case = incline(0.6, 0.25, vary="joints.dry.friction", between=[0.1, 0.6])
    summary, _ = solve(case)
    assert summary["critical_value"] == pytest.approx(0.25, rel=0.002)
    assert summary["stands_at"] > summary["fails_at"]
    case = incline(0.6, 0.25, vary="analysis.load", between=[0.1, 0.9])
    summary, _ = solve(case)
    assert summary["critical_value"] == pytest.approx(0.6, rel=0.002)
    assert summary["stands_at"] < summary["fails_at"]


@pytest.mark.parametrize(("at", "follows"), [([0.0, 0.5], True), ([-0.5, 0.5], False)])
def test_loads_that_do_not_follow_the_blocks_are_named(at, follows):
    """A column 1 m wide that topples when it is thinner: a load on its back face stays where that face was."""
    column = {"kind": "column", "block": [1.0, 1.0], "courses": 3}
    load = {"block": "column-1", "force": [2000.0, -1000.0], "at": at, "kind": "live"}
    analysis = {"kind": "safety", "vary": "structure.0.block.0", "between": [0.05, 1.0], "pattern": "live"}
    summary, _ = solve(tables(structure=[column], load=[load], analysis=analysis))
    said = [warning for warning in summary["warnings"] if "does not follow" in warning]
    assert bool(said) is not follows
    assert follows or "load.0.at: [-0.5, 0.5] is 0." in said[0]


def test_whole_numbers():
    """A column of blocks 0.5 m long and 0.2 m high under 0.3 g: stands up to 0.5 / 0.3 / 0.2 = 8.3 courses."""
    case = {
        "materials": {"stone": {"density": 2000.0}},
        "joints": {"dry": {"friction": 0.6}},
        "structure": [{"kind": "column", "block": [0.5, 0.2], "courses": 4, "base": True}],
        "analysis": {
            "kind": "safety", "vary": "structure.0.courses", "between": [2.0, 20.0], "load": 0.3, "follow": 0.05,
        },
    }  # fmt: skip
    summary, records = solve(case)
    assert (summary["stands_at"], summary["fails_at"]) == (8, 9)
    assert records.models[-1].n_blocks == 10  # of the one that fails, with its base
    assert {len(frame.positions) for frame in records.frames} == {10}


def test_both_ends_alike():
    summary, _ = solve(incline(0.6, 0.25, vary="joints.dry.friction", between=[0.3, 0.6]))
    assert summary["status"] == "stands at both joints.dry.friction = 0.3 and 0.6"
    assert summary["critical_value"] is None


def test_a_run_without_proof_is_no_answer():
    case = incline(0.6, 0.25, max_steps=3000)
    summary, _ = solve(case)
    assert summary["status"].startswith("not converged: neither equilibrium nor failure was proven at F = 2.40")
    assert summary["safety_factor"] is None
    assert summary["stands_at"] == pytest.approx(2.4, rel=0.002)  # what is known stays known
    assert any("all steps of analysis.max_steps are used up" in text for text in summary["warnings"])


def test_frames_show_the_structure_next_to_failure():
    """Geometry that is varied: frames and model are of the thin column, not of the one in the file."""
    path = CASES / "verification" / "least_thickness_column.toml"
    made, records = scene(path, "analysis.follow=0.3"), Records()
    summary = solver.solve(made.case, made.model, records).summary
    model = records.models[-1]
    assert np.ptp(model.vertices[:, 0]) == pytest.approx(summary["fails_at"])
    first, last = records.frames[0], records.frames[-1]
    assert (first.stage, last.stage) == ("loading", "collapse")
    assert np.abs(first.positions - model.centroids).max() < 1e-3 < 0.3 <= last.displacement


def test_the_same_twice():
    """Bytes of the answer, whatever was computed before."""
    one, two = (solve(incline(0.6, 0.3))[0] for _ in range(2))
    assert one["safety_factor_bracket"] == two["safety_factor_bracket"]
    assert [run["steps"] for run in one["runs"]] == [run["steps"] for run in two["runs"]]
