"""The page and the notebook about Python: every block and every cell works, in order, in an empty folder."""

from __future__ import annotations

import itertools
import json
import shutil
from pathlib import Path

import pytest
from shown import blocks

ROOT = Path(__file__).resolve().parents[2]
PAGE, NOTEBOOK = ROOT / "docs" / "python.md", ROOT / "docs" / "python.ipynb"


def cells() -> list[str]:
    """Source of the code cells, in order."""
    notebook = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    return ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]


def run_all(sources: list[str], name: str) -> dict[str, object]:
    """Each of these pieces of a program, in one namespace."""
    namespace: dict[str, object] = {"__name__": name}
    for i, source in enumerate(sources):
        exec(compile(source, f"{name}, piece {i + 1}", "exec"), namespace)
    return namespace


def test_the_page(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    shutil.copytree(ROOT / "cases" / "verification", "cases/verification")
    run_all([block.text for block in blocks(PAGE) if block.language == "python"], "python.md")
    said = capsys.readouterr().out
    assert float(said.split()[0]) == pytest.approx(0.5, rel=2e-3)
    assert "set joints.dry.frcition: unknown key, did you mean 'friction'?" in said
    assert [path.name for path in tmp_path.iterdir()] == ["cases"]  # nothing is kept


def test_the_notebook(tmp_path, monkeypatch, capsys):
    plt = pytest.importorskip("matplotlib.pyplot")
    monkeypatch.chdir(tmp_path)
    found = run_all(cells(), "python.ipynb")
    assert found["loads"][0] == pytest.approx(0.3, rel=2e-3)
    assert all(after >= 0.998 * before for before, after in itertools.pairwise(found["loads"]))  # the resolution
    assert len(plt.get_fignums()) == 3
    plt.close("all")
    assert (tmp_path / "shaken" / "summary.json").is_file()


def test_the_notebook_holds_no_outputs():
    notebook = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    code = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert not any(cell["outputs"] or cell["execution_count"] for cell in code)
    assert len({cell["id"] for cell in notebook["cells"]}) == len(notebook["cells"])
