"""Retired keys: read with a warning, then refused, each time with the new name, file, line and column."""

from __future__ import annotations

import pytest

from dem_cli.app import api
from dem_cli.case import retired_keys
from dem_cli.case.explain import find
from dem_cli.case.retired_keys import RETIRED, RetiredKey
from dem_cli.errors import CaseError, UsageError

CASE = """\
[materials.stone]
density = 2400.0

[joints.dry]
mu = 0.6

[[structure]]
kind = "wall"
block = [0.6, 0.3]
courses = 3
blocks_per_course = 2

[[structure.openings]]
x = 0.6
width = 0.6
sill = 0.0
height = 0.3

[analysis]
quick = true
"""
FRICTION = RetiredKey("joints.NAME.mu", "0.9.0", "friction")
SILL = RetiredKey("structure.openings.sill", "0.9.0", "y")
QUICK = RetiredKey("analysis.quick", "0.9.0", instead="runs are quick")


@pytest.fixture
def load(tmp_path, monkeypatch):
    """Reads a case with some keys retired; refused: no longer read."""

    def read(text=CASE, keys=(FRICTION, SILL, QUICK), refused=False, **changes):
        monkeypatch.setattr(retired_keys, "RETIRED", tuple(key._replace(refused=refused) for key in keys))
        (tmp_path / "case.toml").write_text(text, encoding="utf-8")
        monkeypatch.chdir(tmp_path)
        return api.load_case("case.toml", **changes)

    return read


def test_still_read_with_a_warning(load):
    loaded = load()
    assert loaded.case.joints["dry"].friction == 0.6
    assert loaded.case.structure[0].openings[0].y == 0.0
    later = "; a later version will refuse it"
    assert loaded.warnings[:3] == [
        f"case.toml:5:1: joints.dry.mu: retired in version 0.9.0: its name is 'friction'{later}",
        f"case.toml:16:1: structure.0.openings.0.sill: retired in version 0.9.0: its name is 'y'{later}",
        f"case.toml:20:1: analysis.quick: retired in version 0.9.0: runs are quick{later}",
    ]


def test_refused_with_all_other_mistakes(load):
    with pytest.raises(CaseError) as error:
        load(CASE.replace("courses = 3", "courses = 0"), refused=True)
    said = str(error.value).splitlines()
    assert said[0] == "case.toml:5:1: joints.dry.mu: retired in version 0.9.0: its name is 'friction'"
    assert [line.split(": ")[1] for line in said[1:]] == [
        "structure.0.courses",
        "structure.0.openings.0.sill",
        "analysis.quick",
    ]


def test_a_wrong_value_under_the_old_name_is_one_mistake(load):
    with pytest.raises(CaseError) as error:
        load(CASE.replace("mu = 0.6", "mu = -1.0"))
    assert str(error.value).startswith("case.toml:4:1: joints.dry.friction: -1 is not allowed")


def test_beside_its_new_name(load):
    with pytest.raises(CaseError, match=r"case.toml:5:1: joints.dry.mu: not allowed beside 'friction', which is its"):
        load(CASE.replace("mu = 0.6", "mu = 0.6\nfriction = 0.6"))


def test_what_is_set(load):
    loaded = load(overrides=["joints.dry.mu=0.5"])
    assert loaded.case.joints["dry"].friction == 0.5
    assert loaded.warnings[0].startswith("--set joints.dry.mu: retired in version 0.9.0")


def test_what_is_set_counts_more_than_the_new_name_in_the_file(load):
    loaded = load(CASE.replace("mu = 0.6", "friction = 0.6"), overrides=["joints.dry.mu=0.5"])
    assert loaded.case.joints["dry"].friction == 0.5
    assert loaded.warnings[0].startswith("--set joints.dry.mu: retired in version 0.9.0")


@pytest.mark.parametrize("query", ["mu", "joints.dry.mu"])
def test_explained_by_the_new_name(load, query):
    load()
    with pytest.raises(UsageError, match=f"{query}: retired in version 0.9.0: its name is 'friction'"):
        find(api.make_case_model(), query)


def test_without_retired_keys_they_are_unknown(load):
    with pytest.raises(CaseError, match=r"joints.dry.mu: unknown key"):
        load(keys=())


def test_new_names_exist():
    names = [f"{old.path.rpartition('.')[0]}.{old.name}".strip(".") for old in RETIRED if old.name]
    assert all(find(api.make_case_model(), name) for name in names)
