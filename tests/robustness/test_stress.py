"""The short form of scripts/study stress, and its harness: a wrong answer is seen, and nothing else is called wrong."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from oracle.limit_lp import frictionless_heads, limit_load
from studies import storage, study
from studies.stress import proportions, structures, tables, transformations, verdicts
from studies.stress.study import AXES, STUDY, StressStudy
from studies.stress.verdicts import PushoverAnswer as Answer
from studies.stress.verdicts import judge

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("axis", AXES)
def test_short_form(axis):
    """Nothing wrong without a word, and most of it held."""
    found = list(AXES[axis](True))
    assert [tables.line(r) for r in found if r.verdict == verdicts.WRONG] == []
    assert sum(r.verdict == verdicts.HELD for r in found) >= 0.3 * len(found)


# -- the harness -------------------------------------------------------------------------------------


def test_wrong_reference_is_wrong():
    right = structures.named()["slide"]
    wrong = replace(right, exact=(0.41, 0.41))
    assert verdicts.load_record("a", right, "1").verdict == verdicts.HELD
    record = verdicts.load_record("a", wrong, "1")
    assert record.verdict == verdicts.WRONG
    assert record.error == pytest.approx(-0.01 / 0.41, rel=1e-6)


def test_exit_code(monkeypatch, capsys, tmp_path):
    """1 where anything was wrong silently, and the record says what."""

    def axis(short):
        yield verdicts.figure("made up", "one", "1", 0.5, 1.0)
        yield verdicts.figure("made up", "two", "1", 2.0, 1.0)

    def harmless(short):
        """All is well."""
        yield verdicts.figure("well", "one", "1", 0.0, 1.0)

    monkeypatch.setattr(storage, "DATA", tmp_path)
    monkeypatch.setattr(study, "DOCS", tmp_path)
    stress = StressStudy("stress", "made up", {"made": axis, "well": harmless})
    assert stress.main(["well", "--json", str(tmp_path / "r.json")]) == 0
    assert json.loads((tmp_path / "r.json").read_text())[0]["how"] == "exactly zero"
    assert stress.main([]) == 1
    assert "WRONG    made up 1, two" in capsys.readouterr().out
    assert stress.main(["--write"]) == 1
    text = (tmp_path / "stress.md").read_text()
    assert "**WRONG** +2e+02 %" in text
    assert "All is well." in text


@pytest.mark.parametrize("words", [["nonsense"], ["mass", "--write"], ["--short", "--write"]])
def test_wrong_arguments(words, capsys):
    with pytest.raises(SystemExit) as stopped:
        STUDY.main(words)
    assert stopped.value.code == 2
    assert "error" in capsys.readouterr().err


VERDICTS = {
    "inside the bracket": (Answer("ok", 0.595, (0.595, 0.61)), "held"),
    "inside 0.5 %": (Answer("ok", 0.5975, (0.5975, 0.598)), "held"),
    "outside": (Answer("ok", 0.59, (0.59, 0.591)), "WRONG"),
    "outside, warned": (Answer("ok", 0.59, (0.59, 0.591), ["do not trust this run"]), "warned"),
    "not converged": (Answer("not converged", None, (0.1, None)), "refused"),
    "stands for ever": (Answer("no failure up to a load multiplier of 20", None, (20.0, None)), "WRONG"),
    "falls at once": (Answer("does not stand under its dead loads"), "WRONG"),
    "falls at once, warned": (Answer("does not stand under its dead loads", warnings=["soft"]), "warned"),
    "refused": (Answer("refused", refusal="blocks overlap"), "refused"),
    "crashed": (Answer("crashed", crash="ZeroDivisionError"), "WRONG"),
    "not a number": (Answer("ok", float("nan"), (0.0, None)), "WRONG"),
}


@pytest.mark.parametrize(("answer", "verdict"), VERDICTS.values(), ids=VERDICTS)
def test_verdicts(answer, verdict):
    assert judge(answer, (0.6, 0.6))[0] == verdict


def test_error_counts_from_the_interval():
    assert [verdicts.off(x, (0.5, 0.6)) for x in (0.5, 0.55, 0.6)] == [0.0, 0.0, 0.0]
    assert verdicts.off(0.45, (0.5, 0.6)) == pytest.approx(-0.1)
    assert verdicts.off(0.66, (0.5, 0.6)) == pytest.approx(0.1)


def lowered(b):
    return transformations.with_pieces(b, [p - np.array([0.0, 0.1]) for p in transformations.pieces(b)])


def test_refusals_and_crashes_are_kept():
    """A case that is not accepted, a bug, and a word about speed that excuses nothing."""
    right = structures.named()["rock"]
    sunk = transformations.each_block(right, lambda b, rng: b if b.get("fixed") else lowered(b))
    assert "overlaps" in verdicts.push(sunk).refusal

    def broken(model):
        raise ZeroDivisionError("a bug")

    assert verdicts.push(replace(right, change=broken)).crash == "ZeroDivisionError: a bug"
    thin = verdicts.push(structures.stack((1.0,), (5e-4,), (2000.0,), 0.4))
    assert any("expect tiny steps" in line for line in thin.summary["said"])
    assert thin.warnings == []


def test_not_a_number_exceeds_every_limit():
    assert verdicts.figure("a", "b", "c", float("nan"), 1.0).verdict == verdicts.WRONG


def test_likeness():
    base = Answer("ok", 0.6, (0.6, 0.601))
    assert verdicts.likeness(Answer("ok", 0.6, (0.6, 0.601)), base) == "bit-identical"
    assert verdicts.likeness(Answer("ok", 0.6, (0.6, 0.602)), base) == "1.0e-16"
    assert verdicts.likeness(Answer("ok", 0.6006, (0.6006, 0.602)), base) == "1.0e-03"


# -- the scenes --------------------------------------------------------------------------------------

CLOSED = {
    **{name: scene for name, scene in structures.named().items() if not name.startswith("wall 0.")},
    "wall 0.5": structures.named()["wall 0.5"], "wall 0.6": structures.named()["wall 0.6"],
    "stack": structures.stack((0.5, 0.5, 0.3), (0.5, 0.4, 1.0), (2000.0, 200.0, 700.0), 1.0),
    "sliding stack": structures.stack((1.0, 1.0), (0.25, 0.25), (2000.0, 20.0), 0.3),
    "trilith, light lintel": structures.trilith(lintel=1e-2),
    "trilith, low": structures.trilith(foot=0.04, height=0.2),
    "chamfered": proportions.chamfered(0.02),
    "wedge": proportions.wedge(0.05),
}  # fmt: skip


def oracle(scene: object, heads: bool = True) -> float:
    """Associated limit load of a scene, by the program of the tests."""
    case, model, _ = scene.build()
    owner = np.repeat(model.part_blocks, np.diff(model.part_starts))
    polygons = np.split(model.vertices + model.centroids[owner], model.part_starts[1:-1])
    mu = next(iter(case.joints.values())).friction
    return limit_load(polygons, model.fixed, mu if heads else frictionless_heads(mu), weights=model.masses).multiplier


@pytest.mark.parametrize("name", [n for n in CLOSED if n != "wall 1.0"])
def test_exact_loads(name):
    scene = CLOSED[name]
    assert scene.exact[0] == pytest.approx(oracle(scene), rel=1e-5)


@pytest.mark.parametrize("name", ["wall 0.65", "wall 0.7", "wall 0.75", "wall 1.0"])
def test_interval_of_frictional_walls(name):
    """Without friction in the head joints below, and at most with it above."""
    scene = structures.named()[name]
    assert scene.exact[0] == pytest.approx(oracle(scene, heads=False), rel=2e-6)
    assert scene.exact[1] <= oracle(scene) * (1 + 1e-6)


CHANGES = {
    "explicit": structures.explicit, "blocks": transformations.blocks_in_any_order,
    "corners": transformations.corners_in_any_order,
    "clockwise": transformations.corners_clockwise, "renumbered": transformations.renumbered,
    "moved": lambda s: transformations.moved(s, 7, -3), "mirrored": transformations.mirrored,
    "units": lambda s: transformations.scaled(s, 10.0, 0.1, 2.0),
}  # fmt: skip


@pytest.mark.parametrize("name", CHANGES)
def test_changes_keep_the_limit_load(name):
    """A changed structure is the same one: judged by limit analysis, not by the solver."""
    scene = structures.named()["portal"]
    assert oracle(CHANGES[name](scene)) == pytest.approx(oracle(scene), rel=1e-6)


@pytest.mark.parametrize("name", [n for n in CHANGES if n != "explicit"])
def test_changes_change_something(name):
    scene = structures.explicit(structures.named()["portal"])
    changed = CHANGES[name](scene)
    assert changed.tables != scene.tables or not np.array_equal(changed.build()[1].masses, scene.build()[1].masses)


def test_rotation_turns_structure_and_loads():
    """By 90°: weight towards +x, push towards +y, the same moments."""
    scene = structures.named()["portal"]
    model, turned = scene.build()[1], transformations.rotated(scene, 90.0).build()[1]
    for key in ("centroids", "vertices", "dead_loads", "live_loads"):
        before, after = getattr(model, key), getattr(turned, key)
        assert after[:, 0] == pytest.approx(-before[:, 1], abs=1e-12)
        assert after[:, 1] == pytest.approx(before[:, 0], abs=1e-9)


def test_document_is_written():
    """docs/stress.md has a section for every axis and is not the one of another day's axes."""
    text = (ROOT / "docs" / "stress.md").read_text(encoding="utf-8")
    for axis, check in AXES.items():
        assert (check.__doc__ or "").strip() in text, axis
