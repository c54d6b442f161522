"""Results that are damaged: every command that reads them says what of them is missing or wrong, in one line."""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from click.testing import CliRunner
from synthetic.pages import sweep, wall
from synthetic.shaking import write_shaking
from synthetic.solid_runs import solid_frames, solid_wall, write_solid_run

import dem_cli
from dem_cli.app.cli.main import main
from dem_cli.core.contact.drawn_joints import DrawnJoints
from dem_cli.errors import DamagedResults

COMMANDS = (("report",), ("plot", "--list"), ("export", "--joints"), ("render",))


@pytest.fixture(autouse=True)
def no_pictures(monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)


@pytest.fixture(scope="session")
def whole(tmp_path_factory):
    """Results that nothing is wrong with: in the plane, shaken, in space, and a sweep."""
    place = tmp_path_factory.mktemp("whole")
    wall(place / "plane")
    for name in ("shaken", "space"):
        (place / name).mkdir()
    write_shaking(place / "shaken", 3)
    model = solid_wall()
    write_solid_run(place / "space", model, solid_frames(model, 2), DrawnJoints)
    sweep(place / "sweep")
    return place


def edited(path: str, change):
    """Damage: a dataset is what `change` makes of its values; None: it is gone."""

    def damage(folder: Path) -> None:
        with h5py.File(folder / "results.h5", "r+") as file:
            values = file[path][()]
            del file[path]
            if change is not None:
                file[path] = change(values)

    return damage


def attribute(path: str, name: str, value):
    """Damage: an attribute has another value; None: it is gone."""

    def damage(folder: Path) -> None:
        with h5py.File(folder / "results.h5", "r+") as file:
            del file[path].attrs[name]
            if value is not None:
                file[path].attrs[name] = value

    return damage


def cut(share: float, name: str = "results.h5"):
    def damage(folder: Path) -> None:
        raw = (folder / name).read_bytes()
        (folder / name).write_bytes(raw[: int(share * len(raw))])

    return damage


def written(text: str, name: str = "summary.json"):
    return lambda folder: (folder / name).write_text(text, encoding="utf-8")


def said(*path, value=None):
    """Damage: a key of summary.json has another value; without one it is gone."""

    def damage(folder: Path) -> None:
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        table = summary
        for key in path[:-1]:
            table = table[key]
        if value is None:
            del table[path[-1]]
        else:
            table[path[-1]] = value
        (folder / "summary.json").write_text(json.dumps(summary), encoding="utf-8")

    return damage


def first(value):
    """The same values, the first of which is another one."""

    def change(values):
        values.flat[0] = value
        return values

    return change


def elsewhere(folder: Path) -> None:
    with h5py.File(folder / "results.h5", "r+") as file:
        del file["dem/frames/positions"]
        file["dem/frames/positions"] = h5py.ExternalLink("/dev/zero", "/")


def inflated(folder: Path) -> None:
    """A terabyte that takes no space on the disk."""
    with h5py.File(folder / "results.h5", "r+") as file:
        del file["dem/model/masses"]
        file.create_dataset("dem/model/masses", (10**11,), "f8", chunks=(10**6,), compression="gzip")


def overwritten(path: str):
    """Damage: the bytes of the header of a dataset are zeros; HDF5 still has its name."""

    def damage(folder: Path) -> None:
        with h5py.File(folder / "results.h5") as file:
            place = h5py.h5o.get_info(file[path].id).addr
        raw = bytearray((folder / "results.h5").read_bytes())
        raw[place : place + 8] = bytes(8)
        (folder / "results.h5").write_bytes(bytes(raw))

    return damage


