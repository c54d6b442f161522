"""Bounds of joints that do not dilate: lower ≤ least ≤ path, DEM ≤ associated; enumerated, and by a program apart."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from casefiles import CASES, read
from engine import block, rectangle, solve, tables
from engine.limits import on_a_base, solved
from scipy.optimize import linprog
from studies import storage
from studies.bounds import tables as bound_tables
from studies.bounds.study import STUDY
from studies.places import DOCS
from studies.stress.random_structures.admissible import LoadedBodies, associated_load, lowest_load

from dem_cli.core.limit.reduced import NONE

VERIFICATION = CASES / "verification"
SAME = 2e-6  # relative, of loads that are the same
RESOLUTION = 0.002  # of DEM's load


def bounded(case, *overrides, bounds=("lower", "least")):
    return solved(case, overrides=overrides, bounds=bounds, associated_only=False)


@pytest.mark.parametrize("name", ["sliding_block", "column_14", "trilith", "portal", "lever"])
def test_one_load_is_left_where_all_bounds_meet(name):
    """Columns, arches, portals: every mechanism is that of the associated load."""
    found = bounded(VERIFICATION / f"{name}.toml")
    load = found.associated.multiplier
    assert found.lower.multiplier == pytest.approx(load, rel=1e-3)
    assert found.lower.multiplier <= found.associated.upper
    assert (found.least.least_of, found.least.multiplier) == ("all", pytest.approx(load, rel=SAME))
    assert found.least.proved == pytest.approx(load, rel=2e-4)
    assert found.non_associated.load == pytest.approx(load, rel=1e-5)


@pytest.mark.parametrize("name", ["arch_21_mu040", "portal"])
def test_lower_bound_against_a_program_apart(name):
    """scripts/studies/stress has one of its own, from the polygons on."""
    file = VERIFICATION / f"{name}.toml"
    bodies = LoadedBodies.of(read(file))
    theirs = lowest_load(bodies, associated_load(bodies))
    ours = bounded(file, bounds=("lower",)).lower.multiplier
    assert ours == pytest.approx(theirs, rel=2e-3)


def test_the_path_that_rests_below_what_nothing_collapses_under():
    """Its first plateau, at 1.2150, is none: the load grows further on, and DEM reaches 1.2168."""
    found = bounded(VERIFICATION / "arch_segmental_mu050.toml")
    assert found.least.least_of == "all"
    assert found.lower.multiplier < found.non_associated.load < found.least.multiplier * (1 + SAME)
    assert found.least.multiplier == pytest.approx(found.associated.multiplier, rel=1e-6)


def side_by_side(friction: float, heights: tuple[float, float], pushed: float = 1.0) -> dict:
    """Two blocks that lean on each other: beds and a head joint; the left one is pushed more than the other."""
    blocks = [
        block("left", rectangle(0.0, 0.0, 0.4, heights[0])),
        block("right", rectangle(0.4, 0.0, 1.0, heights[1])),
    ]
    loads = [
        {"block": name, "force": [force, 0.0], "kind": "live"} for name, force in (("left", 1.0), ("right", pushed))
    ]
    return on_a_base(*blocks, friction=friction, load=loads, analysis={"pattern": "live"})


@pytest.mark.parametrize(("friction", "heights"), [(0.8, (1.2, 0.4))])
def test_least_load_against_every_mechanism(friction, heights):
    """All openings and slips of two blocks, tried one by one."""
    case = side_by_side(friction, heights, pushed=0.3)
    found = bounded(case)
    assert found.least.least_of == "all"
    assert found.least.bounded
    assert found.least.multiplier == pytest.approx(by_enumeration(found.structure, friction), rel=1e-6)
    assert found.lower.multiplier <= found.least.multiplier * (1 + SAME) <= found.associated.upper * (1 + 2 * SAME)


def by_enumeration(structure, friction: float) -> float:
    """The least of the linear programs of all choices: points shut or open, joints stuck or sliding either way."""
    owners = structure.joints.owners
    n, joints = len(owners), np.unique(owners)
    opening, sliding = structure.compatibility[0::2].toarray(), structure.compatibility[1::2].toarray()
    weight = float(structure.scales[0])
    best = np.inf
    for opens in product((False, True), repeat=n):
        for slips in product((0, 1, -1), repeat=len(joints)):
            if moves(structure, opening, sliding, opens, slips, owners, joints):
                best = min(best, least_forces(structure, friction, opens, slips, owners, joints, weight))
    return best


def moves(structure, opening, sliding, opens, slips, owners, joints) -> bool:
    """Whether some mechanism opens and slides no more than these, with positive power of the live loads."""
    equal = [opening[p] for p in range(len(owners)) if not opens[p]]
    above = [-opening[p] for p in range(len(owners)) if opens[p]]
    for joint, slip in zip(joints, slips, strict=True):
        row = sliding[np.flatnonzero(owners == joint)[0]]
        (above if slip else equal).append(-slip * row if slip else row)
    equal = np.array([*equal, structure.live])
    rows = {"A_ub": np.array(above), "b_ub": np.zeros(len(above))} if above else {}
    found = linprog(
        np.zeros(len(structure.free)), **rows, bounds=(None, None),
        A_eq=equal, b_eq=np.append(np.zeros(len(equal) - 1), 1.0),
    )  # fmt: skip
    return found.status == 0


def least_forces(structure, friction, opens, slips, owners, joints, weight) -> float:
    """The least multiplier of forces that are nothing where joints open and at the limit where they slide."""
    n = len(owners)
    columns = structure.compatibility.T.toarray()  # N and T of each point in turn
    balance = np.column_stack([columns, structure.live])
    bounds = [bound for p in range(n) for bound in ((0.0, 0.0 if opens[p] else None), (None, None))]
    rows, equal = [], []
    for p in range(n):
        normal, shear = np.zeros(2 * n + 1), np.zeros(2 * n + 1)
        normal[2 * p], shear[2 * p + 1] = friction, 1.0
        slip = slips[int(np.flatnonzero(joints == owners[p])[0])]
        if slip:
            equal.append(normal + slip * shear)
        rows += [shear - normal, -shear - normal]
    found = linprog(
        np.append(np.zeros(2 * n), 1.0), A_ub=np.array(rows), b_ub=np.zeros(len(rows)),
        A_eq=np.vstack([balance / weight, *equal]), b_eq=np.append(-structure.dead / weight, np.zeros(len(equal))),
        bounds=[*bounds, (0.0, None)],
    )  # fmt: skip
    return float(found.fun) if found.status == 0 else np.inf


def random_structure(seed: int) -> dict:
    """Two piles of one to three blocks, of random sizes, under a beam; friction 0.4 to 0.9."""
    rng = np.random.default_rng(seed)
    top, blocks = 0.9, []
    for pile, left in enumerate((0.0, 1.2)):
        cuts = np.sort(rng.uniform(0.2, 0.7, rng.integers(0, 3)))
        levels = [0.0, *cuts[np.diff(cuts, prepend=0.0) > 0.1], top]
        widths = np.sort(rng.uniform(0.25, 0.6, len(levels) - 1))[::-1]
        for i, (low, high) in enumerate(zip(levels, levels[1:])):
            blocks.append(block(f"b{pile}{i}", rectangle(left - widths[i] / 2, low, left + widths[i] / 2, high)))
    blocks.append(block("beam", rectangle(-0.15, top, 1.35, top + rng.uniform(0.15, 0.4))))
    return on_a_base(*blocks, friction=float(rng.uniform(0.4, 0.9)))


@pytest.mark.parametrize("seed", range(4))
def test_dem_is_between_the_bounds(seed):
    case = random_structure(seed)
    found = bounded(case)
    low, high = solve(case)[0]["failure_load_bracket"]
    assert found.lower.multiplier <= high * (1 + SAME)
    assert found.least.multiplier <= high * (1 + SAME)
    assert low <= found.associated.upper * (1 + RESOLUTION)
    assert found.least.least_of == "all"
    assert found.lower.multiplier <= found.least.multiplier * (1 + SAME)


STRONG = {
    "cohesion": {"law": "mohr-coulomb", "friction": 0.5, "cohesion": 2e3, "cohesion_residual": 2e3},
    "tension": {"law": "mohr-coulomb", "friction": 0.8, "cohesion": 6e3, "tension": 3e3,
                "cohesion_residual": 6e3, "tension_residual": 3e3},
}  # fmt: skip


@pytest.mark.parametrize("name", STRONG)
def test_dem_of_stronger_joints_is_between_their_bounds(name):
    """A pile of two blocks that slides as it opens, or is held down."""
    blocks = [block("a", rectangle(0.0, 0.0, 0.6, 0.5)), block("b", rectangle(0.0, 0.5, 0.6, 1.0))]
    case = on_a_base(*blocks, joints={"dry": STRONG[name]})
    found = bounded(case)
    low, high = solve(case, "analysis.limit=true")[0]["failure_load_bracket"]
    assert low <= found.associated.upper * (1 + RESOLUTION)
    assert found.lower.multiplier <= high * (1 + SAME)
    assert found.least.multiplier <= high * (1 + SAME)
    assert found.least.least_of == "all"
    if name != "cohesion":  # there points that open lose theirs, and the pile slides on what is left
        assert high == pytest.approx(found.associated.multiplier, rel=0.004)
        assert found.least.multiplier == pytest.approx(found.associated.multiplier, rel=1e-5)


def test_a_reduced_domain_that_does_not_stand_bounds_nothing():
    """A block that hangs on a bond of which nothing is left when it breaks."""
    found = bounded(VERIFICATION / "tension_block.toml", bounds=("lower",)).lower
    assert (found.status, found.multiplier) == (NONE, None)


def test_least_load_of_a_row_that_wedges():
    """Dilating joints hold a pile between two others; a quarter less is enough for those that do not."""
    case = tables(
        block("base", rectangle(-1.0, -1.0, 3.0, 0.0), fixed=True),
        *(
            block(f"b{i}{k}", rectangle(0.3 * i, 0.5 * k, 0.3 * (i + 1), 0.5 * (k + 1)))
            for i in range(2)
            for k in range(2)
        ),
    )
    found = bounded(case)
    assert found.least.multiplier <= found.non_associated.load * (1 + SAME)
    assert found.least.multiplier == pytest.approx(0.3, rel=1e-5)  # b/h of one pile
    assert found.associated.multiplier > 0.35


def test_the_page_is_made_from_its_json():
    assert (DOCS / "bounds.md").read_text(encoding="utf-8") == STUDY.page(storage.read("bounds"))


@pytest.mark.parametrize("name", STUDY.sections)
def test_no_row_of_the_page_contradicts_a_bound(name):
    row = storage.read("bounds")[name]
    assert bound_tables.problems(row) == []


def test_a_contradiction_is_seen():
    row = {"dem": [0.5, 0.501], "associated": 0.52, "lower_bound": 0.4, "least": 0.45, "least_of": "all"}
    assert bound_tables.problems(row) == []
    wrong = ({"associated": 0.49}, {"lower_bound": 0.51, "least": None}, {"least": 0.51}, {"lower_bound": 0.46})
    assert all(bound_tables.problems(row | one) for one in wrong)
