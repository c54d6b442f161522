"""The model of a structure: what follows from its arrays follows anew from others; names, aliases, models of a few."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from engine import block, rectangle, scene, tables

from dem_cli.core.contact.geometry import GEOMETRY, geometry_of
from dem_cli.core.model.scales import smallest_edge
from dem_cli.errors import UsageError

ELL = {"id": "ell", "parts": [rectangle(0, 0, 1, 3), rectangle(1, 0, 2.5, 1)], "fixed": True}


def model():
    return scene(tables(ELL, block("b", rectangle(1, 1, 2, 1.5)), block("c", rectangle(2, 1, 2.25, 3)))).model


def test_measures_of_blocks():
    made = model()
    order = [made.numbers[name] for name in ("ell", "b", "c")]
    assert made.shapes.volumes[order] == pytest.approx([4.5, 0.5, 0.5])
    assert made.shapes.edges[order] == pytest.approx([1.0, 0.5, 0.25])
    assert made.shapes.radii[order][1:] == pytest.approx([np.hypot(0.5, 0.25), np.hypot(0.125, 1.0)])
    widths = [min(3 / np.hypot(1, 3), 1.5 / np.hypot(1.5, 1)), 0.5 / np.hypot(1, 0.5), 0.5 / np.hypot(0.25, 2)]
    assert made.shapes.widths[order] == pytest.approx(widths)
    assert np.bincount(made.part_blocks, made.parts.volumes) == pytest.approx(made.shapes.volumes)
    assert smallest_edge(made) == 0.25  # of those that can move


def test_measures_are_worked_out_once_and_anew_for_other_corners():
    made = model()
    assert made.shapes is made.shapes
    assert made.topology is made.topology
    larger = made._replace(vertices=2.0 * made.vertices)
    assert type(larger) is type(made)
    assert np.array_equal(larger.shapes.radii, 2.0 * made.shapes.radii)
    assert np.array_equal(larger.shapes.volumes, 4.0 * made.shapes.volumes)
    again = pickle.loads(pickle.dumps(made))
    assert np.array_equal(again.shapes.widths, made.shapes.widths)


def test_aliases_follow_the_names_of_blocks():
    made = model()._replace(aliases=(("top", "c"), ("b", "c"), ("gone", "nobody")))
    assert made.numbers["top"] == made.numbers["c"]
    assert made.block_ids[made.numbers["b"]] == "b"  # a name comes before an alias
    assert "gone" not in made.numbers
    few = made.only([made.numbers["c"], made.numbers["ell"]], fixed=np.array([False, True]))
    assert few.numbers == {"c": 0, "ell": 1, "top": 0, "b": 0}


def test_a_model_of_a_few_blocks():
    made = model()
    pick = [made.numbers["ell"], made.numbers["b"]]
    few = made.only(pick, fixed=np.array([True, False]))
    assert few.block_ids == ("ell", "b")
    assert few.n_parts == 3
    for name in ("volumes", "widths", "edges", "radii"):
        assert np.array_equal(getattr(few.shapes, name), getattr(made.shapes, name)[pick])
    assert np.array_equal(few.masses, made.masses[pick])
    assert few.inner_faces.sum() == made.inner_faces.sum() == 1


def test_contact_knows_its_dimensions():
    """One table; whoever is not in it is told so."""
    assert geometry_of(2) is GEOMETRY[2]
    with pytest.raises(UsageError, match="blocks in 4 dimensions cannot touch"):
        geometry_of(4)
