"""`dem check` of few blocks loads neither numba nor tables of other kinds, and says what it says otherwise."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from dem_cli.app import api
from dem_cli.app.cli import check
from dem_cli.app.cli.main import main
from dem_cli.case.reader import CaseSource, parse_toml, validate
from dem_cli.core.kernels import jit
from dem_cli.core.kernels.compilation.kept_code import may_be_kept

CASES = Path(__file__).resolve().parents[2] / "cases"
WALL = CASES / "verification" / "wall_21.toml"
LOADED = """
import sys
from dem_cli.app.cli.main import main
try:
    main(sys.argv[1:])
finally:
    generators = "dem_cli.masonry.structures"
    kinds = {f"{generators}.vaults.shapes", f"{generators}.columns.column", "dem_cli.core.laws.barton"}
    kinds |= {"numpy.f2py.crackfortran", "numpy.testing._private", "dem_cli.case.tables.base_motion"}
    print("LOADED", sorted({"numba", "scipy", "h5py", "matplotlib", *kinds} & set(sys.modules)))
"""


def test_a_small_wall_is_checked_without_what_it_does_not_need():
    words = [sys.executable, "-c", LOADED, "check", str(WALL)]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert "49, 98 contact points" in done.stdout
    assert done.stdout.splitlines()[-1] == "LOADED []"


@pytest.mark.skipif(not may_be_kept(), reason="code is kept on Linux and x86-64 alone")
def test_a_later_run_loads_neither_numba_nor_what_scipy_names(tmp_path):
    """The first one may compile."""
    less = ("output.frames=0", "analysis.follow=0.0")
    words = [sys.executable, "-c", LOADED, "run", str(WALL), "-o", str(tmp_path / "out"), "-q"]
    for _ in range(2):
        done = subprocess.run(
            [*words, *(word for each in less for word in ("--set", each))], capture_output=True, text=True
        )
    assert "0.5993" in done.stdout
    assert done.stdout.splitlines()[-1] == "LOADED ['h5py', 'scipy']"


@pytest.mark.parametrize("name", ["wall_21", "rocking_rectangle", "windows_mu050", "groove", "space/wedge_in_groove"])
def test_it_says_the_same_with_compiled_kernels(name, monkeypatch):
    words = ["check", str(CASES / "verification" / f"{name}.toml")]
    at_once = CliRunner().invoke(main, words)
    monkeypatch.setattr(check, "FEW_CORNERS", {2: 0, 3: 0})
    compiled = CliRunner().invoke(main, words)
    assert at_once.exit_code == compiled.exit_code == 0
    assert at_once.output == compiled.output


def test_what_only_compiled_code_does_is_left_to_it():
    """Python raises where compiled code divides by zero."""
    model = api.build_model(api.load_case(WALL))
    done = []

    def work() -> int:
        done.append(1)
        return 1 // (len(done) - 1)

    assert check.at_once(model, work) == 1
    assert len(done) == 2


@pytest.mark.parametrize(("changes", "in_python"), [((), 1), (("block.0.vertices.2=[400.0, 0.619]",), 0)])
def test_many_neighbours_are_left_to_compiled_code(changes, in_python):
    """Python took 31 s for 1,440 corners where one huge block made all stones neighbours of each other; now 1.4 s."""
    model = api.build_model(api.load_case(CASES / "verification" / "top_load_b11.toml", changes))
    assert check.at_once(model, lambda: jit._door.uncompiled) == in_python


@pytest.mark.parametrize("path", sorted((CASES / "gallery").glob("*.toml")), ids=lambda path: path.stem)
def test_a_case_says_the_same_of_the_tables_that_it_names_alone(path, monkeypatch):
    whole, text = api.make_case_model(), path.read_text(encoding="utf-8")
    small = []

    def of_tables(tables):
        small.append(api._case_model(*api._named(tables)))
        return small[-1]

    monkeypatch.setattr(api, "case_model_of", of_tables)
    source = CaseSource(path, text)
    assert api.load_case(path).case == validate(parse_toml(path, text), whole, source)
    assert small[0].model_fields.keys() == whole.model_fields.keys()


@pytest.mark.parametrize(
    ("tables", "why"),
    [
        ({}, "no joints"),
        ({"joints": {"dry": {"law": "glue"}}}, "a law that does not exist"),
        ({"joints": {"dry": {}}, "structure": [{"kind": "heap"}]}, "a kind of structure that does not exist"),
        ({"joints": {"dry": {}}, "structure": [{}]}, "a structure without a kind"),
        ({"joints": {"dry": {}}, "structure": {"kind": "wall"}}, "no list"),
        ({"joints": {"dry": {}}, "analysis": {"kind": ["pushover"]}}, "no name"),
        ({"joints": {"dry": {}}, "materails": {}}, "a key that does not exist"),
        ({"joints": "dry"}, "no table"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_mistakes_are_left_to_the_class_that_knows_all_kinds(tables, why):
    assert api._named(tables) is None


SHAKEN = """
[materials.stone]
density = 2400.0
[joints.dry]
friction = 0.6
[[structure]]
kind = "column"
block = [0.5, 1.0]
courses = 1
[motion]
kind = "artificial"
spectrum = "EC8-1"
soil = "B"
ag = 3.0
duration = 3.0
plateau = 1.0
iterations = 2
[analysis]
kind = "time-history"
"""
PREPARED = """
import sys
from dem_cli.app import api
from dem_cli.analyses import time_history
from dem_cli.masonry.assembly.ground_motions import motions_of

print(motions_of(api.load_case(sys.argv[1]).case)[0].displacement(1.0))
print("LOADED", sorted(n for n in ("scipy.signal", "scipy.optimize", "scipy.interpolate") if n in sys.modules))
"""


def test_an_earthquake_is_made_without_the_heavy_parts_of_scipy(tmp_path):
    """They were half of a history of a second: one filter, one root, and polynomials between samples."""
    case = tmp_path / "shaken.toml"
    case.write_text(SHAKEN)
    done = subprocess.run([sys.executable, "-c", PREPARED, str(case)], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "LOADED []"


def test_a_history_without_an_end_is_refused_as_a_run_refuses_it(tmp_path):
    """It passed the check: "how long is not said"."""
    case = tmp_path / "shaken.toml"
    case.write_text(SHAKEN[: SHAKEN.index("[motion]")] + SHAKEN[SHAKEN.index("[analysis]") :])
    said = []
    for command in (["check", str(case)], ["run", str(case), "-o", str(tmp_path / "out")]):
        done = CliRunner().invoke(main, command)
        assert done.exit_code == 2
        said.append(done.output)
    assert said[0] == said[1]
    assert "analysis.duration: missing; must be a number > 0" in said[0]
