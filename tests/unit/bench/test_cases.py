"""The benchmarked structures are those of cases/verification, and their loads those of limit analysis."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from bench.cases import FOLDER, KNOWN_STRUCTURES, SIZES, answer
from bench.kernels import blocks_of
from oracle.limit_lp import frictionless_heads, limit_load

from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.limit.analysis import limit_loads
from dem_cli.masonry.assembly.solver_request import solver_request

CASES = Path(__file__).resolve().parents[3] / "cases" / "verification"
COMPUTED = [*KNOWN_STRUCTURES.values(), *(known for known in SIZES if blocks_of(known) <= 231)]


def oracle(known, heads):
    case, model = known.build()
    friction = case.joints["dry"].friction
    starts, parts = model.part_starts, model.part_blocks
    polygons = [model.vertices[starts[p] : starts[p + 1]] + model.centroids[parts[p]] for p in range(model.n_parts)]
    law = friction if heads else frictionless_heads(friction)
    return limit_load(polygons, model.fixed, law, weights=-model.dead_loads[:, 1]).multiplier


@pytest.mark.parametrize("known", COMPUTED, ids=lambda known: known.name)
def test_loads_are_those_of_the_oracle(known):
    """Closed forms and limit loads to six digits; arches have no head joints, but steep joints."""
    assert known.load == pytest.approx(oracle(known, heads=known.file == "arch"), abs=1e-6)


@pytest.mark.parametrize("known", [k for k in COMPUTED if k.upper], ids=lambda known: known.name)
def test_associated_loads(known):
    assert known.upper == pytest.approx(oracle(known, heads=True), abs=1e-6)
    assert known.upper > known.load


@pytest.mark.parametrize("known", [k for k in COMPUTED if k.path], ids=lambda known: known.name)
def test_zero_dilation_loads(known):
    case, model = known.build()
    path = limit_loads(
        model, joint_properties(solver_request(case), model), law_of(solver_request(case))
    ).non_associated
    assert path.load == pytest.approx(known.path, rel=1e-4)
    assert known.error(0.5 * (known.load + known.path)) == 0.0
    assert known.error(1.01 * max(known.path, known.load)) == pytest.approx(0.01)
    assert known.error(0.99 * min(known.path, known.load)) == pytest.approx(-0.01)


@pytest.mark.parametrize(("mine", "theirs"), [("wall", "wall_21"), ("column", "column_14"), ("arch", "arch_21")])
def test_structures_are_the_published_ones(mine, theirs):
    both = [tomllib.loads(path.read_text("utf-8")) for path in (FOLDER / f"{mine}.toml", CASES / f"{theirs}.toml")]
    for tables in both:
        tables["structure"][0].pop("material", None)
    assert [both[0][key] for key in ("materials", "joints", "structure")] == [
        both[1][key] for key in ("materials", "joints", "structure")
    ]


@pytest.mark.parametrize("known", [k for k in SIZES if blocks_of(k) < 1000], ids=lambda known: known.name)
def test_walls_have_as_many_blocks_as_they_say(known):
    _, model = known.build()
    assert np.count_nonzero(~model.fixed) == blocks_of(known)


def test_an_answer_that_is_none_says_why():
    known = KNOWN_STRUCTURES["COL14"]
    found = answer(known, {"status": "not converged", "failure_load": None, "steps": 9, "warnings": ["a", "gave up"]})
    assert (found["error"], found["status"], found["warning"]) == (None, "not converged", "gave up")
    assert answer(known, {"status": "ok", "failure_load": known.load, "steps": 9}) == {
        "load": known.load, "error": 0.0, "steps": 9,
    }  # fmt: skip
