"""scripts/studies: one entry, names used once, data with a run per line, and no way round the search path of Python."""

from __future__ import annotations

import ast
import json
from importlib import import_module
from pathlib import Path

import pytest
from studies import storage
from studies.registry import STUDIES

ROOT = Path(__file__).resolve().parents[2]
SOURCES = sorted((ROOT / "scripts" / "studies").rglob("*.py"))
DATA = sorted(storage.DATA.glob("*.json"))
OF_DEM = {"benchmarks", "verification"}  # written by the program itself


def classes(folder: str) -> list[str]:
    trees = (ast.parse(path.read_text(encoding="utf-8")) for path in (ROOT / folder).rglob("*.py"))
    return [node.name for tree in trees for node in ast.walk(tree) if isinstance(node, ast.ClassDef)]


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
    assert ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))), path


@pytest.mark.parametrize("path", DATA, ids=lambda path: path.stem)
def test_data_has_a_run_per_line(path):
    assert path.stem in STUDIES or path.stem in OF_DEM
    text = path.read_text(encoding="utf-8")
    if path.stem not in OF_DEM:
        assert text == storage.text_of(json.loads(text)) + "\n"


@pytest.mark.parametrize("folder", ["scripts", "tests"])
def test_nothing_changes_the_search_path(folder):
    word = "sys." + "path"  # else this file would have it
    assert [path for path in (ROOT / folder).rglob("*.py") if word in path.read_text(encoding="utf-8")] == []
