"""Every verification case in 2D as prisms in 3D: the same masses, places, loads, names, joints and warnings."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from synthetic.spatial_case import extruded_tables

from dem_cli.app.api import build_model, make_case_model
from dem_cli.case.reader import CaseSource, LoadedCase, validate

CASES = Path(__file__).resolve().parents[3] / "cases" / "verification"
NOT_IN_SPACE = ("profile =", "points =", 'quantity = "slip"')


def cases() -> list[Path]:
    """Those of which 3D knows every key; structures that are turned in their plane are none."""
    found = []
    for path in sorted(CASES.glob("*.toml")):
        text = path.read_text(encoding="utf-8")
        turned = any("rotation_deg" in table for table in tomllib.loads(text).get("structure", []))
        if not turned and not any(words in text for words in NOT_IN_SPACE):
            found.append(path)
    return found


def built(tables: dict, path: Path):
    source = CaseSource(path, "")
    loaded = LoadedCase(validate(tables, make_case_model(), source), source)
    return build_model(loaded), loaded


def test_there_are_enough_of_them():
    assert len(cases()) > 100


@pytest.mark.parametrize("path", cases(), ids=lambda path: path.stem)
def test_a_case_in_space_is_the_plane_one_extruded(path):
    tables = tomllib.loads(path.read_text(encoding="utf-8"))
    flat, plane = built(tables, path)
    solid, space = built(extruded_tables(tables), path)
    size, weight = float(np.ptp(flat.centroids, axis=0).max()), float(np.abs(flat.dead_loads).sum())
    assert (solid.block_ids, solid.aliases) == (flat.block_ids, flat.aliases)
    assert (solid.fixed == flat.fixed).all()
    free = ~flat.fixed  # the margin of a base goes all around in space
    assert solid.masses[free] == pytest.approx(flat.masses[free], rel=1e-12)
    assert solid.centroids[:, [0, 2]] == pytest.approx(flat.centroids, abs=1e-12 * size)
    assert solid.centroids[:, 1] == pytest.approx(0.0, abs=1e-12 * size)
    for name in ("dead_loads", "live_loads"):
        forces, found = getattr(flat, name)[free], getattr(solid, name)[free]
        assert found[:, [0, 2]] == pytest.approx(forces[:, :2], abs=1e-13 * weight)
        assert found[:, 4] == pytest.approx(-forces[:, 2], abs=1e-12 * weight * size)  # x to z is about −y
        assert found[:, [1, 3, 5]] == pytest.approx(0.0, abs=1e-12 * weight * size)
    assert len(space.warnings) == len(plane.warnings)
