"""From a file of another program to a report, and what the command line says on the way."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner
from synthetic.drawn_elsewhere import by_trimesh, facade_by_ezdxf, obj_text, prism, wall_boxes

from dem_cli.app.cli.main import main

HEAD = """\
title = "Imported"
dimension = {dimension}

[materials.stone]
density = 2400.0

[materials.oak]
density = 700.0

[joints.dry]
friction = 0.6

[[structure]]
kind = "import"
id = "wall"
material = "stone"
{keys}

[analysis]
kind = "gravity"
"""


def dem(*words: str):
    result = CliRunner().invoke(main, list(words))
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result


def case(folder: Path, keys: str, dimension: int = 3) -> str:
    path = folder / "case.toml"
    path.write_text(HEAD.format(dimension=dimension, keys=keys), encoding="utf-8")
    return str(path)


def test_200_stones_of_another_program_from_the_file_to_the_report(tmp_path):
    boxes = wall_boxes(14, 14)
    assert len(boxes) > 200
    by_trimesh(boxes, tmp_path / "stones.obj")
    path = case(tmp_path, 'file = "stones.obj"\nfixed = ["ground"]')
    checked = dem("check", path)
    assert (checked.exit_code, checked.stderr) == (0, "")
    assert f"{len(boxes)} blocks from {len(boxes)} objects, lengths in m" in checked.stdout
    assert dem("run", path, "-o", str(tmp_path / "run"), "--quiet").exit_code == 0
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    # bed joints: each stone on two below, at the ends on one more or less; heads between neighbours of a course
    courses = [sum(name.startswith(f"stone-{k}-") for name, _, _ in boxes) for k in range(1, 15)]
    beds = courses[0] + sum(a + b - 1 for a, b in zip(courses, courses[1:]))
    assert (summary["status"], summary["blocks"]) == ("ok", len(boxes))
    assert summary["joints"] == beds + sum(n - 1 for n in courses)
    assert dem("report", str(tmp_path / "run")).exit_code == 0
    assert (tmp_path / "run" / "report.html").stat().st_size > 100_000
    again = dem("check", str(tmp_path / "run" / "case.toml"))  # the effective case reads the same file
    assert again.stdout.splitlines()[2:] == checked.stdout.splitlines()[2:]


def test_a_drawing_stands_upright_in_space_and_its_case_is_written_whole(tmp_path):
    facade_by_ezdxf(tmp_path / "facade.dxf")
    layers = 'layers = { stone = {}, ground = { fixed = true, thickness = 1.0 }, lintel = { material = "oak" } }'
    path = case(tmp_path, f'file = "facade.dxf"\nthickness = 0.4\n{layers}')
    checked = dem("check", path)
    assert (checked.exit_code, checked.stderr) == (0, "")
    assert "size            4 m × 0.4 m × 2 m (free blocks)" in checked.stdout
    mass = (4.0 * 2.0 - 1.2 * 1.4 - 1.6 * 0.2) * 0.4 * 2400.0 + 1.6 * 0.2 * 0.4 * 700.0
    assert f"mass            {mass:.6g} kg" in checked.stdout
    assert dem("run", path, "-o", str(tmp_path / "run"), "--quiet").exit_code == 0
    again = dem("check", str(tmp_path / "run" / "case.toml"))
    assert again.stdout.splitlines()[2:] == checked.stdout.splitlines()[2:]


@pytest.mark.parametrize(
    ("keys", "dimension", "message"),
    [
        ('file = "b.obj"', 2, "structure.0.file: .obj files hold solids; give dimension = 3"),
        ('file = "c.obj"', 3, "structure.0.file: no such file: "),
        ('file = "b.step"', 3, "structure.0.file: '.step' is not read; the file ends in one of .stl, .obj, .ply"),
        ('file = "b.obj"\nthickness = 0.3', 3, "structure.0.thickness: not used with .obj, which holds solids"),
        (
            'file = "b.obj"\nmaterials = "file"',
            3,
            "structure.0.file: block 'wall-a': unknown material 'tuff'",
        ),
        ('file = "b.obj"\nfixed = ["x"]', 3, "structure.0.fixed.0: no block is called 'x' (blocks: 'a')"),
        ('file = "b.obj"\nlayers = { x = {} }', 3, "structure.0.layers.x: no blocks on 'x' in the file"),
        (
            'file = "b.obj"\nlayers = { x = { material = "y" } }',
            3,
            "structure.0.layers.x.material: unknown material 'y'",
        ),
    ],
)
def test_a_mistake_is_said_with_its_line_and_key(tmp_path, keys, dimension, message):
    text = obj_text({"a": prism([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)], 0.0, 1.0)})
    (tmp_path / "b.obj").write_text(text.replace("o a\n", "o a\nusemtl tuff\n"))
    result = dem("check", case(tmp_path, keys, dimension))
    assert result.exit_code == 2
    key = message.partition(":")[0].split(".")[2]
    line = 17 + next(k for k, text in enumerate(keys.splitlines()) if text.startswith(key))
    assert f"case.toml:{line}:" in result.stderr
    assert message in result.stderr
    assert len(result.stderr.splitlines()) == 1


def test_lengths_in_another_unit_are_doubted(tmp_path):
    """A drawing in mm that is read in m."""
    (tmp_path / "two.obj").write_text(
        obj_text({"a": prism([(0.0, 0.0), (400.0, 0.0), (400.0, 300.0), (0.0, 300.0)], 0.0, 200.0),
                  "g": prism([(0.0, 0.0), (400.0, 0.0), (400.0, 300.0), (0.0, 300.0)], -9.0, 0.0)})
    )  # fmt: skip
    doubted = dem("check", case(tmp_path, 'file = "two.obj"\nfixed = ["g"]'))
    assert doubted.exit_code == 0
    assert "is unusual for the size of a block" in doubted.stderr
    assert "mm)" in doubted.stderr
