"""Input without end or beyond all bounds: one message that says what is allowed, soon and in little memory."""

from __future__ import annotations

import math
import os
import threading
from pathlib import Path

import pytest
from click.testing import CliRunner
from studies.site.limits import LIMITS
from synthetic.pages import wall

from dem_cli import input_limits
from dem_cli.app.cli.main import main
from dem_cli.input_limits import (
    MOST_CORNERS,
    MOST_MISTAKES,
    MOST_TABLES,
    MOST_TOGETHER,
    UnreadableInput,
    read_bounded,
)

JOINT = "[materials.s]\ndensity = 2000.0\n[joints.d]\nfriction = 0.5\n"
SPACE = f"dimension = 3\n{JOINT}"
COLUMN = f'{JOINT}[[structure]]\nkind = "column"\nblock = [0.5, 0.5]\ncourses = 2\n'
SHAKEN = f'{COLUMN}[analysis]\nkind = "time-history"\n[motion]\ndirection = [1.0, 0.0]\n'
RECORD = f'{SHAKEN}kind = "record"\nunit = "m/s2"\nfile = '
IMPORT = '[[structure]]\nkind = "import"\nfile = '
FLAT = f"{SPACE}[[structure]]\nid = 's'\nkind = 'wall'\ncourses = 3\nblocks_per_course = 2\n"
LOAD = "[[load]]\nat = [9.0, 9.0]\nforce = [1.0, 0.0]\n"
SVG = '<svg xmlns="http://www.w3.org/2000/svg" xmlns:x="http://www.w3.org/1999/xlink">{}</svg>'
AROUND = [(math.cos(k / MOST_CORNERS * 6.28), math.sin(k / MOST_CORNERS * 6.28)) for k in range(MOST_CORNERS + 1)]
SQUARE = "vertices = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]"
FACES = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
PLACES = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]


def cube(k: int) -> str:
    """The k-th of many in one place, as OBJ has it."""
    corners = "".join(f"v {x} {y} {z}\n" for x, y, z in PLACES)
    return corners + f"o b{k}\n" + "".join(f"f {' '.join(str(8 * k + i) for i in face)}\n" for face in FACES)


def repeated(levels: int) -> str:
    """A rectangle, ten of it, ten of these, ..."""
    groups = [f'<g id="a{k}">' + f'<use x:href="#a{k - 1}"/>' * 10 + "</g>" for k in range(1, levels)]
    return SVG.format('<g id="a0"><rect width="1" height="1"/></g>' + "".join(groups))


