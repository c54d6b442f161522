"""The verification manual: references are what mechanics says, docs/verification.md is what dem gives for them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from casefiles import CASES, FILES, case_id, read, references, scene
from oracle import code_checks, manual
from oracle.hinges import follow
from oracle.rolling_column import foot
from reference import value as book

from dem_cli.app.cli.verify import verified
from dem_cli.app.verify.case_selection import SHELVES
from dem_cli.app.verify.page import page
from dem_cli.app.verify.records import all_well, digest, on_shelves

DOCS = Path(__file__).resolve().parents[2] / "docs"
TABLE = json.loads((DOCS / "data" / "verification.json").read_text(encoding="utf-8"))
RECORDS = {(DOCS / record["case"]).resolve(): record for record in TABLE["cases"]}
REFERENCED = [path for path in FILES if references(path)]
VERIFICATION = CASES / "verification"
EXACT = manual.statics() | manual.springs() | manual.sliding() | manual.rocking()
EXACT |= {name: values() for name, values in code_checks.CASES.items()}
RUN_AGAIN = (*manual.statics(), "modes_block", "collision", "push_stop", "rocking_quarter", "overhang_10_falls")
CLASSICAL = "classical_benchmarks"


def stated(name: str) -> dict[str, object]:
    """References of a case of cases/verification by their quantities."""
    tables = references(VERIFICATION / f"{name}.toml")
    return {one.get("quantity", "failure_load"): one.get("value", one.get("failure_load")) for one in tables}


@pytest.mark.parametrize("name", EXACT)
def test_exact_answers(name):
    """To the digits that the case file gives."""
    found = stated(name)
    for quantity, exact in EXACT[name].items():
        assert found[quantity] == pytest.approx(exact, rel=2e-5, abs=1e-12), quantity


def test_quarter_period():
    exact, small = manual.quarter_period()
    case = read(VERIFICATION / "rocking_quarter.toml")
    assert case["analysis"]["duration"] == pytest.approx(exact, rel=1e-6)
    assert small == pytest.approx(book(CLASSICAL, "rock_quarter"), rel=1e-5)
    assert small == pytest.approx(exact, rel=2e-3)


@pytest.mark.parametrize(
    ("case", "quantity", "result"),
    [
        ("incline_slide", "peaks.top displacement.residual", "slide_dist"),
        ("push_stop", "peaks.block displacement x.residual", "push_stop"),
        ("modes_block", "frequencies.1", "bounce_f"),
    ],
)
def test_data_book(case, quantity, result):
    assert stated(case)[quantity] == pytest.approx(book(CLASSICAL, result), rel=1e-5)


@pytest.mark.parametrize("blocks", [2, 3, 10])
@pytest.mark.parametrize(("share", "name"), [(0.99, "stands"), (1.01, "falls")])
def test_overhangs(blocks, share, name):
    """The drawing has the overhang that it says; the data book has the largest one."""
    largest = manual.largest_overhang(blocks)
    assert largest == pytest.approx(book(CLASSICAL, f"overhang_{blocks}"), rel=1e-5)
    tables = read(VERIFICATION / f"overhang_{blocks}_{name}.toml")["block"]
    reach = [max(x for x, _ in table["vertices"]) for table in tables]
    assert len(tables) == blocks + 1
    assert reach[-1] - reach[0] == pytest.approx(share * largest, abs=1e-5)
    steps = np.diff(reach)
    np.testing.assert_allclose(steps, share * 0.5 / np.arange(blocks, 0, -1), atol=2e-6)


def test_settlement_of_the_portal():
    case = scene(VERIFICATION / "settlement_portal.toml")
    order = ["arch-left-1", *(f"arch-{i}" for i in range(1, 7)), "arch-right-1"]
    polygons = dict(zip(case.ids, case.polygons))
    weights = dict(zip(case.ids, case.weights))
    chain = [polygons[name] for name in ("arch-base-left", *order, "arch-base-right")]
    shift = np.array(read(VERIFICATION / "settlement_portal.toml")["settlement"][0]["displacement"])
    motion = follow(chain, np.array([weights[name] for name in order]), shift)
    assert follow(chain, np.array([weights[name] for name in order]), 0.01 * shift).hinges == motion.hinges
    third, fourth = order.index("arch-3"), order.index("arch-4")
    found = stated("settlement_portal")
    assert found["monitors.arch-3 displacement y.value"] == pytest.approx(motion.displacements[third, 1], rel=2e-5)
    assert found["monitors.arch-3 rotation.value"] == pytest.approx(motion.rotations[third], rel=2e-5)
    assert found["monitors.arch-4 rotation.value"] == pytest.approx(motion.rotations[fourth], rel=2e-5)


def test_two_leaning_blocks_follow_their_support_as_the_oracle_of_arches_says():
    case = scene(VERIFICATION / "settlement_two_blocks.toml")
    polygons = dict(zip(case.ids, case.polygons))
    chain = [polygons[name] for name in ("foot-left", "left", "right", "foot-right")]
    motion = follow(chain, case.weights[[case.ids.index("left"), case.ids.index("right")]], np.array([0.1, 0.0]))
    exact = EXACT["settlement_two_blocks"]["monitors.left rotation.value"]
    assert motion.rotations[0] == pytest.approx(exact, rel=1e-9)


def test_rolling_to_and_fro():
    moved = manual.square_on_polygon(foot(5 * [0.2], 0.01), 2)
    found = [one["value"] for one in references(CASES / "validation" / "block_on_polygon_cycle.toml")]
    assert found == pytest.approx([moved, 0.0, moved, 0.0], abs=1e-6)


def test_every_case_with_a_reference_is_on_the_page_and_no_other():
    assert sorted(map(case_id, RECORDS)) == sorted(map(case_id, REFERENCED))


@pytest.mark.parametrize("path", REFERENCED, ids=case_id)
def test_the_page_belongs_to_the_case_file(path):
    assert RECORDS[path]["sha256"] == digest(path), f"dem verify {path} --write docs/verification.md"


def test_the_page_is_made_from_its_json():
    assert (DOCS / "verification.md").read_text(encoding="utf-8") == page(TABLE["cases"], TABLE["version"])


def test_all_is_as_the_cases_say():
    assert all_well(RECORDS.values())


def test_enough_of_them():
    """Issue 6: at least 25 cases with a known answer; every shelf has some."""
    numbers = {shelf: len(on_shelves(RECORDS.values(), [shelf])) for shelf in SHELVES.values()}
    assert numbers["verification"] >= 80
    assert min(numbers.values()) >= 5


@pytest.mark.parametrize("name", RUN_AGAIN)
def test_run_again(name):
    """What the page prints is what dem gives now."""
    path = VERIFICATION / f"{name}.toml"
    again, before = verified(path), RECORDS[path]
    for new, old in zip(again["references"], before["references"], strict=True):
        assert new["state"] == old["state"] == "passed"
        if isinstance(old["found"], float):
            assert new["found"] == pytest.approx(old["found"], rel=1e-6, abs=1e-12)
        else:
            assert new["found"] == old["found"]
