"""From a file to a case: names filled in, doubts, overrides."""

from __future__ import annotations

import pytest

from dem_cli.app.api import build_model, load_case
from dem_cli.case.overrides import literal, parse
from dem_cli.errors import CaseError, CaseProblem, UsageError

WALL = """\
[materials.stone]
density = 2000.0
[joints.dry]
friction = 0.6
[[structure]]
kind = "wall"
block = [1.0, 0.5]
courses = 3
blocks_per_course = 2
"""
SECOND = '[[structure]]\nkind = "wall"\nblock = [1, 0.5]\ncourses = 1\nblocks_per_course = 1\norigin = [9, 0]\n'


@pytest.fixture
def case_file(tmp_path, monkeypatch):
    """A function that writes case.toml and gives its name."""
    monkeypatch.chdir(tmp_path)

    def write(text: str) -> str:
        (tmp_path / "case.toml").write_text(text, encoding="utf-8")
        return "case.toml"

    return write


def test_what_may_be_left_out_is_filled_in(case_file):
    case = load_case(case_file(WALL + SECOND)).case
    assert case.title == "case"
    assert [(structure.id, structure.material) for structure in case.structure] == [
        ("wall", "stone"),
        ("wall2", "stone"),
    ]


def test_filled_in_ids_avoid_the_given_ones(case_file):
    case = load_case(case_file(WALL.replace("courses = 3", 'courses = 3\nid = "wall2"') + SECOND + SECOND)).case
    assert [structure.id for structure in case.structure] == ["wall2", "wall", "wall3"]


def test_doubts(case_file):
    text = WALL.replace("2000.0", "2.0").replace("0.6", "31.0")
    loaded = load_case(case_file("gravity = 981.0\n" + text))
    assert list(loaded.warnings) == [
        "case.toml:3:11: materials.stone.density: 2 kg/m3 is unusual for a building material, "
        "did you mean 2000 (2 g/cm3)?",
        "case.toml:5:12: joints.dry.friction: 31 is unusual for tan(phi), phi = 88.2 deg; "
        "an angle is given as friction_angle_deg",
        "case.toml:1:11: gravity: 981 m/s2 is unusual for gravity (9.81 on Earth), did you mean 9.81 (981 cm/s2)?",
    ]


def test_no_doubts_about_a_plain_case(case_file):
    assert load_case(case_file(WALL)).warnings == []


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0.5", 0.5),
        ("3", 3),
        ("true", True),
        ("[1, 2]", [1, 2]),
        ("{ a = 1 }", {"a": 1}),
        ('"0.5"', "0.5"),
        ("tilt", "tilt"),
        ("a wall", "a wall"),
        ("", ""),
        ("1\nx = 2", "1\nx = 2"),
    ],
)
def test_the_value_of_an_override_is_toml_or_text(text, value):
    assert literal(text) == value


def test_the_key_of_an_override_may_be_quoted():
    assert parse('materials."hard stone".density = 2e3').path == ("materials", "hard stone", "density")


@pytest.mark.parametrize("text", ["friction", "=3", "a b=3", "a..b=3"])
def test_an_override_without_a_key(text):
    with pytest.raises(UsageError):
        parse(text)


def test_overrides(case_file):
    values = ["joints.dry.friction=0.5", "structure.0.courses=4", "output.frames=0", "title=high wall"]
    case = load_case(case_file(WALL), values).case
    assert (case.joints["dry"].friction, case.structure[0].courses, case.output.frames) == (0.5, 4, 0)
    assert case.title == "high wall"


def test_the_last_override_of_a_key_counts(case_file):
    assert load_case(case_file(WALL), ["seed=2", "seed=3"]).case.seed == 3


def test_problems_of_the_model_are_located_too(case_file):
    floating = '[[block]]\nid = "b"\nvertices = [[5, 5], [6, 5], [6, 6]]\n'
    with pytest.raises(CaseError) as caught:
        build_model(load_case(case_file(WALL + floating)))
    assert str(caught.value).startswith("case.toml:10:1: block.0: nothing holds up block 'b'")
    assert caught.value.problems[0].path == ("block", 0)


