"""Random structures of the stress test: the generator, its rigorous bounds, and a harness that sees what is wrong."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from oracle.limit_lp import limit_load
from studies.solution import from_tables
from studies.stress.random_structures import generator, page, record, study, verdicts
from studies.stress.random_structures.admissible import LoadedBodies, associated_load, lowest_load

from dem_cli.app import api

CASES = Path(__file__).resolve().parents[2] / "cases" / "verification"
SEEDS = range(12)  # of development; those of the page start at 2000


@pytest.fixture(scope="module")
def structures():
    return {seed: generator.structure(seed) for seed in SEEDS}


@pytest.mark.parametrize("seed", SEEDS)
def test_structures_are_sound(seed, structures):
    """`dem check` finds nothing wrong or odd with them, but for point loads that are no mass."""
    loaded = from_tables(structures[seed])
    model = api.build_model(loaded)
    assert generator.SIZES[0] <= (~model.fixed).sum() <= generator.SIZES[1]
    assert [warning for warning in loaded.warnings if "are no part of the live load" not in warning] == []


def test_a_seed_is_a_structure(structures):
    assert structures[3] == generator.structure(3)
    assert structures[3] != structures[4]


def test_structures_that_are_drawn_can_be_read():
    """Of all kinds, with bystanders and materials, before any linear program looks at them."""
    for seed in range(60):
        from_tables(generator.drawn(np.random.default_rng([1, seed])))


def test_every_kind_comes():
    drawn = {generator.drawn(np.random.default_rng(seed))["title"].partition(" beside")[0] for seed in range(60)}
    assert drawn == set(generator.KINDS)
    assert sum(share for share, _ in generator.KINDS.values()) == pytest.approx(1.0)


def test_associated_load_is_the_oracle_s(structures):
    """Wherever no corner stands on a face, which that does not know."""
    for tables in structures.values():
        bodies = LoadedBodies.of(tables)
        if not any("prop" in name for name in bodies.names):
            loads = {"weights": bodies.weights, "live": bodies.live, "dead": bodies.dead}
            theirs = limit_load(bodies.polygons, bodies.fixed, bodies.friction, bodies=bodies.bodies, **loads)
            assert associated_load(bodies) == pytest.approx(theirs.multiplier, rel=1e-6, nan_ok=True)


# -- bounds ------------------------------------------------------------------------------------------


def bounds(tables):
    bodies = LoadedBodies.of(tables)
    load = associated_load(bodies)
    return lowest_load(bodies, load), load


@pytest.mark.parametrize(
    ("case", "exact"),
    [
        ("sliding_block", 0.4),
        ("column_14", 0.04 / 0.245),
        ("trilith", 0.2),
        ("arch_21", 0.148315),
        ("portal", 0.324715),
    ],
)
def test_known_loads_are_between_the_bounds(case, exact):
    """Both bounds are the exact load, by closed forms and hinges (cases/verification)."""
    lowest, associated = bounds(tomllib.loads((CASES / f"{case}.toml").read_text(encoding="utf-8")))
    assert lowest == pytest.approx(exact, rel=3e-6)
    assert associated == pytest.approx(exact, rel=3e-6)


@pytest.mark.parametrize(("angle", "exact"), [(60.0, 0.312082), (70.0, 0.290260), (80.0, 0.108386)])
def test_a_leaning_slab_touches_at_its_corners(angle, exact):
    """A slab 3 m long and 0.2 m thick between ground and wall, pushed off the wall: forces at two corners, solved by
    hand: at 80° it turns about its foot, at 60° it slides at both ends.
    """
    lowest, associated = bounds(leaning(np.radians(angle)))
    assert associated == pytest.approx(exact, rel=3e-6)
    assert lowest is None or lowest <= associated * (1.0 + 1e-9)


def leaning(angle):
    """The slab, whose lower face goes from its foot at x = 0 up to the wall."""
    along, across = 3.0 * np.array([np.cos(angle), np.sin(angle)]), 0.2 * np.array([-np.sin(angle), np.cos(angle)])
    reach = float(along[0])
    boxes = {"ground": (-5.0, -1.0, reach, 0.0), "wall": (reach, -1.0, reach + 2.0, 10.0)}
    fixed = [
        {"id": name, "vertices": [[a, b], [c, b], [c, d], [a, d]], "fixed": True}
        for name, (a, b, c, d) in boxes.items()
    ]
    slab = np.array([0.0 * along, along, along + across, across])
    return {
        "materials": {"stone": {"density": 2000.0}},
        "joints": {"dry": {"friction": 0.4}},
        "block": [*fixed, {"id": "slab", "vertices": slab.tolist()}],
        "analysis": {"kind": "pushover", "direction": [-1.0, 0.0]},
    }


# -- the harness -------------------------------------------------------------------------------------


def test_a_structure_between_its_bounds():
    """A wall and its buttress: dilating joints carry a fifth more than what the structure reaches from gravity."""
    row = record.record(18)
    assert row["lowest"] < 0.9 * row["associated"]
    low, high = verdicts.bracket(row["answers"]["default"])
    assert high > row["lowest"] * (1.0 - verdicts.SLACK)
    assert low < row["lowest"] * (1.0 + verdicts.RESOLUTION)
    assert row["limit"]["associated"] == pytest.approx(row["associated"], rel=2e-4)
    assert {name for name, _ in verdicts.findings(row)} <= {verdicts.SILENT}


def made_up(**default):
    """A record in which all methods agree on 0.5, but for what is said of the default run."""
    answer = {"status": "ok", "failure_load": 0.5, "failure_load_bracket": [0.5, 0.501], "warnings": [], "seconds": 0.0}
    limit = {"associated": 0.52, "associated_status": "ok", "seconds": 0.0}
    answers = {"default": answer | default, "gravity": answer, "path": answer, "limit": answer}
    about = {"seed": 1, "title": "1: wall", "blocks": 9, "pattern": "mass", "seconds": 0.0}
    return about | {"associated": 0.52, "stands": True, "lowest": 0.49, "limit": limit, "answers": answers}


@pytest.mark.parametrize(
    ("default", "name"),
    [
        ({"failure_load": 0.53, "failure_load_bracket": [0.53, 0.531]}, verdicts.ABOVE),
        ({"failure_load": 0.48, "failure_load_bracket": [0.48, 0.481]}, verdicts.BELOW),
        ({"failure_load": 0.51, "failure_load_bracket": [0.51, 0.511]}, verdicts.SILENT),
        ({"status": "does not stand", "failure_load": None, "failure_load_bracket": None}, verdicts.STANDS_OR_FALLS),
        (
            {"status": "no failure up to 100", "failure_load": None, "failure_load_bracket": [100.0, None]},
            verdicts.ABOVE,
        ),
        ({"status": "an equilibrium exists", "failure_load": None, "equilibrium_load": 0.53}, verdicts.ABOVE),
        ({"status": "crashed: ValueError: no"}, verdicts.CRASHED),
        ({"status": "not converged", "failure_load": None}, verdicts.UNFINISHED),
    ],
)
def test_what_is_wrong_is_found(default, name):
    assert verdicts.findings(made_up()) == []
    assert name in [found for found, _ in verdicts.findings(made_up(**default))]


def test_a_range_that_holds_all_methods_is_a_word():
    off = {"failure_load": 0.51, "failure_load_bracket": [0.51, 0.511]}
    said = {"load_range": {"lowest": 0.5, "highest": 0.511, "why": "three histories"}}
    less = {"load_range": {"lowest": 0.507, "highest": 0.511, "why": "two histories"}}
    assert verdicts.findings(made_up(**off, **said)) == []
    assert [name for name, _ in verdicts.findings(made_up(**off, **less))] == [verdicts.SILENT]


def test_the_path_of_limit_analysis_is_a_method():
    row = made_up()
    agrees, differs = ({"limit": row["limit"] | {"non_associated": load}} for load in (0.5008, 0.49))
    assert verdicts.findings(row | agrees) == []
    assert [name for name, _ in verdicts.findings(row | differs)] == [verdicts.SILENT]


def test_what_is_kept_beside_the_page_says_the_same():
    for default in ({}, {"failure_load": 0.51, "failure_load_bracket": [0.51, 0.511]}):
        row = made_up(**default)
        assert verdicts.findings(study.shortened(row)) == verdicts.findings(row)
        assert page.line(study.shortened(row)) == page.line(row)


def test_other_faults():
    """Associated loads that differ; a structure that stands, or not, against what linear programs say."""
    row = made_up()
    assert verdicts.findings(row | {"limit": row["limit"] | {"associated": 0.521}})[0][0] == verdicts.ASSOCIATED
    falls = row | {"associated": None, "stands": False, "lowest": None}
    assert {name for name, _ in verdicts.findings(falls)} == {verdicts.STANDS_OR_FALLS, verdicts.ASSOCIATED}


def test_records_are_kept_and_not_done_again(tmp_path, capsys, monkeypatch):
    """The file holds every record as soon as it is there; the section of the page is made of them."""
    file = tmp_path / "rows.json"
    study.keep(file, {1: made_up(), 2: made_up(failure_load=0.53, failure_load_bracket=[0.53, 0.531]) | {"seed": 2}})
    assert study.STUDY.main(["--seeds", "1:3", "--json", str(file)]) == 1
    said = capsys.readouterr()
    assert f"{verdicts.ABOVE}: 1 (seeds 2)" in said.out
    assert f"2: {verdicts.ABOVE}: default: 0.53000 > 0.52000 (+1.92%)" in said.err
    monkeypatch.setattr(page.storage, "read", lambda name: {"structures": [made_up()]})
    assert "| wall | 1 | 0 |" in page.section()
    known = made_up(failure_load=0.519) | {"lowest": 0.52}
    monkeypatch.setattr(page.storage, "read", lambda name: {"structures": [known]})
    assert "| wall | 1 | 1 | 0.19% |" in page.section()  # 0.519 of 0.52
