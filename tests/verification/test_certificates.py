"""Certificates of pushovers, and the checker that reads them from results.h5 alone."""

from __future__ import annotations

import json

import h5py
import numpy as np
import pytest
from casefiles import FILES, case_id, read
from oracle.check_certificate import NONE, PROVED, REFUSED, check

import dem_cli
from dem_cli.core.records.certificate_record import NO_CERTIFICATE
from dem_cli.core.statics.certificates import _failing
from dem_cli.core.statics.failure_bracket import FailureLoad

CLAIMS = ("stands", "impossible", "fails", "unique")
WEIGHT = 20_000.0  # of the block of the hand-made file [N]
CASE = """
gravity = 10.0
[materials.stone]
density = 1000.0
[joints.dry]
friction = {friction}
[analysis]
pattern = "mass"
direction = [1.0, 0.0]
"""
PUSHED = [path for path in FILES if "verification" in path.parts and read(path)["analysis"]["kind"] == "pushover"]


def by_hand(path, friction: float):
    """A block of 1 m × 2 m on a base, 1 m thick, 1000 kg/m³, g = 10: it slides at λ = μ or topples at λ = 1/2.

    With forces at both ends of the joint: N1 + N2 = W, N2 − N1 = 2 λ W, T = λ N.
    """
    bound, slides = min(friction, 0.5), friction < 0.5
    base, block = (
        [[-1.5, -0.5], [1.5, -0.5], [1.5, 0.5], [-1.5, 0.5]],
        [[-0.5, -1.0], [0.5, -1.0], [0.5, 1.0], [-0.5, 1.0]],
    )
    weights = np.array([[0.0, -30_000.0, 0.0], [0.0, -WEIGHT, 0.0]])

    def contacts(load: float) -> np.ndarray:
        ends = ((0.0, WEIGHT * (0.5 - load)), (1.0, WEIGHT * (0.5 + load)))
        return np.array([[x, 0.0, 0.0, 1.0, normal, load * normal, friction] for x, normal in ends])

    drawn = np.array([[0.5, -0.5, 0.0], [0.5, 1.0, 0.0]])
    moved = np.add(drawn, [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0] if slides else [0.1, 0.05, -0.1]])
    load = bound + 0.01
    work = WEIGHT * (load * 0.1 - (0.0 if slides else 0.05))
    arrays = {
        "standing_factors": [1.0, 0.3], "standing_places": drawn, "standing_blocks": [[0, 1], [0, 1]],
        "standing_contacts": contacts(0.3), "mechanism_bounds": [bound, bound],
        "mechanism_rates": np.array([[0.0] * 3, [1.0, friction, 0.0] if slides else [1.0, 0.5, -1.0]]) / WEIGHT,
        "mechanism_blocks": [[0, 1], [0, 1]], "mechanism_contacts": contacts(bound), "failing_factors": [1.0, load],
        "failing_places": np.array([drawn, moved]),
        "failing_energies": [[0.0] * 4, [work, friction * WEIGHT * 0.1 * slides, 0.0, 1.0]],
    }  # fmt: skip
    model = {
        "fixed": [True, False], "block_ids": ["base", "block"], "material_names": ["stone"], "block_material": [0, 0],
        "centroids": drawn[:, :2], "part_starts": [0, 4, 8], "part_blocks": [0, 1], "vertices": np.array(base + block),
        "thickness": [1.0, 1.0], "masses": [3000.0, 2000.0], "dead_loads": weights,
        "live_loads": [[0.0] * 3, [WEIGHT, 0.0, 0.0]],
    }  # fmt: skip
    with h5py.File(path, "w") as file:
        file["dem/case"] = CASE.format(friction=friction)
        for name, values in model.items():
            file[f"dem/model/{name}"] = values
        file["dem/model"].attrs["dimension"] = 2
        for name, values in arrays.items():
            file[f"dem/certificates/{name}"] = values
        file["dem/certificates"].attrs.update({
            "stands": "stands at a load multiplier of 0.3",
            "impossible": f"impossible above a load multiplier of {bound!r} in the geometry as drawn",
            "fails": f"fails at a load multiplier of {load!r}",
            "unique": "none: the answer does not claim it",
        })  # fmt: skip
    return path


def verdicts(path) -> dict[str, str]:
    return {claim: verdict for claim, (verdict, _) in check(str(path)).items()}


@pytest.mark.parametrize("friction", [0.4, 0.9], ids=["slides", "topples"])
def test_exact_certificates_are_proved(tmp_path, friction):
    found = verdicts(by_hand(tmp_path / "results.h5", friction))
    assert found == dict.fromkeys(CLAIMS[:3], PROVED) | {"unique": NONE}


def test_unique_where_nothing_slides_alone(tmp_path):
    """At toppling T = N/2 all over the corner, and μ = 0.9; at sliding every point is at the edge of its cone."""
    for friction, verdict in ((0.9, PROVED), (0.4, REFUSED)):
        path = by_hand(tmp_path / "results.h5", friction)
        with h5py.File(path, "a") as file:
            file["dem/certificates"].attrs["unique"] = (
                "no mechanism at the bound slides, and the bracket holds the bound"
            )
            file["dem/certificates"].attrs["stands"] = f"stands at a load multiplier of {min(friction, 0.5)!r}"
            high = min(friction, 0.5) * (1.0 + 1e-4)
            file["dem/certificates"].attrs["fails"] = f"fails at a load multiplier of {high!r}"
        assert verdicts(path)["unique"] == verdict


