"""docs/chapter6.md is made from its JSON; the column and the arch of the shaking table do what the thesis found.

Tolerances are those of the source: 5 % of a restitution (6.1), and the seventh by which its rotation differs from
its own test (0.008 against 0.007 rad, 6.2.1, "compares reasonably well").
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from reference import book, value
from studies import storage
from studies.chapter6 import arch, blocks, column, family, records, shaken_case
from studies.chapter6.study import STUDY

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
CASES = sorted((ROOT / "cases" / "validation").glob("arch_8_*.toml"))
TABLE, TEXT = storage.read("chapter6"), (DOCS / "chapter6.md").read_text(encoding="utf-8")
RESTITUTION, ROTATION = 0.05, 1.0 / 7.0


def thesis(name: str) -> float:
    return value("thesis_arch_shaking", name)


def thesis_collapses(name: str) -> bool:
    """harm_5_15 is about steady oscillation, the others about collapse."""
    return thesis(name) is True and name != "harm_5_15"


def test_the_page_is_made_from_its_json():
    assert list(TABLE) == list(STUDY.sections)
    assert STUDY.page(TABLE) == TEXT


def test_pictures_are_there():
    named = set(re.findall(r"\]\((chapter6_\w+\.png)\)", TEXT))
    drawn = {f"chapter6_{suffix}.png" for suffix in STUDY.pictures}
    assert named == drawn
    assert all((DOCS / name).stat().st_size > 10_000 for name in named)


def test_every_case_is_there():
    cases = set(re.findall(r"dem run (\S+\.toml)", TEXT))
    assert len(cases) >= 5
    assert all((ROOT / case).exists() for case in cases)


def test_restitution_of_the_column():
    found = shaken_case.run("column_arch_rocking", "output.frames=0")
    swings = np.concatenate([[column.TILT], shaken_case.extremes(found.times, found.values[:, 0])[1][:4]])
    heights = np.cos(column.ALPHA - swings) - np.cos(column.ALPHA)
    assert (heights[1:] / heights[:-1]).mean() == pytest.approx(thesis("col_r_dem"), rel=RESTITUTION)


@pytest.mark.parametrize("a", [0.98, thesis("col_onset")])
def test_the_column_does_not_rock_below_its_static_load(a):
    assert not column._rocks(a, ("motion.duration=6.0",))


def test_the_column_rocks_as_far_as_in_the_thesis():
    row = column._level(1.02, "from a tilt of 0.008 rad")
    assert row["amplitude"] == pytest.approx(thesis("col_rot_dem"), rel=ROTATION)


def test_one_arch_in_all_cases():
    """That of the data book, on the same joints and dashpots."""
    segment = book("thesis_arch_shaking")["geometry"]["segmental"]
    first = tomllib.loads(CASES[0].read_text(encoding="utf-8"))
    arch_table = first["structure"][0]
    assert arch_table["included_angle_deg"] == segment["included_angle_deg"]
    assert arch_table["voussoirs"] == segment["voussoirs"]
    assert arch_table["inner_radius"] == segment["inner_radius_m"]
    assert arch_table["ring"] == segment["ring_thickness_m"]
    for path in CASES[1:]:
        case = tomllib.loads(path.read_text(encoding="utf-8"))
        case["joints"]["dry"].pop("points", None)  # two, which is what all of them have
        assert [case[key] for key in ("materials", "joints", "structure")] == [
            first[key] for key in ("materials", "joints", "structure")
        ], path.stem


def test_the_static_mechanism():
    """One column rocks, one joint slides, several open (6.2.2.2); the load itself gave the inner radius."""
    mechanism = TABLE["arch"]["static"]["arch of 120°"]["mechanism"]
    found = shaken_case.run("arch_8_static").answer["mechanism"]
    assert found == mechanism
    assert found["sliding_joints"]["count"] == 1
    assert found["opening_joints"]["count"] >= 3


@pytest.mark.parametrize("name", [name for name in arch.TRIED if name != arch.FALLS])
def test_the_arch_stands_as_in_the_thesis(name):
    found = arch.outcome(name)
    assert found["collapsed"] is thesis_collapses(name) is False
    if name == "harm_5_15":  # crown lower, columns tilted outward: counter-clockwise on the left
        assert found["crown"] > 0.0
        assert found["left"] > 0.0 > found["right"]


def test_the_arch_falls_as_in_the_thesis():
    """a = 1.1 is near the edge at 2.5 Hz: most of some slightly different structures."""
    repeats = arch.perturbed(arch.FALLS, repeats=10)["repeats"]
    assert thesis_collapses(arch.FALLS)
    assert repeats["collapsed"] > repeats["runs"] / 2


def test_the_semicircle_falls_where_it_should_stand():
    """Same load, same columns: the outcomes tell arches apart."""
    assert arch.outcome("harm_5_15", *arch.SEMICIRCLE)["collapsed"] is True


def test_restitution_falls_towards_housner():
    means = blocks.means_of(TABLE["blocks"])
    for row in blocks._housner().values():
        ratios = [means[row["aspect"], zeta] for zeta in blocks.FRACTIONS]
        assert ratios == sorted(ratios, reverse=True)
    assert means[2.0, 0.35] == pytest.approx(thesis("col_r_dem"), rel=RESTITUTION)


def test_the_page_owns_up_to_every_difference():
    for name, (frequency, a) in arch.TRIED.items():
        ours, stands = TABLE["arch"]["harmonic"][name]["collapsed"], name != "harm_25"
        line = next(line for line in TEXT.split("\n") if line.startswith(f"| {frequency:g} Hz, a = {a:g} |"))
        assert ("**no**" in line) == (ours == stands)


def test_the_case_is_one_of_a_family():
    """An arch of it again, radius and outcome; more than one meets all that is printed, and no semicircle does."""
    members = {(one["angle"], one["ring"]): one for one in TABLE["family"]}
    complete = {key for key, one in members.items() if family.one_slides(one) and family.met(one["motions"]) == 4}
    assert (120, 0.10) in complete
    assert len(complete) > 1
    assert all(family.met(one["motions"]) < 3 for (angle, _), one in members.items() if angle == 180)
    other = members[110, 0.10]
    assert family.radius_of(110, 0.10) == other["radius"]
    assert family.load_of(other["static"]) == pytest.approx(thesis("static_exp_num"), rel=0.005)


def test_records_collapse_it_in_the_range_of_the_thesis():
    """Mean within a level of 0.05 of the printed one."""
    found = records.capacities(TABLE["records"]["20 s"])
    assert found.mean() == pytest.approx(thesis("dem_mean"), abs=0.05)


def test_the_length_of_records_does_not_explain_the_tests():
    """The thesis says so of 2.85 against 1.27 (6.2.2.2); a tenth of it is more than we find."""
    short, long = (records.capacities(TABLE["records"][name]).mean() for name in ("8 s", "20 s"))
    assert abs(short / long - 1.0) < 0.1 * (thesis("overlap_mean") / thesis("dem_mean") - 1.0)
