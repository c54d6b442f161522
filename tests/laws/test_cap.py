"""The cap in compression of bonded joints: crushing beside tension, cohesion and fracture energies, in one law."""

from __future__ import annotations

import numpy as np
import pytest
from lawpaths import joint, ramp
from pydantic import ValidationError

from dem_cli.core.laws.displacement_path import drive

KN, KS, AREA = 1.0e10, 4.0e9, 0.02
FT, C, MU, FC, ENERGY = 0.2e6, 0.35e6, 0.75, 4.0e6, 18.0
BRITTLE = {"friction": MU, "tension": FT, "cohesion": C}
SOFT = BRITTLE | {"fracture_energy_tension": ENERGY, "fracture_energy_shear": 125.0}
LAWS = {"mohr-coulomb": BRITTLE, "fracture": SOFT}
CAP, YIELD, TOP = FC * AREA, FC / KN, FT / KN  # N, m, m


def along(path, law, keys=None, **options):
    made = joint(law, **LAWS[law], **{"compression": FC} | (keys or {}))
    return drive(made.law, made.table, path, **{"kn": KN, "ks": KS, "area": AREA} | options)


@pytest.mark.parametrize("law", LAWS)
def test_below_the_cap_it_is_the_law_without(law):
    path = YIELD * ramp((-0.9, 3.0), (-0.2, -4.0), (1.5, 0.0), (-0.9, 0.0), n=100)
    plain, capped = along(path, law, {"compression": None}), along(path, law)
    for name in ("normal", "shear", "lost", "elastic"):
        assert getattr(capped, name).tolist() == getattr(plain, name).tolist()


@pytest.mark.parametrize("law", LAWS)
def test_crushes_unloads_and_opens_without_a_bond(law):
    """N = kn (closing − z) up to fc A; where it has been crushed it opens at gap = −z and holds no tension."""
    deep, n = 3 * YIELD, 600
    done = along(ramp((-deep, 0.0), (2 * TOP, 0.0), (-deep, 0.0), n=n), law)
    closing = -done.path[:, 0]
    np.testing.assert_allclose(done.normal[:n], np.minimum(KN * AREA * closing[:n], CAP), rtol=1e-12)
    later = np.clip(KN * AREA * (closing[n:] - 2 * YIELD), 0.0, CAP)
    np.testing.assert_allclose(done.normal[n:], later, rtol=1e-9, atol=1e-9 * CAP)
    assert done.lost[-1] == pytest.approx(2 * CAP * YIELD, rel=2 * 4 / n)
    assert done.external[-1] == pytest.approx(done.elastic[-1] + done.lost[-1], rel=4 / n)


@pytest.mark.parametrize("law", LAWS)
def test_shear_under_the_cap_is_cohesion_and_friction(law):
    slide = 1.5 * (C * AREA + MU * CAP) / (KS * AREA)
    done = along(ramp((-2 * YIELD, 0.0), (-2 * YIELD, slide), n=400), law)
    assert np.abs(done.shear).max() == pytest.approx(C * AREA + MU * CAP, rel=4e-3)
    assert done.external[-1] == pytest.approx(done.elastic[-1] + done.lost[-1], rel=1e-9)


def test_tension_softens_to_its_energy_beside_the_cap():
    far, n = 12 * ENERGY / FT, 4000
    done = along(np.concatenate([[(TOP, 0.0)], ramp((far, 0.0), n=n, start=(TOP, 0.0))]), "fracture")
    assert done.lost[-1] == pytest.approx(ENERGY * AREA * (1.0 - done.memory[-1, 0]), rel=1e-4)


@pytest.mark.parametrize("law", LAWS)
def test_envelopes_and_points_that_come_to_be_in_crushed_stone(law):
    made = joint(law, **LAWS[law], compression=FC)
    rows = np.tile(made.law.columns(made.table, KN), (3, 1))
    kn = np.full(3, KN * AREA)
    for find in (made.law.envelope, made.law.residual):
        assert find(rows, kn).compression == pytest.approx(np.full(3, CAP))
    assert made.law.envelope(rows, kn).tension == pytest.approx(np.full(3, FT * AREA))
    memory = np.zeros((3, made.law.n_memory(2)))
    memory[:, 0], memory[:, made.law.scalars - 1] = 1.0, [0.0, YIELD, YIELD]
    found = made.law.pressed(rows, np.array([9.0, 1.5, 0.9]) * YIELD, memory, kn)
    assert found == pytest.approx(np.array([1.0, 0.5, 0.0]) * CAP, abs=1e-9 * CAP)


@pytest.mark.parametrize(
    ("law", "keys", "key"),
    [
        ("mohr-coulomb", {"compression": FT}, "compression"),
        ("fracture", {"compression": 0.5 * FT}, "compression"),
        ("mohr-coulomb", {"compression": -1.0}, "compression"),
        ("mohr-coulomb", {"compression": FC, "dilation_deg": 5.0}, "dilation_deg"),
    ],
)
def test_what_is_not_a_joint(law, keys, key):
    with pytest.raises(ValidationError) as caught:
        joint(law, **LAWS[law], **keys)
    error = caught.value.errors()[0]
    assert key in (*error["loc"], *getattr(error.get("ctx", {}).get("error"), "keys", ()))
