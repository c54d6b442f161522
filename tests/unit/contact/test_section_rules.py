"""Points of a whole section: strength in bending over the normal force, brittle and crushed, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from oracle.fibre_section import Bond, Section, bent, rectangle, square_about_its_diagonal

from dem_cli.core.contact.area_rules import AT_CORNER, section_points
from dem_cli.core.contact.layout import SECTION, PointLayout, draw, lobatto
from dem_cli.core.contact.layout import section as in_the_plane
from dem_cli.core.laws.stiffness import SECTION as OF_LAWS

PRESSED = np.concatenate([np.linspace(-0.9, 0.0, 10), np.linspace(0.0, 1.2, 49), [1.5, 2.0, 3.0]])  # N / ft A
CRUSHED = np.concatenate([np.geomspace(0.005, 0.1, 20), np.linspace(0.1, 0.9, 81), 1 - np.geomspace(0.1, 0.005, 20)])


def points(turned: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Places along an axis turned by so much from a side of the square −1 to 1, and shares, all points in space."""
    x, y, shares = section_points()
    x, y = np.append(x, [-1.0, 1.0, 1.0, -1.0]), np.append(y, [-1.0, -1.0, 1.0, 1.0])
    return x * np.cos(turned) + y * np.sin(turned), np.append(shares, 4 * [AT_CORNER])


def brittle(places: np.ndarray, shares: np.ndarray) -> np.ndarray:
    """Largest moment over ft A of points that crack one after the other from one end, for PRESSED."""
    order = np.argsort(-places, kind="stable")
    x, w = places[order], shares[order]
    best = PRESSED * x.max()
    for k in np.flatnonzero(np.diff(x, prepend=np.inf) < -1e-9):
        area, middle = w[k:].sum(), (w[k:] * x[k:]).sum() / w[k:].sum()
        if x[k] - middle > 1e-9:
            modulus = (w[k:] * (x[k:] - middle) ** 2).sum() / (x[k] - middle)
            best = np.maximum(best, (1.0 + PRESSED / area) * modulus - PRESSED * middle)
    return best


def crushed(places: np.ndarray, shares: np.ndarray) -> np.ndarray:
    """Largest moment over fc A of points that are pressed by at most fc each, for CRUSHED."""
    order = np.argsort(-places, kind="stable")
    filled = np.append(0.0, np.cumsum(shares[order]))
    return np.interp(CRUSHED, filled, np.append(0.0, np.cumsum((shares * places)[order])))


RULES = {
    "in the plane": (2.0 * in_the_plane()[0] - 1.0, in_the_plane()[1]),
    "in space": points(),
    "in space, about the other side": points(np.pi / 2),
}


@pytest.mark.parametrize("rule", RULES.values(), ids=RULES)
def test_as_strong_as_the_whole_section_at_any_normal_force(rule):
    """Of a rectangle from −1 to 1: max((ft + N/A)/3, N/A) and ν (1 − ν); more than 1 % off is wrong."""
    assert brittle(*rule) == pytest.approx(np.maximum((1.0 + PRESSED) / 3.0, PRESSED), rel=0.0095)
    assert crushed(*rule) == pytest.approx(CRUSHED * (1.0 - CRUSHED), rel=0.0095)


def test_five_points_are_not():
    places, shares = lobatto(5)
    few = 2.0 * places - 1.0, shares
    assert (brittle(*few) / np.maximum((1.0 + PRESSED) / 3.0, PRESSED)).max() > 1.2
    assert (crushed(*few) / (CRUSHED * (1.0 - CRUSHED))).min() < 0.95


def test_about_the_diagonal():
    strips = square_about_its_diagonal(2.0, 2000)
    whole = strips.places, strips.areas / 4.0
    many = (CRUSHED > 0.05) & (CRUSHED < 0.95)
    found = points(np.pi / 4)
    assert crushed(*found)[many] == pytest.approx(crushed(*whole)[many], rel=0.04)
    assert brittle(*found) == pytest.approx(brittle(*whole), rel=0.052)


@pytest.mark.parametrize("rule", [RULES["in the plane"], RULES["in space"]], ids=["in the plane", "in space"])
@pytest.mark.parametrize(("energy", "share"), [(3.0, 0.05), (30.0, 0.0), (30.0, 0.2), (300.0, 0.4)])
def test_softening_with_a_cap(rule, energy, share):
    """A bed joint 0.4 m wide that cracks at 0.3 MPa with some J/m² and is crushed at 4 MPa, N of a share of that."""
    bond, width = Bond(3e5, 1e11, 4e6, energy), 0.4
    order = np.argsort(-rule[0], kind="stable")
    few = Section(0.5 * width * rule[0][order], width * rule[1][order])
    normal = share * 4e6 * width
    whole = bent(rectangle(width, n=400), bond, normal, steps=40)
    assert bent(few, bond, normal, steps=100).strength == pytest.approx(whole.strength, rel=0.01)


def test_the_rule_of_the_plane():
    places, shares = in_the_plane()
    assert len(places) == SECTION == OF_LAWS
    assert places[[0, -1]].tolist() == [0.0, 1.0]
    assert (shares > 0.0).all()
    for power in range(4):
        assert (shares * places**power).sum() == pytest.approx(1.0 / (power + 1), rel=1e-14)
    along, _, drawn = draw(PointLayout(points=SECTION), (0, 0), 0.4)
    assert along.tolist() == (0.4 * places).tolist()
    assert drawn is shares
