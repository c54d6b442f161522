"""Walls with top load (thesis Appendix B): three of the runs, and all of them as docs/appendix_b.md has them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from reference import result, results, value
from studies import storage
from studies.appendix_b import failure_loads, softness, sweep
from studies.appendix_b.study import STUDY

from dem_cli.app.api import load_case
from dem_cli.masonry.assembly.assemble import assembly

ROOT = Path(__file__).resolve().parents[2]

BOOK = "thesis_appendix_b"
TABLE = storage.read("appendix_b")
ROWS = {row["name"]: row for row in TABLE["failure_loads"]["rows"]}
SOFT = TABLE["softness"]
LOADS = {name: failure_loads.load_of(row) for name, row in ROWS.items()}


@pytest.fixture(scope="module")
def planned():
    return sweep.planned()


def test_every_test_is_one_run(planned):
    assert list(planned) == [*(f"test {i}" for i in range(1, 15)), "square B", "square C"]
    for name, run in planned.items():
        said = run.values
        for kind in ("num", "exp"):
            if (row := f"B{name.split()[-1]}_{kind}") in results(BOOK):
                book = result(BOOK, row)
                bricks = {4.6: "stretchers", 2.3: "headers"}[book["bh"]]
                assert (said["bricks"], said["condition"]) == (bricks, book["load"]), name
                assert int(said["kg"]) == book.get("top_load_kg", int(said["kg"]))
                assert book.get("friction", 0.6) == said.get("joints.dry.friction", 0.6)


@pytest.mark.parametrize(
    ("name", "bricks", "top"),
    [("test 2", 187, 250.0), ("test 7", 357, 750.0), ("test 12", 357, 500.0), ("square C", 341, 250.0)],
)
def test_blocks_and_masses(planned, name, bricks, top):
    """As many bricks as the thesis says, loads of the mass and at the place that the data book gives."""
    model = assembly(load_case(sweep.CASE, planned[name].overrides).case).model
    material = np.array(model.material_names)[model.block_material]
    free = ~model.fixed
    loads = free & (material == "load")
    assert (free & (material == "peperino")).sum() == bricks
    assert model.masses[loads].sum() == pytest.approx(top, rel=1e-4)
    place = (model.masses[loads] @ model.centroids[loads]) / model.masses[loads].sum()
    assert place == pytest.approx([0.03 if name == "test 12" else 0.2, 0.659])


@pytest.mark.parametrize("name", ["test 1", "test 4"])
def test_runs_near_the_thesis(name):
    """A coarse bracket, as docs/appendix_b.md has it; on joints on which the top moves as far as the thesis says."""
    found = sweep.changed(name, {"analysis.resolution": 0.01})
    assert found["status"] == "ok"
    assert np.mean(found["bracket"]) == pytest.approx(LOADS[name], rel=0.01)
    assert 0.5 * softness.STATED < softness.top_at_failure(name, found) < 1.1 * softness.STATED
    theirs = np.mean(value(BOOK, f"B{name[-1]}_num"))
    assert np.mean(found["bracket"]) == pytest.approx(theirs, rel={"test 1": 0.065, "test 4": 0.09}[name])


def test_joints_by_one_rule(planned):
    """The largest stress on the base under the dead loads over 4 um, two digits; resultants by hand."""
    for name, run in planned.items():
        row = ROWS[name]
        thickness = 0.04 if row["bricks"] == "stretchers" else 0.08
        beam = 0.4 * 0.024 * thickness * 2700.0 if row["condition"] == "D" else 0.0
        wall = 2143.0 * 0.4 * 0.595 * thickness + beam
        place = (row["kg"] * (0.03 if row["condition"] == "D" else 0.2) + wall * 0.2) / (row["kg"] + wall)
        pressed = min(0.4, 3.0 * place)  # a triangle where the far side opens
        peak = 1.0 if place == pytest.approx(0.2) else 2.0
        stress = peak * 9.81 * (row["kg"] + wall) / (pressed * thickness)
        joints = load_case(sweep.CASE, run.overrides).case.joints
        assert [joint.kn for joint in joints.values()] == pytest.approx([stress / 4e-6] * 2, rel=0.025), name


def test_the_top_moves_as_the_thesis_says():
    """At most 0.5 % of the height, half a step of its loads below failure; stiffer joints change loads the less."""
    tops = [softness.top_at_failure(one["name"], one) for one in SOFT["others"] if one["share"] == 1.0]
    assert len(tops) == len(softness.COMPUTED)
    assert max(tops) == pytest.approx(softness.STATED, rel=0.05)
    assert min(tops) > 0.5 * softness.STATED
    for name in ("test 1", "test 4"):
        shares = {one["share"]: softness.middle(one) for one in SOFT["others"] if one["name"] == name}
        ordered = [shares[share] for share in sorted(shares)] + [softness.middle(SOFT["rigid"][name])]
        assert ordered == sorted(ordered)


def test_all_runs_came_to_an_answer_below_the_bound():
    """Rigid joints as the path has them; softer ones carry less."""
    for name, row in ROWS.items():
        low, high = row["bracket"]
        assert row["status"] == "ok"
        assert low < high
        stiff = failure_loads.rigid_run(name)["bracket"]
        assert max(low, stiff[0]) < 1.002 * row["associated"]
        assert low < 1.01 * stiff[1]
        if row["path"] is not None:  # raised from gravity some end below it, by the way of loading
            assert stiff[0] == pytest.approx(row["path"], rel=0.01)
            assert stiff[1] == pytest.approx(row["path"], rel=0.005)


def test_conditions_as_in_the_thesis():
    """Sliding at the friction; a beam makes square bricks turn as one; the load on top changes little."""
    for name, row in ROWS.items():
        if row["condition"] != "A" and (theirs := failure_loads.thesis_dem(row)) is not None:
            assert failure_loads.rigid_load(name) == pytest.approx(np.mean(theirs), rel=0.07), name
    assert [failure_loads.rigid_run(name)["mode"] for name in ("test 10", "test 11")] == ["sliding", "rocking"]
    assert LOADS["test 10"] == pytest.approx(0.5, rel=0.005)
    assert ROWS["square B"]["moving"] < 20 < 100 < ROWS["square C"]["moving"]
    assert LOADS["square C"] / LOADS["square B"] > 1.4
    same = [LOADS[f"test {i}"] for i in (5, 6, 7)]
    assert max(same) / min(same) < 1.03


def test_measured_loads_are_lower_by_a_tenth():
    """On rigid joints as in the thesis; softer ones bring loaded walls nearer to the tests."""
    rows = list(ROWS.values())
    printed = value(BOOK, "ratio_exp_num")
    assert failure_loads.mean_ratio(rows, rigid=True) == pytest.approx(printed, abs=0.02)
    assert printed < failure_loads.mean_ratio(rows) < 0.95


def test_self_weight_on_stated_joints():
    """Nothing is lost of it: stretchers as the thesis, headers 8 % above instead of 15."""
    for name, error, rigid in (("test 1", 0.03, 0.05), ("test 4", 0.09, 0.13)):
        theirs = np.mean(value(BOOK, f"B{name[-1]}_num"))
        assert 0.0 < LOADS[name] / theirs - 1.0 < error
        assert failure_loads.rigid_load(name) / theirs - 1.0 > rigid


def test_the_page_is_what_was_measured():
    found = (ROOT / "docs/appendix_b.md").read_text(encoding="utf-8")
    assert found == STUDY.page(TABLE), "scripts/study appendix_b --write"
