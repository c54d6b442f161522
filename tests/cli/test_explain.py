"""`dem explain`: one key, one table, many matches, JSON, and what it does not know."""

from __future__ import annotations

import json

import pytest
from click.testing import CliRunner

from dem_cli.app.cli.main import main
from dem_cli.case.explain import EVERYDAY_WORDS


@pytest.fixture
def explain(monkeypatch):
    """`dem explain WORDS` -> exit code, stdout, stderr."""
    monkeypatch.setenv("COLUMNS", "200")

    def run(*words: str) -> tuple[int, str, str]:
        result = CliRunner().invoke(main, ["explain", *words])
        assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
        return result.exit_code, result.stdout, result.stderr

    return run


def test_a_key(explain):
    code, said, _ = explain("analysis.margin")
    assert code == 0
    assert said.splitlines() == [
        "analysis.margin",
        "  time step over the largest stable one",
        "  unit      none",
        "  allowed   a number > 0 and ≤ 0.95",
        "  default   0.25",
        '  found in  kind = "time-history", "fragility"',
        "  example   [analysis]   margin = 0.25",
        "  more      docs/numerics.md",
    ]


def test_a_key_that_is_required(explain):
    said = explain("materials.stone.density")[1]
    assert "  unit     kg/m3\n" in said
    assert "must be given" in said


def test_a_table_has_its_keys(explain):
    said = explain("structure.arch")[1]
    assert said.startswith('[[structure]]   kind = "arch"\n')
    assert "depth of the ring, from inner to outer face [m]; required" in said
    assert "blocks_per_course" not in said


def test_kinds(explain):
    for query in ("motion.kind", "motion"):
        said = explain(query)[1]
        assert all(f'"{kind}" ' in said for kind in ("pulse", "harmonic", "record", "artificial"))


def test_many_matches_are_lines(explain):
    said = explain("height")[1]
    assert "structure.openings.height" in said
    assert "structure.drums.height" in said
    assert "allowed" not in said


def test_without_a_key_all_tables(explain):
    said = explain()[1]
    assert "[materials.NAME]" in said
    assert "coulomb, mohr-coulomb" in said


def test_json(explain):
    (found,) = json.loads(explain("joints.friction", "--json")[1])
    assert found["units"] == ["-"]
    assert found["example"] == "friction = 0.6"
    (table,) = json.loads(explain("structure.wall", "--json")[1])
    assert {key["path"] for key in table["keys"]} >= {"structure.courses", "structure.kind"}
    assert len(json.loads(explain("--json")[1])) > 40


def test_unknown(explain):
    code, said, error = explain("joints.frcition")
    assert (code, said) == (2, "")
    assert error.startswith("error: no key 'joints.frcition' in a case file; did you mean 'joints.friction'")


@pytest.mark.parametrize(
    ("words", "path"), [(w, path) for words, path in EVERYDAY_WORDS.items() for w in words.split()]
)
def test_words_that_people_use(words, path, explain):
    """They lead to what is written for them; a word that is a key itself would never be looked up here."""
    assert explain(words) == explain(path)
    assert explain(words)[0] == 0


def test_words_as_they_are_typed(explain):
    assert explain("Earth pressure")[1].startswith("[[pressure]]")
