"""Associated loads by the interior point on fronts: those of Clarabel, and the same proofs where it leads nowhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from engine import block, rectangle, running_wall, scene, tables
from engine.limits import on_a_base, tower

from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.limit import fronts
from dem_cli.core.limit.analysis import start_structure
from dem_cli.core.limit.associated import FALLS, LOCKED, OK, associated_limit
from dem_cli.core.limit.cone import envelope_of
from dem_cli.core.limit.settings import DEFAULT_LIMIT

CLARABEL, ON_FRONTS = DEFAULT_LIMIT.associated, replace(DEFAULT_LIMIT.associated, on_fronts=0)

DOWN = {"block": "b", "force": [0.1, -1.0], "kind": "live"}


def both(case):
    """What Clarabel finds, and what the interior point on fronts does."""
    made = scene(case)
    law = law_of(made.request)
    structure = start_structure(made.model, joint_properties(made.request, made.model), law)
    strength = envelope_of(structure.joints, law, bonds=structure.bonds)
    return [associated_limit(structure, strength, settings) for settings in (CLARABEL, ON_FRONTS)]


@pytest.mark.parametrize("friction", [0.0, 0.6, 1.1])
@pytest.mark.parametrize("dissected", [2000, 2])
def test_both_solvers_find_the_same_load(friction, dissected, monkeypatch):
    """Bounds of either are 1e-4 apart at most and lie round the same load; forces balance."""
    monkeypatch.setattr(fronts, "DISSECTED", dissected)
    reference, found = both(tables(*running_wall(9, 8), friction=friction))
    assert (reference.status, found.status) == (OK, OK)
    assert found.residual <= CLARABEL.residual
    assert max(found.lower, reference.lower) <= min(found.upper, reference.upper) + 1e-9
    assert found.multiplier == pytest.approx(reference.multiplier, rel=3e-5, abs=1e-8)


@pytest.mark.parametrize(
    ("case", "status"),
    [
        (on_a_base(*tower(1), block("far", rectangle(3.0, 3.0, 4.0, 4.0))), FALLS),
        (on_a_base(block("b", rectangle(0.0, 0.0, 1.0, 0.2)), load=[DOWN], analysis={"pattern": "live"}), LOCKED),
    ],
)
def test_proofs_are_left_to_the_other_solver(case, status):
    assert [found.status for found in both(case)] == [status, status]


def test_nested_dissection_orders_every_block_once_with_little_fill(monkeypatch):
    """A square of blocks, where minimum degree does better than on walls."""
    side = 30
    number = np.arange(side * side).reshape(side, side)
    pairs = np.concatenate([np.column_stack([number[:, :-1].ravel(), number[:, 1:].ravel()]),
                            np.column_stack([number[:-1].ravel(), number[1:].ravel()])])  # fmt: skip
    places = np.stack(np.meshgrid(np.arange(side), np.arange(side), indexing="ij"), -1).reshape(-1, 2).astype(float)
    by_degree = fronts.fronts_of(pairs, side * side, 3, places)
    monkeypatch.setattr(fronts, "DISSECTED", 2)
    dissected = fronts.fronts_of(pairs, side * side, 3, places)
    assert np.array_equal(np.sort(dissected.order), np.arange(side * side))
    assert dissected.start[-1] < 1.5 * by_degree.start[-1]  # in running bond 0.8 to 0.9 of it
    assert not np.array_equal(dissected.order, by_degree.order)
