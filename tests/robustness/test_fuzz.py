"""scripts/fuzz: what it draws, what it finds, and a handful of its seeds without any find."""

from __future__ import annotations

import json
import random
import tomllib

import pytest
from fuzzing import __main__ as fuzzing
from fuzzing.cases import case
from fuzzing.damage import damaged
from fuzzing.structures import STRUCTURES


def clean(words, folder, capfd):
    """What is said of these seeds, which have no find."""
    assert fuzzing.main([*words, "--keep", str(folder)]) == 0
    said = capfd.readouterr().out
    assert "0 finds" in said
    assert list(folder.iterdir()) == []
    return said


def test_a_handful_of_checks(tmp_path, capfd):
    said = clean(["--checks", "126:129"], tmp_path, capfd)
    assert said.startswith("checks 126:129: 2 refused, 1 read")


def test_more_checks_and_a_run(tmp_path, capfd):
    said = clean(["--checks", "103:123", "--runs", "740:741"], tmp_path, capfd)
    assert "runs 740:741: 1 pushover ok" in said


def test_everything_is_drawn():
    drawn = [case(f"check {seed}") for seed in range(1000)]
    assert {(tables["structure"][0]["kind"], "dimension" in tables) for tables in drawn} >= {
        *((kind, True) for kind in STRUCTURES),
        ("wall", False),
    }
    keys = {key for tables in drawn for key in (*tables, *tables["structure"][0], *tables["joints"]["dry"])}
    assert keys >= {
        "load",
        "pressure",
        "fill",
        "tie",
        "bars",
        "imperfection",
        "motion",
        "damping",
        "restraint",
        "ground",
    }
    assert keys >= {"outline", "openings", "leaves", "core", "gable", "sides", "crack", "head", "profile"}
    assert {tables["analysis"].get("kinematics") for tables in drawn} == {None, "fixed", "large"}
    assert case("check 3") == drawn[3]


def test_damage_is_that_of_a_seed():
    tables = case("check 3")
    texts = {damaged(random.Random(seed), tables, case("check 4")) for seed in range(50)}
    assert len(texts) > 45
    assert damaged(random.Random(7), tables, case("check 4")) in texts
    assert case("check 3") == tables


@pytest.mark.parametrize(
    ("said", "kind", "code", "found"),
    [
        ("  mass  1.5 kg", "checks", 0, []),
        ("  kn h/E inf", "checks", 0, ["prints inf"]),
        ("  mass  nan kg, -nan", "checks", 0, ["prints nan"]),
        ("  block 'nan-1', x-inf, inflow", "checks", 0, []),
        ("", "checks", 2, ["exit code 2: some words"]),  # no message
        ("", "checks", 70, ["exit code 70: some words"]),
        ('{"kind": "gravity", "status": "ok", "blocks": 2}', "runs", 0, []),
        ('{"kind": "gravity", "status": "ok", "mass": Infinity}', "runs", 0, ["mass of the summary is no number"]),
        ('{"kind": "gravity", "status": "not converged: x", "steps": [1]}', "runs", 3, []),
    ],
)
def test_what_is_a_find(tmp_path, monkeypatch, said, kind, code, found):
    def main(args):
        print(said)
        print("some words", file=fuzzing.sys.stderr)
        raise SystemExit(code)

    monkeypatch.setattr("dem_cli.app.cli.main.main", main)
    monkeypatch.setattr(fuzzing, "wrong_arrays", lambda file: [])
    wrong = fuzzing.outcome(kind, "", tmp_path)[1]
    assert len(wrong) == len(found)
    assert all(word.startswith(start) for word, start in zip(wrong, found))


def test_a_load_above_its_bound_is_a_find(tmp_path, monkeypatch):
    monkeypatch.setattr(fuzzing, "wrong_arrays", lambda file: [])
    summary = {
        "status": "ok",
        "failure_load_bracket": [0.3, 0.31],
        "limit_analysis": {"associated_bounds": [0.2, 0.25]},
    }
    assert list(fuzzing.doubts(summary, tmp_path)) == ["failure load 0.3 above its bound 0.25"]
    assert list(fuzzing.doubts(summary | {"above_the_bound": {}}, tmp_path)) == []
    assert list(fuzzing.doubts(summary | {"failure_load_bracket": [0.25, 0.26]}, tmp_path)) == []


def test_a_case_that_has_had_its_time_is_cut_off(tmp_path, monkeypatch):
    def main(args):
        while True:
            pass

    monkeypatch.setattr("dem_cli.app.cli.main.main", main)
    ended, wrong, used = fuzzing.outcome("checks", "", tmp_path, limit=0.1)
    assert (ended, wrong) == ("out of time", ["takes more than 0.1 CPU s"])
    assert used < 3.0


@pytest.mark.parametrize("way", ["ends", "raises"])
def test_a_process_that_dies_is_a_find(tmp_path, monkeypatch, capsys, way):
    """One that raised said nothing and went: its seeds began anew, for ever."""

    def work(kind, seeds, pipe, limit, keep):
        for seed in seeds:
            fuzzing.os.write(pipe, f"{json.dumps([seed])}\n".encode())
            if seed == 5:
                fuzzing.os._exit(7) if way == "ends" else fuzzing.os.read(-1, 1)
            fuzzing.os.write(pipe, f"{json.dumps([seed, 'read', [], 0.5])}\n".encode())

    monkeypatch.setattr(fuzzing, "work", work)
    assert fuzzing.fuzz("checks", range(3, 9), 20.0, tmp_path) == 1
    said = capsys.readouterr().out
    assert f"find: checks 5 (0.0 CPU s): the process died: {7 if way == 'ends' else 1}" in said
    assert "checks 3:9: 5 read, 1 died" in said


def test_cases_of_the_project_keep_their_files():
    pool = fuzzing.project_cases()
    assert len(pool) > 150
    files = [table["file"] for tables in pool for table in tables.get("structure", []) if "file" in table]
    assert files
    assert all(file.startswith("/") for file in files)
    assert tomllib.loads(fuzzing.text_of("runs", 3, pool)) == case("run 3")
