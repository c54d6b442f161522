"""The effective case: reading it and writing it again gives the same bytes, and it means the same."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
import tomli_w
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from dem_cli import __version__
from dem_cli.app.api import load_case
from dem_cli.case.writer import case_text

ROOT = Path(__file__).resolve().parents[3]
CASES = sorted((ROOT / "cases").rglob("*.toml")) + sorted((ROOT / "dem_cli/app/cli/templates").glob("*.toml"))


def rewritten(path: Path, folder: Path, overrides: tuple[str, ...] = ()) -> tuple[str, str]:
    """The effective case of a file, and the effective case of that."""
    first = load_case(path, overrides)
    text = case_text(first.case)
    again = folder / "again.toml"
    again.write_text(text, encoding="utf-8")
    second = load_case(again)
    assert second.case.model_copy(update={"dem": None, "sweep": None}) == first.case.model_copy(
        update={"dem": None, "sweep": None}
    )
    return text, case_text(second.case)


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_cases_and_templates(path, tmp_path):
    text, again = rewritten(path, tmp_path)
    assert text == again
    assert tomllib.loads(text)["dem"] == {"version": __version__}


def test_overrides_are_in_it(tmp_path):
    path = ROOT / "dem_cli/app/cli/templates/wall.toml"
    text, again = rewritten(path, tmp_path, ("joints.dry.friction=0.55", "title=Mauer", "output.frames=0"))
    tables = tomllib.loads(text)
    assert text == again
    assert (tables["joints"]["dry"]["friction"], tables["title"], tables["output"]["frames"]) == (
        0.55,
        "Mauer",
        0,
    )


def test_defaults_are_in_it_and_lists_stand_on_one_line(tmp_path):
    text, _ = rewritten(ROOT / "dem_cli/app/cli/templates/wall.toml", tmp_path)
    assert 'kn = "auto"\n' in text
    assert "origin = [0.0, 0.0]\n" in text
    assert "gravity = 9.81\n" in text
    assert 'id = "wall"\nmaterial = "stone"\n' in text


def test_a_default_that_may_not_stand_beside_another_stays_out(tmp_path):
    path = tmp_path / "case.toml"
    text = (ROOT / "dem_cli/app/cli/templates/arch.toml").read_text(encoding="utf-8")
    text = text.replace('shape = "circular"', 'shape = "segmental"\nspan = 2.0\nrise = 0.5\n#')
    text = text.replace("radius = 1.0", "#").replace("included_angle_deg", "#")
    path.write_text(text, encoding="utf-8")
    text, again = rewritten(path, tmp_path)
    assert text == again
    assert "included_angle_deg" not in text


positive = st.floats(1e-3, 1e3)
number = st.floats(-1e3, 1e3)
name = st.text(st.characters(exclude_categories=("Cs", "Cc")), min_size=1, max_size=8)
point = st.tuples(number, number).map(list)


@st.composite
def case_tables(draw):
    """Cases that pass validation, if not always a check of their geometry."""
    materials = draw(st.lists(name, min_size=1, max_size=2, unique=True))
    material = st.sampled_from(materials)
    wall = st.fixed_dictionaries(
        {
            "kind": st.just("wall"),
            "block": st.tuples(positive, positive).map(list),
            "courses": st.integers(1, 9),
            "blocks_per_course": st.integers(1, 9),
            "material": material,
        },
        optional={"origin": point, "rotation_deg": number, "base": st.booleans(), "ends": st.just("toothed")},
    )
    block = st.fixed_dictionaries(
        {"id": name, "vertices": st.lists(point, min_size=3, max_size=6), "material": material},
        optional={"fixed": st.booleans(), "thickness": positive},
    )
    load = st.fixed_dictionaries({"block": name, "force": point}, optional={"at": point})
    return draw(
        st.fixed_dictionaries(
            {
                "materials": st.just({key: {"density": draw(positive)} for key in materials}),
                "joints": st.dictionaries(name, st.fixed_dictionaries({"friction": positive}), min_size=1, max_size=2),
                "structure": st.lists(wall, min_size=1, max_size=2),
            },
            optional={
                "title": st.text(st.characters(exclude_categories=("Cs", "Cc", "Cf")), max_size=20),
                "gravity": positive,
                "block": st.lists(block, max_size=2, unique_by=lambda table: table["id"]),
                "load": st.lists(load, max_size=2),
                "output": st.fixed_dictionaries({"frames": st.integers(0, 50)}),
            },
        )
    )


@given(case_tables())
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60, deadline=None)
def test_any_case(tmp_path, tables):
    path = tmp_path / "case.toml"
    path.write_text(tomli_w.dumps(tables), encoding="utf-8")
    text, again = rewritten(path, tmp_path)
    assert text == again
