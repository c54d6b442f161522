"""Energy that goes or comes as areas of contact points change: in the books, in the summary and in words."""

from __future__ import annotations

import numpy as np
import pytest
from engine import block, rectangle, scene, simulation, tables

from dem_cli.core.engine import audit, measures
from dem_cli.masonry.assembly.solver_request import solver_request

GROUND = block("ground", rectangle(-3, -1, 6, 0), fixed=True)
CRATE = block("crate", rectangle(0, 0, 1, 1))
CASE = tables(GROUND, CRATE)


@pytest.fixture
def sim():
    return simulation(CASE, kinematics="large")


def test_it_is_an_entry_of_the_books(sim):
    """What went is missing elsewhere: the books close where it is counted."""
    before = measures.closure(sim)
    sim.ledger[:] = 0.0
    sim.most_kinetic = 10.0
    sim.contacts.exchanged[:] = (0.25, 0.75)
    assert measures.energy(sim).reweighting == 0.25
    assert measures.closure(sim) - before == pytest.approx(0.025, abs=1e-15)
    assert measures.reweighting_shares(sim) == (0.025, 0.075)


def test_a_detection_keeps_it(sim):
    sim.contacts.exchanged[:] = (-0.25, 0.75)
    sim.detect()
    np.testing.assert_array_equal(sim.contacts.exchanged, (-0.25, 0.75))
    sim.open_books(0.0)
    assert not sim.contacts.exchanged.any()


@pytest.mark.parametrize(
    ("amounts", "said"),
    [
        ((-0.02, 0.03), "made 2.0% of the largest kinetic energy as they changed, all amounts together 3.0%"),
        ((0.002, 0.011), "took 0.2% of the largest kinetic energy as they changed, all amounts together 1.1%"),
        ((0.0, 0.01), None),
    ],
)
def test_from_where_on_a_run_says_so(sim, amounts, said):
    sim.most_kinetic = 10.0
    sim.contacts.exchanged[:] = 10.0 * np.array(amounts)
    found = [
        text
        for text in audit.warnings(solver_request(scene(CASE).case), [sim], {})
        if "areas of contact points" in text
    ]
    assert [said in text for text in found] == ([] if said is None else [True])


def test_points_that_nothing_holds_are_no_contact_points(sim):
    """Joints that move in space have room for more points than they have: these have no stiffness."""
    whole = measures.contact_record(sim)
    sim.joints.kn[0] = sim.joints.ks[0] = 0.0
    found = measures.contact_record(sim)
    for field, kept in zip(found, whole, strict=True):
        np.testing.assert_array_equal(field, kept[1:])