DAMAGES = {
    "positions are gone": ("plane", edited("dem/frames/positions", None), "/dem/frames/positions is missing"),
    "counts are gone": ("plane", edited("dem/frames/n_contacts", None), "/dem/frames/n_contacts is missing"),
    "forces are gone": ("space", edited("dem/contacts/normal_force", None), "/dem/contacts/normal_force is missing"),
    "faces are gone": ("space", edited("dem/model/face_starts", None), "/dem/model/face_starts is missing"),
    "the motion is gone": ("shaken", edited("dem/series/base_velocity", None), "base_velocity is missing"),
    "masses are words": ("plane", edited("dem/model/masses", lambda v: v.astype("S8")), "holds |S8, not numbers"),
    "a mass is no number": ("plane", edited("dem/model/masses", first(np.nan)), "/dem/model/masses is not finite"),
    "a place is infinite": ("space", edited("dem/frames/positions", first(np.inf)), "positions is not finite"),
    "a corner beyond all": ("space", edited("dem/model/vertices", first(1.7e308)), "vertices holds 1.7e+308; products"),
    "a place beyond pictures": ("plane", edited("dem/frames/positions", first(-1e300)), "positions holds 1e+300"),
    "a block without parts": ("space", edited("dem/model/part_blocks", lambda v: v * 0), "leaves a block without any"),
    "a frame is cut off": ("plane", edited("dem/frames/load", lambda v: v[:-1]), "/dem/frames/load has the shape"),
    "an axis more": ("plane", edited("dem/history/load", lambda v: v[:, None]), "/dem/history/load has the shape"),
    "a block too many": ("plane", edited("dem/model/fixed", lambda v: np.append(v, v)), "fixed has the shape"),
    "of no block": ("plane", edited("dem/contacts/blocks", first(99)), "holds the number of block 99"),
    "of no stage": ("plane", edited("dem/history/stage", first(-3)), "/dem/history/stage holds the number of stage -3"),
    "corners that go back": ("space", edited("dem/model/part_starts", first(3)), "part_starts does not count"),
    "the case is a number": ("plane", edited("dem/case", lambda v: 3.0), "/dem/case holds float64, not text"),
    "no dimension": ("plane", attribute("dem/model", "dimension", None), "the attribute dimension is missing"),
    "four dimensions": ("plane", attribute("dem/model", "dimension", 4), "the attribute dimension is 4; it is 2 or 3"),
    "a kind that is none": ("plane", attribute("dem", "kind", 7), "/dem: the attribute kind is not text"),
    "of another run": ("shaken", attribute("dem", "kind", "modes"), "is of kind 'time-history'"),
    "monitors of no quantity": ("shaken", attribute("dem/series", "quantities", ["x", "y"]), "/dem/series: the attr"),
    "stored elsewhere": ("plane", elsewhere, "/dem/frames/positions is a link to something else"),
    "a terabyte": ("plane", inflated, "it would take 800 GB to read a file of"),
    "a header is gone": ("plane", overwritten("dem/model/masses"), "results.h5 cannot be read ("),
    "the header of joints is gone": ("space", overwritten("dem/joints/state"), "results.h5 cannot be read ("),
    "half a file": ("plane", cut(0.5), "results.h5 is not a whole file of HDF5"),
    "an empty file": ("space", cut(0.0), "results.h5 is not a whole file of HDF5"),
    "half a summary": ("plane", cut(0.5, "summary.json"), "summary.json is not valid JSON"),
    "a summary that is a list": ("plane", written("[]"), "summary.json is not a table"),
    "a summary without end": ("plane", written("[" * 100_000), "summary.json is not valid JSON"),
    "a summary with NaN": ("plane", written('{"title": NaN}'), "summary.json is not valid JSON (NaN"),
    "no status": ("plane", said("status"), "summary.json: status is missing"),
    "a load in words": ("plane", said("failure_load", value="high"), "summary.json: failure_load is not a number"),
    "a load beyond pictures": ("plane", said("failure_load", value=-1e300), "failure_load is not in its range"),
    "half a bracket": ("plane", said("failure_load_bracket", value=[0.1]), "failure_load_bracket is not two numbers"),
    "a load beyond all": ("plane", said("failure_load", value=10**400), "summary.json: failure_load is not"),
    "a peak without unit": ("shaken", said("peaks", "top displacement x", "unit"), 'x".unit is missing'),
    "warnings that are none": ("plane", said("warnings", value=3), "summary.json: warnings is not a list"),
    "a table in tatters": ("sweep", written("run,a,status\nr1,2\n", "sweep.csv"), "row 2 has 2 cells, not 3"),
    "a table of bytes": ("sweep", lambda f: (f / "sweep.csv").write_bytes(b"\xff\xfe"), "sweep.csv is not UTF-8 text"),
    "facts that are none": ("sweep", written("3", "sweep.json"), "sweep.json is not a table"),
    "keys of another sweep": ("sweep", written('{"keys": ["b"]}', "sweep.json"), "the column 'b' is missing"),
}  # fmt: skip


@pytest.mark.parametrize("name", DAMAGES)
def test_one_line_says_what_is_wrong(whole, tmp_path, name):
    source, damage, says = DAMAGES[name]
    folder = tmp_path / "results"
    shutil.copytree(whole / source, folder)
    damage(folder)
    for command in COMMANDS if source != "sweep" else COMMANDS[:2]:
        done = CliRunner().invoke(main, [*command, str(folder)])
        assert done.exit_code == 2, (command, done.output)
        assert done.output.startswith(f"error: {folder}: these results are damaged: "), done.output
        assert says in done.output
        assert len(done.output.splitlines()) == 1
    if source != "sweep":
        with pytest.raises(DamagedResults, match="damaged"), dem_cli.open(folder) as result:
            list(result.frames)


@pytest.mark.parametrize("source", ["plane", "shaken", "space"])
def test_results_that_are_whole_are_read(whole, source):
    with dem_cli.open(whole / source) as result:
        assert len(result.frames) >= 2
        assert result.contacts()["force"].shape[1] == result.model.dimension


def test_frames_that_are_read_later_are_checked_then(whole, tmp_path):
    shutil.copytree(whole / "plane", tmp_path / "results")
    edited("dem/contacts/normal_force", lambda v: np.append(v[:-1], np.nan))(tmp_path / "results")
    with dem_cli.open(tmp_path / "results") as result:
        assert result.frames[0].step >= 0
        with pytest.raises(DamagedResults, match="/dem/contacts/normal_force is not finite"):
            result.frames[-1]


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_numbers_of_half_precision_are_read(whole, tmp_path):
    shutil.copytree(whole / "plane", tmp_path / "results")
    edited("dem/model/live_loads", lambda v: np.ones(v.shape, "f2"))(tmp_path / "results")
    with dem_cli.open(tmp_path / "results") as result:
        assert result.model.live_loads.max() == 1.0


def test_results_that_were_compressed_are_read(whole, tmp_path):
    shutil.copytree(whole / "plane", tmp_path / "results")

    def packed(folder):
        with h5py.File(folder / "results.h5", "r+") as file:
            values = file["dem/frames/positions"][()]
            del file["dem/frames/positions"]
            file.create_dataset("dem/frames/positions", data=values, chunks=True, compression="gzip")

    packed(tmp_path / "results")
    with dem_cli.open(tmp_path / "results") as result:
        assert np.isfinite(result.frames[-1].positions).all()


def test_all_pictures_go_to_a_folder_and_not_to_a_file(whole, tmp_path):
    """A folder of that name was made."""
    target = tmp_path / "pictures.doc"
    done = CliRunner().invoke(main, ["plot", str(whole / "plane"), "-o", str(target)])
    assert done.exit_code == 2
    assert "all pictures of a run go to a folder; '.doc' names a file" in done.output
    assert not target.exists()
