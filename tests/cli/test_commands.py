"""`dem check`, `build`, `new` and `schema`."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner

from dem_cli.app import api
from dem_cli.app.cli.check import rows
from dem_cli.app.cli.main import main
from dem_cli.app.cli.new import COMPANIONS, TEMPLATE_KINDS, TEMPLATES
from dem_cli.masonry.structures.registry import GENERATORS
from dem_cli.results.report.facts import model_rows

ROOT = Path(__file__).resolve().parents[2]


def dem(*words: str):
    result = CliRunner().invoke(main, list(words))
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result


@pytest.mark.parametrize("kind", TEMPLATE_KINDS)
def test_what_new_prints_passes_check_as_it_is(kind, tmp_path):
    printed = dem("new", kind)
    path = tmp_path / "case.toml"
    path.write_text(printed.stdout, encoding="utf-8")
    if kind in COMPANIONS:
        shutil.copy(TEMPLATES / COMPANIONS[kind], tmp_path)
    checked = dem("check", str(path))
    assert (printed.exit_code, printed.stderr) == (0, "")
    assert (checked.exit_code, checked.stderr) == (0, "")


@pytest.mark.parametrize("kind", TEMPLATE_KINDS)
def test_what_new_prints_explains_every_key(kind):
    for line in (TEMPLATES / f"{kind}.toml").read_text(encoding="utf-8").splitlines():
        assert len(line) <= 120
    assert "SI units" in (TEMPLATES / f"{kind}.toml").read_text(encoding="utf-8")


def test_there_is_a_template_for_every_generator():
    assert set(TEMPLATE_KINDS) == {
        *GENERATORS,
        "arched-wall",
        "block",
        "bonded-wall",
        "colonnade",
        "facade",
        "out-of-plane",
        "reinforced-wall",
        "retaining",
        "shaken",
        "safety",
        "sweep",
    }


@pytest.mark.parametrize(
    ("kind", "first"),
    [("wall", "# [[structure.openings]]"), ("out-of-plane", "# [[structure]]"), ("out-of-plane", "# [[block]]")],
)
def test_a_template_that_is_uncommented_is_valid_too(kind, first, tmp_path):
    text = dem("new", kind).stdout
    start = text.index(first)
    end = text.index("\n\n", start)
    opened = text[:start] + text[start:end].replace("# ", "") + text[end:]
    path = tmp_path / "case.toml"
    path.write_text(opened, encoding="utf-8")
    checked = dem("check", str(path))
    assert (checked.exit_code, checked.stderr) == (0, "")


def test_new_writes_what_its_template_names(tmp_path):
    assert dem("new", "import", "-o", str(tmp_path / "mine.toml")).exit_code == 0
    checked = dem("check", str(tmp_path / "mine.toml"))
    assert (checked.exit_code, checked.stderr) == (0, "")
    assert "4 blocks from 4 objects (4 on stone), lengths in m" in checked.stdout


def test_new_writes_a_file_once(tmp_path):
    path = tmp_path / "wall.toml"
    assert dem("new", "wall", "-o", str(path)).exit_code == 0
    assert path.read_text(encoding="utf-8") == dem("new", "wall").stdout
    again = dem("new", "arch", "-o", str(path))
    assert (again.exit_code, again.stderr) == (2, f"error: {path}: exists already; nothing is overwritten\n")
    nowhere = dem("new", "arch", "-o", str(tmp_path / "no" / "arch.toml"))
    assert nowhere.exit_code == 3
    assert "cannot be written" in nowhere.stderr


def test_check_prints_the_model():
    result = dem("check", str(TEMPLATES / "wall.toml"), "--set", "structure.0.courses=4")
    lines = result.stdout.splitlines()
    assert lines[0] == "Dry-stone wall"
    rows = dict(line.strip().split("  ", 1) for line in lines[1:])
    rows = {label: text.strip() for label, text in rows.items()}
    assert rows["analysis"] == "pushover"
    assert rows["blocks"] == "23 (1 fixed), 92 corners"
    assert rows["size"] == "3 m × 1.2 m (free blocks)"
    assert rows["mass"] == "3960 kg (free blocks), 1 material(s)"
    assert rows["joint laws"] == "dry (coulomb)"
    assert rows["point loads"] == "none"


def test_a_report_means_the_same_by_size():
    """One had the base in it, the other not: 3 m × 1.5 m and 3 m × 1.2 m of the same wall."""
    loaded = api.load_case(TEMPLATES / "wall.toml")
    model = api.build_model(loaded)
    checked, reported = dict(rows(loaded.case, model)), dict(model_rows(model, {}))
    assert checked["size"] == reported["size"] == "3 m × 2.4 m (free blocks)"
    assert checked["mass"].startswith(reported["mass"])


def test_check_warns_on_stderr():
    result = dem("check", str(TEMPLATES / "wall.toml"), "--set", "materials.stone.density=2.1")
    assert result.exit_code == 0
    assert result.stderr == (
        "warning: --set materials.stone.density: 2.1 kg/m3 is unusual for a building material, "
        "did you mean 2100 (2.1 g/cm3)?\n"
    )


def test_schema_describes_every_key():
    schema = json.loads(dem("schema").stdout)
    assert {"materials", "joints"} <= set(schema["required"])
    for name, table in schema["$defs"].items():
        for key, field in table.get("properties", {}).items():
            assert field.get("description") or key in ("kind", "law"), f"{name}.{key}"


def test_schema_names_what_the_registries_hold():
    text = dem("schema").stdout
    for kind in (*GENERATORS, "coulomb", "pushover", "gravity"):
        assert f'"const": "{kind}"' in text


def test_build_writes_the_geometry(tmp_path):
    import meshio

    path = tmp_path / "model.vtu"
    result = dem("build", str(TEMPLATES / "arch.toml"), "-o", str(path))
    assert (result.exit_code, result.stdout) == (0, f"23 blocks written to {path}\n")
    mesh = meshio.read(path)
    assert sum(len(cells.data) for cells in mesh.cells) == 23


def test_build_writes_solids_of_a_structure_in_space(tmp_path):
    import meshio

    path = tmp_path / "model.vtu"
    result = dem("build", str(TEMPLATES / "out-of-plane.toml"), "-o", str(path))
    assert result.exit_code == 0
    mesh = meshio.read(path)
    assert {cells.type for cells in mesh.cells} == {"hexahedron"}
    n_blocks = sum(len(cells.data) for cells in mesh.cells)
    assert result.stdout == f"{n_blocks} blocks written to {path}\n"
    assert len(mesh.points) == 8 * n_blocks


def test_build_where_nothing_can_be_written(tmp_path):
    (tmp_path / "file").touch()
    result = dem("build", str(TEMPLATES / "arch.toml"), "-o", str(tmp_path / "file" / "model.vtu"))
    assert result.exit_code == 2
    assert "a part of the path is a file" in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