FILES = {
    "times.csv": "0,0\n1e-300,1\n1e300,1\n",
    "steps.csv": "0,0\n1e-9,1\n1000,1\n",
    "values.csv": "0,0\n0.01,1e300\n0.02,0\n",
    "weak.csv": "0,0\n0.01,1e-320\n0.02,0\n",
    "strong.csv": "0,0\n0.01,1e29\n0.02,0\n",
    "line.csv": "0,0\n" + "0," * 500_001 + "\n",
    "around.svg": SVG.format(f'<polygon points="{" ".join(f"{x:.9g},{y:.9g}" for x, y in AROUND)}"/>'),
    "other.svg": SVG.format('<rect width="1" height="1"/>').replace("2000", "2001"),
    "far.svg": SVG.format('<rect y="1e9" width="1200" height="200"/><rect width="400" height="200"/>'),
    "itself.svg": SVG.format('<g id="a"><rect width="1" height="1"/><use x:href="#a"/></g>'),
    "repeated.svg": repeated(8),
    "face.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf " + "1 2 3 " * MOST_CORNERS + "\n",
    "bell.obj": cube(0).replace("o b0", "o a\a"),
    "cubes.obj": "".join(map(cube, range(MOST_TOGETHER + 1))),
}
REFUSED = {
    "times of a record": (f'{RECORD}"times.csv"', "a time of 1e+300 s is not allowed; at most 1e+07 s"),
    "steps of a record": (f'{RECORD}"steps.csv"', "a step of 1e-09 s in 1e+03 s are not allowed"),
    "values of a record": (f'{RECORD}"values.csv"', "a value of 1e+300 is not allowed"),
    "a weak record": (f'{RECORD}"weak.csv"\npeak = 1.0', "a peak acceleration of 1e-320 m/s2 is not allowed; at least"),
    "a strong record": (f'{RECORD}"strong.csv"\nscale = 1e30', "m/s2 is not allowed; at most 1e+12 m/s2"),
    "a strong pulse": (f'{SHAKEN}kind = "pulse"\namplitude = 1e30\nfrequency = 1.0', "1e+30 m/s2 is not allowed"),
    "a record that is a device": (f'{RECORD}"/dev/zero"', "/dev/zero is a device; a record is a file"),
    "a record that is a folder": (f'{RECORD}"/"', "is a folder; a record is a file"),
    "a duration": (SHAKEN.replace("[motion]", "duration = 1e29\n[motion]"), "analysis.duration: 1e+29 is not allowed"),
    "a slow pulse": (f'{SHAKEN}kind = "pulse"\namplitude = 1.0\nfrequency = 1e-9', "lasts 1e+09 s; at most 1e+07 s"),
    "corners of an outline": (f'{JOINT}{IMPORT}"around.svg"', "5,001 corners; outlines, faces and solids have at most"),
    "corners of a wall": (
        f"{JOINT}[[structure]]\nkind = 'wall'\nblock = [0.5, 0.2]\n"
        f"outline = {{ points = {list(map(list, AROUND[:301]))} }}",
        "outline.points: 301 corners with those of the openings are too many; at most 300",
    ),
    "a line of a record": (f'{RECORD}"line.csv"', "line.csv:2: 1,000,002 characters in a line; at most 1,000,000"),
    "corners of a face": (f'{SPACE}{IMPORT}"face.obj"', "a face has 15,000 corners"),
    "corners of a block": (f"{JOINT}[[block]]\nid = 'b'\nvertices = {list(map(list, AROUND))}", "at most 5,000 lists"),
    "a drawing in itself": (f'{JOINT}{IMPORT}"itself.svg"', "'#a' refers to itself"),
    "a drawing that grows": (f'{JOINT}{IMPORT}"repeated.svg"', "shapes, all that it repeats; at most 1,000,000"),
    "a drawing of another kind": (f'{JOINT}{IMPORT}"other.svg"', "<{http://www.w3.org/2001/svg}svg>, not an SVG"),
    "a drawing of stones far apart": (
        f'{JOINT}{IMPORT}"far.svg"\nunit = "mm"',
        "its corners fall together where faces are put onto one plane over 1 m; give a smaller snap",
    ),
    "solids in one place": (f'{SPACE}{IMPORT}"cubes.obj"', "100 others have the same corners"),
    "blocks in one place": (
        JOINT + "".join(f"[[block]]\nid = 'b{k}'\nfixed = true\n{SQUARE}\n" for k in range(MOST_TOGETHER + 2)),
        "block 'b1' lies where block 'b0' does, and so do 100 others",
    ),
    "blocks of a vault": (
        f'{SPACE}[[structure]]\nkind = "vault"\nshape = "barrel"\nspan = 4.0\nlength = 4.0\nthickness = 0.3\n'
        "rise = 1.0\nvoussoirs = 10000\nrows = 10000",
        "1e+08 blocks are too many",
    ),
    "courses of a gable": (
        f'{SPACE}[[structure]]\nkind = "building"\nblock = [0.5, 0.2, 0.3]\ncourses = 3\n[[structure.walls]]\n'
        "id = 'w'\naxis = [[0.0, 0.0], [4.0, 0.0]]\ngable = { height = 1e18 }",
        "gable.height: 5e+18 blocks are too many",
    ),
    "an outline that is flat": (
        f"{JOINT}[[structure]]\nkind = 'voronoi-wall'\nthickness = 0.5\ncell = 0.4\n"
        "outline.points = [[0.0, 0.0], [2.0, 0.0], [2e8, 1.2], [1.0, 1.6], [0.0, 1.2]]",
        "its corners lie on one line but for ",
    ),
    "quoins": (
        f"{JOINT}[[structure]]\nkind = 'voronoi-wall'\nsize = [4.0, 3e8]\nthickness = 0.5\ncell = 0.4\n"
        "quoins = { length = 0.6, height = 0.3 }",
        "quoins.height: makes 2e+09 stones; at most 100,000",
    ),
    "courses of spandrels": (
        f"{JOINT}[[structure]]\nkind = 'bridge'\nspan = 3.0\nring = 0.4\nvoussoirs = 9\n"
        "spandrels = { block = [0.8, 0.4], cover = 5e6 }",
        "spandrels.block: 7.19e+07 blocks are too many",
    ),
    "courses of a section": (
        f"{JOINT}[[structure]]\nkind = 'wall-section'\nsize = [0.7, 1e11]\ncourse = [0.25, 0.03]\n"
        "face = [0.2, 0.03]\ncell = 0.2",
        "course: makes 8e+11 stones; at most 100,000",
    ),
    "stones of a herringbone": (
        f"{JOINT}[[structure]]\nkind = 'herringbone-wall'\nsize = [1.0, 1.0]\nthickness = 0.3\nblock = [2e7, 0.2]",
        "block: a length of 2e+07 is not allowed; must be at most 1.414, the diagonal of the wall",
    ),
    "squares of a herringbone": (
        f"{JOINT}[[structure]]\nkind = 'herringbone-wall'\nsize = [10.0, 10.0]\nthickness = 0.3\nblock = [10.0, 0.001]",
        "block: 1e+08 blocks are too many",
    ),
    "a wall that is next to nothing thick": (
        f"{FLAT}thickness = 1e-300\nblock = [0.5, 0.2]\n[[load]]\nblock = 's-2-1'\nat = [0.0, 0.0, 0.3]\n"
        "force = [1.0, 0.0, 0.0]",
        "block 's-base' has no volume",
    ),
    "courses that are next to nothing high": (
        f"{FLAT}thickness = 0.2\nblock = [0.5, 1e-300]\n[[load]]\nblock = 's-2-1'\nat = [0.0, 0.0, 0.0]\n"
        "force = [1.0, 0.0, 0.0]",
        "block 's-base' has no volume",
    ),
    "blocks without a mass that share a load": (
        f"{FLAT}thickness = 1e-200\nblock = [0.5, 1e-200]\n[[load]]\nstructure = 's'\nforce = [1.0, 0.0, 0.0]",
        "block 's-base' has no volume",
    ),
    "a name that no file has": (f'{RECORD}"{"a" * 300}.csv"', "aa... cannot be opened (File name too long)"),
    "a drawing that no file is": (f'{JOINT}{IMPORT}"{"a" * 300}.svg"', "aa... cannot be opened (File name too long)"),
    "a title that turns the terminal red": (f'title = "\\u001b[31m"\n{COLUMN}', r"title: '\x1b[31m' is not allowed"),
    "a title that hides": (f'title = "\\u202e"\n{COLUMN}', r"title: '\u202e' is not allowed"),
    "a file with NUL in its name": (f'{JOINT}{IMPORT}"a\\u0000.svg"', r"file: 'a\x00.svg' is not allowed"),
    "a name of two lines": (f'{COLUMN}id = "a\\nerror: b"\n', r"id: 'a\nerror: b' is not allowed"),
    "a table of two lines": (f'{COLUMN}[joints."a\\nb"]\nfriction = 0.5\n', r"joints: the name 'a\nb' is not allowed"),
    "a block that rings": (f'{SPACE}{IMPORT}"bell.obj"', r"the name 'a\x07' has control characters"),
    "frames": (f"{COLUMN}[output]\nframes = 1000000000", "output.frames: 1000000000 is not allowed"),
    "loads": (COLUMN + "[[load]]\n" * (MOST_TABLES + 1), "load: 10,001 tables are too many; at most 10,000"),
    "mistakes of what is built": (f"{COLUMN}{LOAD * 600}", "and 100 more mistakes"),
    "mistakes": (COLUMN + "".join(f"x{k} = 1\n" for k in range(600)), "and 100 more mistakes"),
    "next to no mass": (COLUMN.replace("2000.0", "1e-300"), "has a mass of"),
    "a mass": (COLUMN.replace("2000.0", "5e-324"), "has a mass of"),
    "an arch far away": (
        f'{SPACE}[[structure]]\nkind = "wall"\nblock = [0.5, 0.2, 0.2]\ncourses = 9\nlength = 4.0\n'
        "openings = [{ x = 1.0, y = 0.0, width = 1.0, height = 1e18, arch = { voussoirs = 9, ring = 0.2 } }]",
        "arch.ring: 0.2 is not allowed; too thin to be told apart",
    ),
}  # fmt: skip


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("limits")
    for name, text in FILES.items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder


@pytest.mark.parametrize("name", REFUSED)
def test_one_message_says_what_is_allowed(place, name):
    text, says = REFUSED[name]
    case = place / "case.toml"
    case.write_text(text, encoding="utf-8")
    done = CliRunner().invoke(main, ["check", str(case)])
    assert done.exit_code == 2, done.output[-500:]
    assert says in done.output
    assert len(done.output.splitlines()) <= MOST_MISTAKES + 1


def test_a_drawing_that_inserts_itself(tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    drawing = ezdxf.new()
    block = drawing.blocks.new("A")
    block.add_lwpolyline([(0, 0), (1, 0), (1, 1)], close=True)
    block.add_blockref("A", (1, 1))
    drawing.modelspace().add_blockref("A", (0, 0))
    drawing.saveas(tmp_path / "itself.dxf")
    (tmp_path / "case.toml").write_text(f'{JOINT}{IMPORT}"itself.dxf"', encoding="utf-8")
    done = CliRunner().invoke(main, ["check", str(tmp_path / "case.toml")])
    assert (done.exit_code, "'A' refers to itself" in done.output) == (2, True), done.output


def damaged_drawing(folder, old, new):
    """A drawing of a wall in which some bytes are others; what `dem check` says of it."""
    ezdxf = pytest.importorskip("ezdxf")
    drawing = ezdxf.new()
    drawing.modelspace().add_lwpolyline([(0, 0), (1234, 0), (1234, 800), (0, 800)], close=True)
    drawing.saveas(folder / "wall.dxf")
    data = (folder / "wall.dxf").read_bytes()
    assert old in data
    (folder / "wall.dxf").write_bytes(data.replace(old, new))
    wall = "[[structure]]\nkind = 'wall'\nblock = [0.4, 0.2]\noutline = { file = 'wall.dxf', unit = 'mm' }\n"
    (folder / "case.toml").write_text(JOINT + wall, encoding="utf-8")
    return CliRunner().invoke(main, ["check", str(folder / "case.toml")])


@pytest.mark.parametrize("new", [b"\x98", b"1\x98", b"1e999", b"nan"])
@pytest.mark.filterwarnings("error")
def test_a_drawing_of_damaged_bytes(tmp_path, new):
    """Damaged text and numbers of a drawing are named in one line that a terminal and a page can show."""
    done = damaged_drawing(tmp_path, b"1234.0", new)
    assert done.exit_code == 2, done.output
    assert done.output.startswith("error: ")
    assert len(done.output.splitlines()) == 1
    done.output.encode("utf-8")


@pytest.mark.parametrize(("path", "says"), [("/dev/zero", "is a device"), ("/", "is a folder")])
def test_a_case_that_is_no_file(path, says):
    done = CliRunner().invoke(main, ["check", path])
    assert (done.exit_code, done.output.startswith(f"error: {path}: {says}")) == (2, True), done.output


def test_pipes(tmp_path, monkeypatch):
    """A pipe that is silent is refused, one that ends at once too; what comes through one is read."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with pytest.raises(UnreadableInput, match="is a pipe; only files are read"):
        read_bounded(pipe, 10)
    source, sink = os.pipe()
    try:
        monkeypatch.setattr(input_limits, "PIPE_SECONDS", 0.01)
        for silent in (pipe, Path(f"/dev/fd/{source}")):
            with pytest.raises(UnreadableInput, match=r"nothing came in 0\.01 s"):
                read_bounded(silent, 10, pipes=True)
        monkeypatch.setattr(input_limits, "PIPE_SECONDS", 60.0)
        writer = threading.Thread(target=lambda: (os.write(sink, b"x = 1"), os.close(sink)))
        writer.start()
        assert read_bounded(Path(f"/dev/fd/{source}"), 10, pipes=True) == b"x = 1"
        writer.join()
    finally:
        os.close(source)


def test_files_are_read_up_to_a_limit(tmp_path):
    (tmp_path / "file").write_bytes(b"x" * 11)
    assert read_bounded(tmp_path / "file", 11) == b"x" * 11
    with pytest.raises(UnreadableInput, match="at most"):
        read_bounded(tmp_path / "file", 10)


def test_every_limit_is_on_the_page():
    page = (Path(__file__).resolve().parents[2] / "docs" / "guide" / "limits.md").read_text(encoding="utf-8")
    rows = [line for line in page.splitlines() if line.startswith("| ") and not line.startswith(("| what", "| ---"))]
    assert len(rows) == sum(map(len, LIMITS.values()))
    told = {limit.most for limits in LIMITS.values() for limit in limits}
    constants = {name: value for name, value in vars(input_limits).items() if name.isupper()}
    assert {name for name, value in constants.items() if value not in told and not name.startswith("_")} == set()


def test_a_terminal_obeys_nothing_that_others_wrote(tmp_path):
    """Names of files reach messages too; those that are no text at all are written out."""
    for name, shown in (("a\x1b[31m.toml", r"a\x1b[31m.toml"), ("a\udcff.toml", r"a\udcff.toml")):
        done = CliRunner().invoke(main, ["check", str(tmp_path / name)])
        assert (done.exit_code, shown in done.output) == (2, True), done.output


OUTPUTS = {
    "report": (("report", "RESULTS"), ".html"),
    "build": (("build", "CASE"), ".obj"),
    "pvd": (("export", "RESULTS", "--pvd"), ""),
    "limit": (("limit", "CASE", "-q"), ""),
    "run": (("run", "CASE", "-q"), ""),
}


@pytest.mark.parametrize("name", OUTPUTS)
def test_names_of_output_that_no_file_can_have(tmp_path, name):
    """Too long, through a file, of a pipe: all were faults of the program, or the pipe was replaced."""
    words, suffix = OUTPUTS[name]
    (tmp_path / "case.toml").write_text(COLUMN, encoding="utf-8")
    wall(tmp_path / "results")
    os.mkfifo(tmp_path / f"pipe{suffix}")
    words = [
        {"RESULTS": str(tmp_path / "results"), "CASE": str(tmp_path / "case.toml")}.get(word, word) for word in words
    ]
    for output, says in (
        ("a" * 300 + suffix, "too long"),
        ("b/" * 3000 + "c" + suffix, "too long"),
        (f"case.toml/c{suffix}", "a part of the path is a file"),
        (f"pipe{suffix}", "a pipe" if suffix else "a"),
    ):
        done = CliRunner().invoke(main, [*words, "-o", str(tmp_path / output)])
        assert done.exit_code in (2, 3), (output[:20], done.output)
        assert says in done.output
        assert "internal error" not in done.output
        assert (tmp_path / f"pipe{suffix}").is_fifo()