ALTERED = {  # dataset, place, what is added -> the claims that are refused
    "a force": ("certificates/standing_contacts", (1, 4), 10.0, {"stands"}),
    "a shear force": ("certificates/standing_contacts", (1, 5), 10.0, {"stands"}),
    "a contact point": ("certificates/standing_contacts", (0, 0), 0.01, {"stands"}),
    "a contact point off the faces": ("certificates/standing_contacts", (1, 0), 0.01, {"stands"}),
    "a normal": ("certificates/standing_contacts", (1, 2), 0.01, {"stands"}),
    "friction of a point": ("certificates/standing_contacts", (0, 6), 0.01, {"stands"}),
    "the load held": ("certificates/standing_factors", (1,), 0.01, {"stands"}),
    "a place": ("certificates/standing_places", (1, 1), 0.01, {"stands"}),
    "a rate": ("certificates/mechanism_rates", (1, 1), -1e-3 / WEIGHT, {"impossible"}),
    "a rate of a support": ("certificates/mechanism_rates", (0, 0), 1e-3 / WEIGHT, {"impossible"}),
    "a rotation": ("certificates/mechanism_rates", (1, 2), 0.1 / WEIGHT, {"impossible"}),
    "the work": ("certificates/failing_places", (1, 1, 0), -0.05, {"fails"}),
    "the energy of friction": ("certificates/failing_energies", (1, 1), 50.0, {"fails"}),
    "the load that fails": ("certificates/failing_factors", (1,), 0.01, {"fails"}),
    "a corner": ("model/vertices", (6, 0), 0.01, set(CLAIMS[:3])),
    "a mass": ("model/masses", (1,), 1.0, set(CLAIMS[:3])),
    "a dead load": ("model/dead_loads", (1, 1), 100.0, set(CLAIMS[:3])),
    "a live load": ("model/live_loads", (1, 0), -100.0, set(CLAIMS[:3])),
    "the moment of a load": ("model/live_loads", (1, 2), 100.0, set(CLAIMS[:3])),
}


@pytest.mark.parametrize("what", ALTERED)
def test_what_is_altered_is_refused(tmp_path, what):
    path, (name, place, by, refused) = by_hand(tmp_path / "results.h5", 0.4), ALTERED[what]
    with h5py.File(path, "a") as file:
        data = file[f"dem/{name}"]
        data[place] = data[place] + by
    assert {claim for claim, verdict in verdicts(path).items() if verdict == REFUSED} == refused


@pytest.mark.parametrize("claim", CLAIMS[:3])
def test_a_bolder_claim_is_refused(tmp_path, claim):
    path = by_hand(tmp_path / "results.h5", 0.4)
    by = 0.001 if claim == "stands" else -0.001
    with h5py.File(path, "a") as file:
        attrs = file["dem/certificates"].attrs
        words, load = attrs[claim].split(" of ")
        load, _, more = load.partition(" ")
        attrs[claim] = f"{words} of {float(load) + by!r} {more}"
    assert {one for one, verdict in verdicts(path).items() if verdict == REFUSED} == {claim}


def test_a_block_of_friction_that_the_case_does_not_have(tmp_path):
    path = by_hand(tmp_path / "results.h5", 0.4)
    with h5py.File(path, "a") as file:
        del file["dem/case"]
        file["dem/case"] = CASE.format(friction=0.35)
    assert verdicts(path)["stands"] == REFUSED


def test_a_bracket_that_ends_at_the_bound_certifies_no_failure():
    """A search that ends undecided takes the bound as its upper side, where nothing was seen to fail."""
    found, words = _failing(None, FailureLoad(low=0.5, high=0.6, impossible=True))
    assert found is None
    assert words.startswith(NO_CERTIFICATE)


@pytest.mark.parametrize("path", PUSHED, ids=case_id)
def test_claims_of_a_case_are_proved(path, tmp_path):
    dem_cli.run(path, out=tmp_path / "results").close()
    found = check(str(tmp_path / "results" / "results.h5"))
    assert not {claim: what for claim, what in found.items() if what[0] == REFUSED}
    summary = json.loads((tmp_path / "results" / "summary.json").read_text(encoding="utf-8"))
    proved = [claim for claim, (verdict, _) in found.items() if verdict == PROVED]
    assert summary["certificates"] == (", ".join(proved) or f"none: {found['stands'][1]}")


def test_blocks_are_numbered_as_in_the_case(tmp_path):
    """The solver numbers blocks from the lowest up; drawn the other way round they have the same certificates."""
    base = {
        "id": "base",
        "material": "stone",
        "fixed": True,
        "vertices": [[-1.0, -1.0], [2.0, -1.0], [2.0, 0.0], [-1.0, 0.0]],
    }
    block = {"id": "top", "material": "stone", "vertices": [[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [0.0, 2.0]]}
    tables = {
        "title": "two blocks", "materials": {"stone": {"density": 1000.0}}, "joints": {"dry": {"friction": 0.4}},
        "block": [block, base],
        "analysis": {"kind": "pushover", "pattern": "mass", "direction": [1.0, 0.0], "follow": 0.0},
    }  # fmt: skip
    dem_cli.run(tables, out=tmp_path / "results").close()
    path = tmp_path / "results" / "results.h5"
    assert {claim for claim, verdict in verdicts(path).items() if verdict == PROVED} >= {
        "stands",
        "impossible",
        "fails",
    }
    with h5py.File(path) as file:
        np.testing.assert_array_equal(file["dem/model/fixed"][:], [False, True])
        assert set(file["dem/certificates/standing_blocks"][:].ravel()) == {0, 1}
        np.testing.assert_array_equal(file["dem/certificates/mechanism_rates"][1], 0.0)
