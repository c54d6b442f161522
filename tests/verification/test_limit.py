"""`dem_cli.core.limit` against the oracle on every pushover case, against the data book, and between its own bounds."""

from __future__ import annotations

import numpy as np
import pytest
from casefiles import CASES, FILES, case_id, known_to_the_oracle, read, scene
from engine.limits import solved
from reference import result, value

from dem_cli.core.limit.associated import FALLS, LOCKED, OK

PUSHOVERS = [
    path for path in FILES
    if read(path).get("analysis", {}).get("kind", "pushover") == "pushover" and known_to_the_oracle(path)
]  # fmt: skip
CLOSE = 2e-6  # relative: the oracle's own tolerances reach that far on walls of 231 blocks
HALF_DIGIT = 5e-5  # of a value printed with four digits
AT_45 = {"groove"}  # its joints are neither heads nor beds, and the oracle draws the line on the other side


@pytest.mark.parametrize("heads", [True, False], ids=["heads", "no-heads"])
@pytest.mark.parametrize("path", PUSHOVERS, ids=case_id)
def test_every_case_agrees_with_the_oracle(path, heads):
    if path.stem in AT_45 and not heads:
        heads = True
    expected = scene(path).limit(heads).multiplier
    found = solved(path, heads_frictionless=not heads).associated
    if np.isnan(expected):
        assert found.status == FALLS
    elif np.isinf(expected):
        assert found.status == LOCKED
    else:
        assert found.status == OK
        assert found.multiplier == pytest.approx(expected, rel=CLOSE, abs=1e-9)
        assert found.lower - 1e-9 <= expected * (1 + CLOSE)
        assert found.upper + 1e-9 >= expected * (1 - CLOSE)


@pytest.mark.parametrize("friction", [0.5, 0.6, 0.65, 0.7, 0.75, 1.0])
def test_wall_of_21_blocks(friction):
    """Thesis Table 5-3 has head joints without friction; the associated load with it lies above."""
    path = CASES / "verification" / ("wall_21.toml" if friction == 0.6 else f"wall_21_mu{100 * friction:03.0f}.toml")
    for name, frictionless in ((f"lambda_lp_mu{friction:.2f}", True), (f"lambda_lp_assoc_mu{friction:.2f}", False)):
        row = result("thesis_21_block_wall", name)
        found = solved(path, heads_frictionless=frictionless).associated
        assert found.multiplier == pytest.approx(row["value"], abs=row["tolerance"])


@pytest.mark.parametrize("number", [1, 2, 3])
def test_walls_of_ten_blocks(number):
    path = CASES / "verification" / f"wall_{number}.toml"
    for name, frictionless in ((f"WALL{number}_lp", True), (f"WALL{number}_lp_assoc", False)):
        found = solved(path, heads_frictionless=frictionless).associated
        assert found.multiplier == pytest.approx(value("thesis_walls_1_2_3", name), abs=HALF_DIGIT)


@pytest.mark.parametrize(
    "name", ["wall_21_mu075", "wall_with_door", "arch_21_mu040", "portal", "groove", "arch_point_load"]
)
def test_the_mechanism_dissipates_nothing_and_works_as_the_loads_do(name):
    """Associated flow: forces and motions of the joints are at right angles, point by point."""
    found = solved(CASES / "verification" / f"{name}.toml")
    s, answer = found.structure, found.associated
    motion = (s.compatibility @ answer.velocities.ravel()[s.free]).reshape(-1, 2)
    work = answer.normal * motion[:, 0] + answer.shear[:, 0] * motion[:, 1]
    assert np.abs(work).sum() < 1e-5 * answer.multiplier  # which is the power of the live loads
    assert -s.dead @ answer.velocities.ravel()[s.free] == pytest.approx(answer.multiplier, rel=1e-5)


def test_a_wall_of_2275_blocks():
    """Against HiGHS it would take minutes; the bounds, which both come from the answer's own forces, must do."""
    sizes = ["structure.0.courses=70", "structure.0.blocks_per_course=32"]
    found = solved(CASES / "verification" / "wall_21.toml", overrides=sizes).associated
    assert found.status == OK
    assert found.upper - found.lower < 1e-5 * found.multiplier
