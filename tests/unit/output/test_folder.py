"""The output folder: whole or not at all, and never over what is not ours."""

from __future__ import annotations

import os
import re

import pytest

from dem_cli.errors import OutputError, UsageError
from dem_cli.results.output.folder import OutputFolder, write_error
from dem_cli.results.output.summary import write_summary

OURS = {"title": "x", "kind": "pushover", "version": "0", "status": "ok"}


def fill(folder, answer, **files):
    for name, text in {"results_h5": str(answer), **files}.items():
        (folder / name.replace("_", ".")).write_text(text)
    write_summary(folder, {**OURS, "answer": answer})


def put(final, answer, **options):
    with OutputFolder(final, **options) as folder:
        fill(folder.path, answer)
        return folder.commit()


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_made_whole_with_parents(tmp_path):
    final = tmp_path / "a" / "b" / "c"
    with OutputFolder(final) as folder:
        fill(folder.path, 1)
        assert not final.exists()
        assert folder.commit() == final
    assert names(final) == ["results.h5", "summary.json"]
    assert names(final.parent) == ["c"]
    assert final.stat().st_mode & 0o777 == 0o777 & ~umask()


def umask():
    old = os.umask(0)
    os.umask(old)
    return old


def test_given_up_leaves_nothing(tmp_path):
    with OutputFolder(tmp_path / "a" / "b"):
        pass
    assert names(tmp_path) == []


def test_earlier_results_are_replaced_whole_and_only_at_the_end(tmp_path):
    final = put(tmp_path / "out", 1)
    (final / "capacity.png").write_text("old picture")
    with OutputFolder(final) as folder:
        fill(folder.path, 2)
        assert (final / "results.h5").read_text() == "1"
        folder.commit()
    assert names(final) == ["results.h5", "summary.json"]
    assert (final / "results.h5").read_text() == "2"
    assert names(tmp_path) == ["out"]


def test_earlier_results_survive_a_run_that_failed(tmp_path):
    final = put(tmp_path / "out", 1)
    with OutputFolder(final) as folder:
        fill(folder.path, 2)
    assert (final / "results.h5").read_text() == "1"
    assert names(tmp_path) == ["out"]


@pytest.mark.parametrize("name", ["thesis.txt", "case.toml", "summary.json"])
def test_a_folder_of_somebody_else_is_refused(tmp_path, name):
    (tmp_path / name).write_text("{}")
    with pytest.raises(UsageError, match=f"did not write \\({name}\\)"):
        OutputFolder(tmp_path)
    assert names(tmp_path) == [name]


def test_foreign_files_beside_our_results_are_refused_too(tmp_path):
    final = put(tmp_path / "out", 1)
    (final / "notes.txt").write_text("mine")
    with pytest.raises(UsageError, match=r"notes\.txt"):
        OutputFolder(final)


def test_force_keeps_foreign_files(tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "notes.txt").write_text("mine")
    final = put(tmp_path / "out", 1, force=True)
    put(final, 2, force=True)
    assert names(final) == ["notes.txt", "results.h5", "summary.json"]
    assert (final / "results.h5").read_text() == "2"


def test_a_file_of_that_name_is_refused(tmp_path):
    (tmp_path / "out").write_text("x")
    with pytest.raises(UsageError, match="a file of that name exists"):
        OutputFolder(tmp_path / "out")
    with pytest.raises(UsageError, match="a part of the path is a file"):
        OutputFolder(tmp_path / "out" / "deeper")


def test_the_current_folder_can_be_the_output(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    put(".", 1)
    (tmp_path / "capacity.png").write_text("old picture")
    put(".", 2)
    assert names(tmp_path) == ["results.h5", "summary.json"]
    assert (tmp_path / "results.h5").read_text() == "2"


def test_a_link_is_followed(tmp_path):
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to("real")
    put(tmp_path / "link", 1)
    assert (tmp_path / "link").is_symlink()
    assert names(tmp_path / "real") == ["results.h5", "summary.json"]


def test_leftovers_of_killed_runs_go_and_running_ones_stay(tmp_path):
    dead = tmp_path / ".out.dem-new-00000001"
    dead.mkdir()
    (dead / ".lock").write_text("")
    (tmp_path / ".out.dem-lock").write_text("")
    with OutputFolder(tmp_path / "out") as running:
        assert not dead.exists()
        with OutputFolder(tmp_path / "out", recover=False):
            assert running.path.exists()
    assert names(tmp_path) == []


@pytest.mark.parametrize("place", ["out", "."])
def test_a_second_run_into_the_same_folder_is_refused(tmp_path, monkeypatch, place):
    """Both went on, and the first to end lost its results to the other without a word."""
    monkeypatch.chdir(tmp_path)
    put(place, 1)
    said = "another run is writing its results there; wait for its end, or choose another folder with -o"
    with OutputFolder(place) as first:
        with pytest.raises(UsageError, match=f"^{re.escape(place)}: {said}"):
            OutputFolder(place)
        with pytest.raises(UsageError, match=said):
            OutputFolder(tmp_path / place, force=True)
        fill(first.path, 2)
        final = first.commit()
    assert (final / "results.h5").read_text() == "2"
    put(place, 3)
    assert (final / "results.h5").read_text() == "3"
    assert names(final) == ["results.h5", "summary.json"]


def test_results_put_aside_by_a_killed_run_come_back(tmp_path):
    put(tmp_path / "out", 1)
    (tmp_path / "out").rename(tmp_path / ".out.dem-old-00000001")
    with OutputFolder(tmp_path / "out"):
        assert (tmp_path / "out" / "results.h5").read_text() == "1"
    assert names(tmp_path) == ["out"]


def test_beside_under_another_name(tmp_path):
    final = put(tmp_path / "out", 1)
    for answer in (2, 3):
        with OutputFolder(final) as folder:
            fill(folder.path, answer)
            folder.commit("out.interrupted")
    assert names(tmp_path) == ["out", "out.interrupted"]
    assert (final / "results.h5").read_text() == "1"
    assert (tmp_path / "out.interrupted" / "results.h5").read_text() == "3"


def test_a_hidden_reason_is_found(tmp_path):
    error = write_error(RuntimeError("Can't write (errno = 28, error message = 'No space')"), tmp_path)
    assert isinstance(error, OutputError)
    assert str(error) == f"cannot write results to {tmp_path}: no space left on the device"