def test_render_a_problem_without_a_place(case_file):
    loaded = load_case(case_file(WALL))
    assert loaded.render(CaseProblem((), "all is lost")) == "case.toml:1:1: all is lost"
    assert loaded.locate(("structure", 0, "courses")) == (8, 11)


def test_thousands_of_blocks_are_read_quickly(case_file):
    import time

    blocks = "".join(
        f'[[block]]\nid = "b{i}"\nvertices = [[{i}, 0], [{i + 1}, 0], [{i + 1}, 1], [{i}, 1]]\nfixed = true\n'
        for i in range(3000)
    )
    start = time.process_time()
    case = load_case(case_file(WALL + blocks)).case
    assert len(case.block) == 3000
    assert time.process_time() - start < 3.0


ENDLESS = ["x = " + 5000 * "[" + 5000 * "]", "x" + 3000 * ".x" + " = 1", "x = " + 900 * "{a=" + 900 * "}"]


@pytest.mark.parametrize("text", ENDLESS, ids=["lists", "keys", "tables"])
def test_nesting_without_end(text, case_file):
    with pytest.raises(CaseError, match=r"case.toml:1:1: not valid TOML: lists or tables are nested too deeply"):
        load_case(case_file(f"{text}\n{WALL}"))


def test_digits_without_end(case_file):
    with pytest.raises(CaseError, match=r"case.toml:1:1: not valid TOML: a number has too many digits"):
        load_case(case_file(f"seed = {5000 * '1'}\n{WALL}"))
    with pytest.raises(CaseError, match=r"seed: a number of so many digits is not allowed; numbers are at most 1e\+30"):
        load_case(case_file(f"seed = {4000 * '1'}\n{WALL}"))


@pytest.mark.parametrize("value", ["1" * 5000, "[" * 3000 + "]" * 3000], ids=["digits", "lists"])
def test_overrides_without_end(value, case_file):
    with pytest.raises(CaseError, match=r"--set gravity: .* is not allowed; must be a number"):
        load_case(case_file(WALL), [f"gravity={value}"])


@pytest.mark.parametrize(("text", "column"), [("density = 2300 kg", 16), ("friction = 0,6", 13)])
def test_units_and_decimal_commas(text, column, case_file):
    """The words of the parser, "expected newline or end of document", did not say what is wrong."""
    words = rf"case.toml:1:{column}: not valid TOML: more follows the value \(numbers have no unit and a decimal point"
    with pytest.raises(CaseError, match=words):
        load_case(case_file(f"{text}\n{WALL}"))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("friction =", "cohesion = 1e5\nfriction =", "cohesion: unknown key of law = 'coulomb'; found in law = 'mohr-"),
        ("courses =", "ring = 0.5\ncourses =", "ring: unknown key of kind = 'wall'; found in kind = 'arch'"),
    ],
)
def test_a_key_of_another_law_or_kind(old, new, message, case_file):
    """Cohesion of a joint of friction alone was refused with a list of other keys, tension with another one's name."""
    with pytest.raises(CaseError, match=message):
        load_case(case_file(WALL.replace(old, new, 1)))


def test_doubts_about_steel(case_file):
    """A yield stress of 235 Pa, meant in MPa, made a tie of no strength, without a word."""
    tie = "[[tie]]\nends = [[0.5, 0.25], [0.5, 1.25]]\narea = 300.0\nyoung = 210.0\nyield_stress = 235.0\n"
    said = load_case(case_file(WALL + tie)).warnings
    assert [text.partition("case.toml:")[2].partition(" is unusual")[0] for text in said] == [
        "13:9: tie.0.young: 210 Pa", "14:16: tie.0.yield_stress: 235 Pa", "12:8: tie.0.area: 300 m2",
    ]  # fmt: skip
    usual = tie.replace("300.0", "3e-4").replace("210.0", "2.1e11").replace("235.0", "2.35e8")
    assert not load_case(case_file(WALL + usual)).warnings
