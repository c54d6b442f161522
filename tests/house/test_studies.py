"""scripts/studies: one entry, names used once, data with a run per line, and no way round the search path of Python."""

from __future__ import annotations

import ast
import json
from importlib import import_module
from pathlib import Path

import pytest
from parsed import nodes, tree
from studies import measured, storage
from studies.registry import STUDIES

ROOT = Path(__file__).resolve().parents[2]
SOURCES = sorted((ROOT / "scripts" / "studies").rglob("*.py"))
DATA = sorted(storage.DATA.glob("*.json"))
OF_DEM = {"benchmarks", "verification"}  # written by the program itself
VERSIONS = storage.read(measured.NAME)


def classes(folder: str) -> list[str]:
    sources = (ROOT / folder).rglob("*.py")
    return [node.name for path in sources for node in nodes(path) if isinstance(node, ast.ClassDef)]


@pytest.mark.parametrize("name", STUDIES)
def test_every_study_answers_the_entry(name, capsys):
    module, about = STUDIES[name]
    study = import_module(module).STUDY
    assert study.name == name
    assert about
    with pytest.raises(SystemExit) as stopped:
        study.main(["--help"])
    assert stopped.value.code == 0
    assert f"scripts/study {name}" in capsys.readouterr().out


def test_class_names_are_used_once():
    ours = classes("scripts/studies")
    assert sorted(set(ours)) == sorted(ours)
    assert set(ours) & set(classes("dem_cli")) == set()


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: f"{path.parent.name}.{path.stem}")
def test_modules_say_what_they_are(path):
    assert ast.get_docstring(tree(path)), path


@pytest.mark.parametrize("path", DATA, ids=lambda path: path.stem)
def test_data_has_a_run_per_line(path):
    assert path.stem in {*STUDIES, *OF_DEM, measured.NAME}
    text = path.read_text(encoding="utf-8")
    if path.stem not in OF_DEM:
        assert text == storage.text_of(json.loads(text)) + "\n"


@pytest.mark.parametrize("folder", ["scripts", "tests"])
def test_nothing_changes_the_search_path(folder):
    word = "sys." + "path"  # else this file would have it
    assert [path for path in (ROOT / folder).rglob("*.py") if word in path.read_text(encoding="utf-8")] == []


@pytest.mark.parametrize("name", [path.stem for path in DATA if path.stem in {*STUDIES} - {"thesis_joint"}])
def test_a_page_says_with_which_version_it_was_measured(name):
    """Section by section; `thesis_joint` runs a program of its own, not dem."""
    assert set(VERSIONS[name]) == set(storage.read(name)) - {"machine"}
    page = storage.DATA.parent / f"{'stress' if name == 'random_structures' else name}.md"
    assert measured.sentence(name) in page.read_text(encoding="utf-8")


def test_versions_are_noted_section_by_section(tmp_path, monkeypatch):
    monkeypatch.setattr(storage, "DATA", tmp_path)
    assert measured.stamped("a", "# A\n\nText\n") == "# A\n\nText\n"
    for version, sections in (("0.9.0", "xyz"), ("0.10.0", "z")):
        monkeypatch.setattr(measured, "__version__", version)
        measured.note("a", ["machine", *sections])
    assert "with dem 0.10.0 (`z`), and all else with 0.9.0, and not since" in measured.sentence("a")
    assert measured.stamped("a", "# A\n\nText\n") == f"# A\n\n{measured.sentence('a')}\n\nText\n"
