"""`dem run` on every case with a known answer, as a user runs it; references are checked in test_cases.py."""

from __future__ import annotations

import json

import pytest
from casefiles import CASES, FILES, PLANAR, case_id, failure_load, read, scene
from click.testing import CliRunner
from engine import solve

from dem_cli.app.cli.main import main

LARGE = {  # solved for docs/data/loads.json
    "top_load_b1", "top_load_b2", "top_load_b5", "top_load_b8", "top_load_b10", "top_load_b11",
}  # fmt: skip
PROFILED = {"column_14_five_sides", "column_14_profile"}  # by tests/validation/test_columns.py
SMALL = {  # of one or two blocks: solved by test_manual.py, all in one process
    "barton_block", "cohesion_block", "crushing_block", "crushing_toe", "groove_30", "incline_down", "incline_up",
    "interface_slides", "lever", "slope_of_slip", "stepped_column", "tension_block",
}  # fmt: skip
REFERENCED = [path for path in FILES if failure_load(path) and path.stem not in LARGE | SMALL | PROFILED]
DEAR = {"facade", "gatehouse"}  # solved for docs/data/loads.json
SHOWN = [path for path in PLANAR if path.parent == CASES / "gallery" and path.stem not in DEAR]
MODES = {
    "wall_21_mu050": "sliding",
    "wall_21": "sliding",
    "wall_21_mu065": "mixed",
    "wall_21_mu075": "rocking",
    "wall_21_mu100": "rocking",
    "arch_21": "rocking",
    "arch_21_mu040": "mixed",  # hinges, and a springing that slides
    "arch_coursed_buttresses_mu030": "sliding",
    "arch_coursed_buttresses_mu050": "mixed",
    "column_14": "rocking",
    "sliding_block": "sliding",
    "trilith": "rocking",
    "groove": "sliding",
}


def run(path, folder, *options) -> dict:
    """The summary of `dem run --json`; not in a process of its own, whose start takes longer than most of the runs."""
    done = CliRunner().invoke(main, ["run", str(path), "-o", str(folder / "out"), "--json", "-q", *options])
    assert done.exit_code == 0, done.output
    return json.loads(done.stdout)


@pytest.mark.parametrize("path", REFERENCED, ids=case_id)
def test_failure_load(path, tmp_path):
    reference = failure_load(path)
    summary = run(path, tmp_path)
    assert summary["status"] == "ok"
    assert summary["failure_load"] == pytest.approx(reference["failure_load"], abs=reference["tolerance"])
    low, high = summary["failure_load_bracket"]
    assert low <= summary["failure_load"] <= high
    assert abs(summary["energy_closure"]) < 0.01
    if path.stem in MODES:
        assert summary["failure_mode"] == MODES[path.stem]


@pytest.mark.parametrize(("letter", "share"), [("a", 0.02), ("b", 0.01)])
def test_the_first_motion_of_a_wall_with_a_low_block(letter, share):
    """Of a block that was searched for it, with a joint that stays open; with one that closes, a declared miss."""
    path = CASES / "verification" / f"wall_21_imperfect_{letter}.toml"
    reference = failure_load(path, "code")
    first, last = (solve(path, f"analysis.kinematics={way}")[0]["failure_load"] for way in ("fixed", "auto"))
    assert first == pytest.approx(reference["failure_load"], rel=share)
    assert last > reference["failure_load"] + reference["tolerance"]
    assert "missed" in reference


def test_cannot_fail(tmp_path):
    summary = run(CASES / "verification" / "wedged_block.toml", tmp_path)
    assert summary["failure_load"] is None
    assert summary["status"] != "ok"


@pytest.mark.parametrize("name", ["overhang_falls", "leaning_column"])
def test_does_not_stand(name, tmp_path):
    summary = run(CASES / "verification" / f"{name}.toml", tmp_path)
    assert not summary.get("failure_load")
    assert summary["status"] != "ok"


def test_settlement_of_a_support(tmp_path):
    assert run(CASES / "verification" / "settlement_portal.toml", tmp_path)["status"] == "ok"


def test_weight_and_units_do_not_matter(tmp_path):
    """A rigid dry structure fails at the same multiplier whatever its density and the gravity."""
    changes = ("materials.peperino.density=1.0", "gravity=1.62", "analysis.follow=0.0")
    options = [word for change in changes for word in ("--set", change)]
    summary = run(CASES / "verification" / "wall_21.toml", tmp_path, *options)
    assert summary["failure_load"] == pytest.approx(0.6, abs=0.0018)


@pytest.mark.parametrize("path", SHOWN, ids=case_id)
def test_gallery(path, tmp_path):
    """No reference; but the energy closes, and no load is above the associated one."""
    summary = run(path, tmp_path)
    assert summary["status"] == "ok"
    assert abs(summary["energy_closure"]) < 0.01
    upper = scene(path).limit().multiplier
    assert 0.9 * upper < summary["failure_load"] <= upper * (1 + read(path)["analysis"]["resolution"])
