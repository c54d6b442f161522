"""Scenes of checkpoints: no number and no shape from a file leads a compiled loop out of its arrays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from engine import block, rectangle, scene, simulation, tables

from dem_cli.core.engine.dynamic import DynamicSimulation
from dem_cli.core.engine.properties import joint_properties, law_of
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.engine.viscous import Damping
from dem_cli.results.output.resume.kept_objects import decoded, encoded
from dem_cli.results.output.resume.kept_values import Damaged

FREE = {  # numbers that lead nowhere: names by which points are known again, marks, room
    "PlanarGeometry.features", "SpatialGeometry.features", "SpatialMotion.features", "SpatialMotion.labels",
    "Contacts.stale", "Bodies.turned", "Dampers.met", "Dampers.stirred", "JointTiles.ends", "JointTiles.team",
}  # fmt: skip


def box(name, side, z, height, **more):
    return block(name, [(a, b, c) for a in (-side, side) for b in (-side, side) for c in (z, z + height)], **more)


PLANE = tables(
    block("base", rectangle(-1, -1, 3, 0), fixed=True), block("a", rectangle(0, 0, 1, 1)),
    block("b", rectangle(1, 0, 2, 1)), block("c", rectangle(0.5, 1, 1.5, 2)),
    tie=[{"ends": [[0.1, 0.5], [1.9, 0.5]], "stiffness": 1e7}],
)  # fmt: skip
SPACE = tables(
    box("base", 2.0, -1.0, 1.0, fixed=True), box("low", 0.3, 0.0, 0.4), box("top", 0.3, 0.4, 0.4), dimension=3,
    analysis={"kind": "gravity"},
)  # fmt: skip


def shaken(case):
    made = scene(case)
    properties = joint_properties(made.request, made.model, 1e5)
    sim = DynamicSimulation(made.model, law_of(made.request), properties, Damping(fraction=0.35))
    sim.begin(1e-4)
    return sim


def tiled(case):
    sim = simulation(case)
    settings = replace(DEFAULT, detection=replace(DEFAULT.detection, tiled_from=1))
    return Simulation(sim.model, sim.law, sim.properties, settings=settings)


SCENES = {
    "plane": lambda: tiled(PLANE),
    "moving plane": lambda: simulation(PLANE, "large"),
    "shaken plane": lambda: shaken(PLANE),
    "space": lambda: simulation(SPACE),
    "shaken space": lambda: shaken(SPACE),
}


def places_of(sim):
    """Records of arrays of a simulation by where they are: what sets another one there."""

    def of_tracking(name):
        return lambda record: setattr(sim.tracking, name, record)

    found = [(getattr(sim.tracking, name), of_tracking(name)) for name in ("joints", "geometry", "contacts", "chains")]
    found += [(sim.bodies, lambda record: setattr(sim, "bodies", record))]
    found += [(link, lambda record: setattr(sim, "links", (record,))) for link in sim.links]
    if hasattr(sim, "dampers"):
        found.append((sim.dampers, lambda record: setattr(sim, "dampers", record)))
    joints = sim.tracking.joints
    if hasattr(joints, "tiles"):
        found.append((joints.tiles, lambda tiles: setattr(sim.tracking, "joints", joints._replace(tiles=tiles))))
    return [(record, put) for record, put in found if record is not None]


def refusals(sim, change):
    """Which fields of arrays are refused, and which are taken, where `change` makes others of them."""
    refused, taken = set(), set()
    before, tracking = dict(vars(sim)), dict(vars(sim.tracking))
    for record, put in places_of(sim):
        for field, array in record._asdict().items():
            changed = change(array) if isinstance(array, np.ndarray) else None
            if changed is None:
                continue
            put(record._replace(**{field: changed}))
            data = encoded([sim], sim.save())
            vars(sim).update(before)
            vars(sim.tracking).update(tracking)
            name = f"{type(record).__name__}.{field}"
            try:
                decoded(data, [sim])
                taken.add(name)
            except Damaged:
                refused.add(name)
            vars(sim).update(before)
            vars(sim.tracking).update(tracking)
    return refused, taken


def too_large(array):
    """Numbers that count nothing."""
    return np.full_like(array, np.iinfo(array.dtype).max - 1) if array.size and array.dtype.kind in "iu" else None


def below_zero(array):
    return np.full_like(array, np.iinfo(array.dtype).min + 1) if array.size and array.dtype.kind == "i" else None


def shorter(array):
    return array[:-1] if array.size else None


def wider(array):
    return array[..., None] if array.size else None


def as_other_numbers(array):
    return array.astype("f4" if array.dtype != "f4" else "i8") if array.size else None


@pytest.fixture(params=SCENES, scope="module")
def sim(request):
    return SCENES[request.param]()


@pytest.mark.parametrize("change", [too_large, below_zero])
def test_numbers_that_lead_out_of_an_array(sim, change):
    refused, taken = refusals(sim, change)
    assert len(refused) > 2
    assert not taken - FREE


@pytest.mark.parametrize("change", [shorter, wider, as_other_numbers])
def test_arrays_of_another_shape(sim, change):
    refused, taken = refusals(sim, change)
    assert len(refused) > 20
    assert not taken


def test_what_is_of_the_structure_comes_back(sim):
    before = sim.save()
    saved = decoded(encoded([sim], before), [sim])
    for a, b in zip(before.bodies, saved.bodies, strict=True):
        assert a.tobytes() == b.tobytes()


@pytest.mark.parametrize("name", ["bodies", "contacts", "joints", "geometry"])
def test_saved_states_are_looked_at_too(sim, name):
    saved = sim.save()
    record = getattr(saved, name)
    first = record._replace(**{record._fields[0]: getattr(record, record._fields[0])[:-1]})
    with pytest.raises(Damaged):
        decoded(encoded([sim], {"of": saved._replace(**{name: first})}), [sim])
