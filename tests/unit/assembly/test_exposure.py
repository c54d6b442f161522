"""Exposed faces of whole structures make closed surfaces: under water they are lifted by what they displace."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
import shapely

from dem_cli.app.api import make_case_model
from dem_cli.case.reader import CaseSource, validate
from dem_cli.core.geometry.rotation import moments
from dem_cli.masonry.assembly.applied_loads import applied_loads
from dem_cli.masonry.assembly.assemble import assembly
from dem_cli.masonry.assembly.exposure import Surfaces

TEMPLATES = Path(__file__).resolve().parents[3] / "dem_cli" / "app" / "cli" / "templates"
KINDS = ("arch", "bridge", "herringbone-wall", "temple-front", "vault", "voronoi-wall", "wall-section")  # 2D and 3D
LIFT = 1000.0 * 9.81


def under_water(kind: str):
    """A template with every block free, all of density 1, and the load of water 20 m deep on it."""
    tables = tomllib.loads((TEMPLATES / f"{kind}.toml").read_text(encoding="utf-8"))
    kept = {key: tables[key] for key in ("materials", "joints", "structure", "dimension", "interface") if key in tables}
    for material in kept["materials"].values():
        material["density"] = 1.0
    kept |= {"analysis": {"kind": "gravity"}, "pressure": [{"block": "*", "face": "all", "fluid": {"level": 20.0}}]}
    case = validate(kept, make_case_model(), CaseSource(Path("case.toml"), ""))
    model = assembly(case).model
    model = model._replace(fixed=np.zeros(model.n_blocks, bool))
    return model, applied_loads(case, model)[0]


@pytest.mark.parametrize("kind", KINDS)
def test_a_structure_is_lifted_by_what_it_displaces(kind):
    """Joints are where no face is missing and none is there twice: γV through the centroid, to round-off."""
    model, load = under_water(kind)
    volume = model.masses.sum()
    centroid = model.masses @ model.centroids / volume
    up = np.eye(model.dimension)[-1]
    assert load.resultant == pytest.approx(LIFT * volume * up, abs=1e-11 * LIFT * 20.0 * load.area)
    turning = moments(load.points - centroid, load.forces).sum(axis=0)
    assert turning == pytest.approx(0.0, abs=1e-11 * LIFT * 20.0 * load.area * np.ptp(model.centroids))


@pytest.mark.parametrize("kind", ["arch", "herringbone-wall", "voronoi-wall"])
def test_what_is_exposed_is_the_outline_of_the_whole(kind):
    """Of blocks in the plane: the length of the boundary of their union, shapely's, with gaps of 1e-9 m closed."""
    model, _ = under_water(kind)
    surfaces = Surfaces(model)
    corners = np.split(surfaces.corners, model.part_starts[1:-1])
    closed = shapely.union_all([shapely.Polygon(own).buffer(1e-9, join_style="mitre") for own in corners])
    pieces = surfaces.exposed(np.arange(model.n_blocks), np.ones(surfaces.topology.n_faces, bool))
    found = sum(float(np.hypot(*(piece.corners[1] - piece.corners[0]))) for piece in pieces)
    assert found == pytest.approx(closed.length, rel=1e-6)
