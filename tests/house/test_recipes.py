"""The recipes of CONTRIBUTING.md, done to the letter in a copy of the project: its tests pass then, and a case runs."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from recipes import Recipe, analysis, generator, joint_law

ROOT = Path(__file__).resolve().parents[2]
RECIPES = {recipe.section: recipe for recipe in (joint_law.RECIPE, generator.RECIPE, analysis.RECIPE)}
OF_ALL = (  # what the house asks of all modules, kinds and pages; of single ones: `tests` of each recipe
    "tests/house/test_docs.py::test_every_module_is_drawn",
    "tests/house/test_docs.py::test_every_module_has_a_docstring",
    "tests/house/test_glossary.py",
    "tests/house/test_imports.py::test_no_room_is_crowded",
    "tests/house/test_names.py::test_no_class_name_twice",
)
CASE = """
title = "Both at once"

[materials.stone]
density = 2400.0

[joints.dry]
law = "tresca"
shear_strength = 5e3

[[structure]]
kind = "stepped-pier"
block = [1.0, 0.4]
courses = 2
step = 0.1

[analysis]
kind = "pushover"
"""
WEIGHT = (1.0 + 0.9) * 0.4 * 2400.0 * 9.81  # over the lowest joint, which has an area of 1 m2 [N]
SCRIPTS = {  # what a script does once the environment is there
    "scripts/draw_tree": ["scripts/draw_tree"],
    "scripts/study": ["-m", "studies"],
    "scripts/docs": [
        "-c",
        "import studies.site.generated as g\nfor p, t in g.PAGES.items(): (g.ROOT / p).write_text(t(), 'utf-8')",
    ],
}


def text_of(recipe: Recipe) -> str:
    """The numbered steps of the recipe as they are written."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    found = re.search(rf"^## {recipe.section}\n.*?(^1\. .*?)\n\n", text, re.DOTALL | re.MULTILINE)
    assert found
    return found[1]


def python(folder: Path, *words: str) -> str:
    """What Python prints in the copy, with the modules of the copy alone."""
    paths = os.pathsep.join(str(folder / part) for part in (".", "scripts", "tests"))
    environment = os.environ | {"PYTHONPATH": paths, "DEM_CACHE_DIR": str(folder / "cache")}
    done = subprocess.run([sys.executable, *words], cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """A copy of the project in which all recipes were done."""
    folder = tmp_path_factory.mktemp("recipes") / "project"
    unused = shutil.ignore_patterns("__pycache__")
    for name in ("dem_cli", "docs", "scripts", "tests", "cases"):
        shutil.copytree(ROOT / name, folder / name, ignore=unused)
    for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "pyproject.toml"):
        shutil.copy(ROOT / name, folder)
    for recipe in RECIPES.values():
        for path, text in recipe.files.items():
            assert not (folder / path).exists()
            (folder / path).write_text(text, encoding="utf-8")
        for path, before, after in recipe.lines:
            text = (folder / path).read_text(encoding="utf-8")
            assert text.count(before) == 1, f"{path}: {before}"
            (folder / path).write_text(text.replace(before, after), encoding="utf-8")
    (folder / "case.toml").write_text(CASE, encoding="utf-8")
    for script, *words in dict.fromkeys(words for recipe in RECIPES.values() for words in recipe.commands):
        python(folder, *SCRIPTS[script], *(words if script == "scripts/study" else []))
    return folder


@pytest.mark.parametrize("section", RECIPES)
def test_what_was_done_is_what_the_recipe_says(section):
    """Every file that it names was written, every command run, and nothing beside."""
    recipe = RECIPES[section]
    said = re.sub(r"\bNAME\b|\bKIND\b|(?<=test_)(NAME|KIND)\b", "*", text_of(recipe))
    named = set(re.findall(r"`((?:dem_cli|tests|scripts|docs)/[\w*./-]+\.\w[\w.]*)`", said))
    paths = (*recipe.files, *(path for path, *_ in recipe.lines))
    done = {path.replace(recipe.name, "*").replace(recipe.module, "*") for path in paths}
    written = {"docs/laws/*.md"}  # by a command
    assert named - written == done | set(recipe.left_out)
    commands = re.findall(r"`(scripts/(?:study|docs|draw_tree)[^`]*)`", said)
    assert commands == [" ".join(words).replace(recipe.name, "*") for words in recipe.commands]


def test_the_tests_pass(project):
    tests = [test for recipe in RECIPES.values() for test in recipe.tests]
    python(project, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", "-p", "no:xdist", *OF_ALL, *tests)


def test_pages_and_help_name_what_is_new(project):
    """What `scripts/docs --write` and the studies made of it."""
    assert '"tresca"' in (project / "docs" / "case.md").read_text(encoding="utf-8")
    assert "stepped-pier" in (project / "docs" / "commands.md").read_text(encoding="utf-8")
    assert (project / "docs" / "laws" / "tresca.png").is_file()


def test_a_case_runs(project):
    """It slides on its base at the load that the strength says."""
    answer = json.loads(python(project, "-m", "dem_cli", "run", "case.toml", "--json"))
    assert answer["failure_load"] == pytest.approx(5e3 / WEIGHT, rel=0.002)
    assert answer["failure_mode"] == "sliding"


def test_a_kind_of_analysis_runs_and_says_its_answer(project):
    words = ("--set", "analysis.kind=weight", "-o", "weighed")
    said = python(project, "-m", "dem_cli", "run", "case.toml", *words)
    assert f"weight         {WEIGHT:.4g} N" in said
