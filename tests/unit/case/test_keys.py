"""Every key of a case file says what it means, in which unit, and has an example that is valid."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from pydantic import Field, TypeAdapter, ValidationError

from dem_cli.app.api import make_case_model
from dem_cli.case.base import CaseModel, Positive
from dem_cli.case.explain import DOC_PAGES, entries, find
from dem_cli.case.keys import KNOWN_UNITS, CaseTable, tables, toml
from dem_cli.errors import UsageError
from dem_cli.masonry.structures.registry import GENERATORS

MODEL = make_case_model()
TABLES = tables(MODEL)


def label(table: CaseTable) -> str:
    return "-".join([".".join(table.path) or "case", *table.kinds[:1]])


def mistakes(table: CaseTable, values: dict) -> set:
    """Keys whose values are refused; those that are missing are not among them unless they are needed by another."""
    try:
        TypeAdapter(table.declared).validate_python(values)
    except ValidationError as error:
        return {item["loc"][0] for item in error.errors() if item["loc"]}
    return set()


class Box(CaseModel):
    """[box]: of a test.

    More about it.
    """

    width: Positive = Field(description="width of it [m]; default: as high")
    share: float | None = Field(default=None, gt=0.0, lt=1.0, description="a share [-]", examples=[0.5])
    size: tuple[float, float] = Field(default=(1.0, 2e7), description="of [x, y] [m]")


def test_what_a_key_is_made_of():
    box, *none = tables(Box)
    width, share, size = box.keys
    assert not none
    assert (box.about, box.heading) == ("of a test.\nMore about it.", "[]")
    assert (width.meaning, width.units, width.default, width.required) == ("width of it", ("m",), "as high", True)
    assert (share.units, share.allowed, share.default, share.example) == (
        ("-",), "a number > 0 and < 1", "", "share = 0.5",
    )  # fmt: skip
    assert (size.meaning, size.default, size.example) == ("of [x, y]", "[1.0, 2e7]", "size = [1.0, 2e7]")


@pytest.mark.parametrize("value", [1e5, 123456.5, 2.5e-7, 5e10, -3e8, 0.6, True, 7, 'a "b"', [1.0, [2e6]], {"a": 1.0}])
def test_values_survive_being_written(value):
    assert tomllib.loads(f"x = {toml(value)}")["x"] == value


@pytest.mark.parametrize("table", TABLES, ids=label)
def test_every_key_says_what_it_means_and_in_which_unit(table):
    for key in table.keys:
        assert len(key.meaning) > 3, f"{key.path} needs a description"
        if key.numeric:
            assert key.units, f"{key.path} needs a unit in its description: one of {', '.join(KNOWN_UNITS)}"


@pytest.mark.parametrize("table", TABLES, ids=label)
def test_every_key_has_an_example_that_is_valid(table):
    for key in table.keys:
        if key.only_tables and not key.example:
            continue
        assert key.example, f"{key.path} needs examples = [...]"
        assert key.name not in mistakes(table, tomllib.loads(key.example)), key.example


def test_names_of_the_user_and_lists_are_seen():
    headings = {table.heading for table in TABLES}
    assert {"[materials.NAME]", "[[structure.openings]]", "[structure.openings.lintel]", "[motion]"} <= headings
    laws = next(table.kinds for table in TABLES if table.heading == "[joints.NAME.profile]")
    assert {"coulomb", "elastic"} <= set(laws)


@pytest.mark.parametrize(
    ("query", "paths"),
    [
        ("joints.friction", ["joints.NAME.friction"]),
        ("joints.dry.friction", ["joints.NAME.friction"]),
        ("[joints.dry] friction", None),
        ("friction", ["joints.NAME.friction", "analysis.perturb.friction"]),
        ("structure.arch.thickness", ["structure.thickness"]),
        ("structure.0.openings.1.width", ["structure.openings.width"]),
        ("openings.width", ["structure.openings.width", "structure.walls.openings.width"]),
        ("[[structure]]", ["structure"] * len(GENERATORS)),
        ("joints.barton", ["joints.NAME"]),
        ("barton", ["joints.NAME"]),
        ("materials.peperino", ["materials.NAME"]),
        ("materials.density", ["materials.NAME.density"]),
        ("imperfection.height", ["imperfection.height", "imperfection.height"]),
        ("gravity", ["gravity"]),
    ],
)
def test_what_is_meant(query, paths):
    if paths is None:
        with pytest.raises(UsageError):
            find(MODEL, query)
    else:
        assert [entry.path for entry in find(MODEL, query)] == paths


def test_keys_that_say_the_same_are_told_once():
    friction = find(MODEL, "joints.friction")[0]
    assert len(friction.kinds) > 3
    assert [entry.kinds for entry in find(MODEL, "joints.barton.kn")] == [("barton",)]
    assert {entry.kinds for entry in find(MODEL, "analysis.resolution")} >= {("pushover",), ("fragility",)}


@pytest.mark.parametrize(
    ("query", "hint"),
    [("joints.frcition", "'joints.friction'"), ("analysis.margn", "'analysis.margin'"), ("ghsdf", "`dem explain`"),
     ("", "`dem explain`"), ("joints.dry.coehsion", "'joints.cohesion'"), ("gravity.x", "")],
)  # fmt: skip
def test_what_is_unknown(query, hint):
    with pytest.raises(UsageError, match="no key") as error:
        find(MODEL, query)
    assert hint in str(error.value)


def test_every_page_exists():
    root = Path(__file__).resolve().parents[3]
    pages = {entry.page for entry in entries(MODEL)}
    assert len(pages) > 10
    assert not [page for page in pages if not (root / page).exists()]
    found = {".".join(table.path) for table in TABLES} | {f"{t.path[0]}.{k}" for t in TABLES for k in t.kinds if t.tag}
    assert {name.split(".NAME")[0] for name in DOC_PAGES} <= {name.split(".NAME")[0] for name in found}
