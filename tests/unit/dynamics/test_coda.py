"""How a shaken structure ends: what falls, rests or rocks on after its motion, against exact blocks and long runs."""

from __future__ import annotations

import engine
import numpy as np
import pytest
from engine import block, rectangle, tables
from oracle.base_motion import Sine
from oracle.housner import Block, rock

from dem_cli.app.cli.words.fragility import fragility_rows
from dem_cli.core.dynamics.coda import Swings, undecided
from dem_cli.core.engine.settings import DEFAULT
from dem_cli.core.records.statuses import MOVES, ROCKS, STOOD
from dem_cli.errors import SolverError
from dem_cli.results.output.ending import ending_words, last_words

WIDTH, HEIGHT, FREQUENCY = 1.0, 6.0, 0.8
GROUND = block("ground", rectangle(-30.0, -1.0, 30.0, 0.0), fixed=True)
ALPHA = np.arctan(WIDTH / HEIGHT)


def shaken(amplitude: float, width: float = WIDTH, **analysis) -> dict:
    """A block of 6 m under one sine, which ends with it unless told otherwise."""
    return tables(
        GROUND, block("b", rectangle(-0.5 * width, 0.0, 0.5 * width, HEIGHT)),
        joints={"dry": {"friction": 5.0, "kn": 1e9}}, damping={"restitution": "housner"},
        motion={"kind": "pulse", "shape": "sine", "amplitude": amplitude, "frequency": FREQUENCY},
        analysis={"kind": "time-history"} | analysis, monitor=[{"block": "b", "quantity": "rotation"}],
    )  # fmt: skip


@pytest.mark.parametrize("amplitude", [2.0, 2.6, 3.0, 4.0, 6.0, 8.0, 10.0, 14.0])
def test_a_block_that_the_motion_leaves_falling_has_collapsed(amplitude):
    """The motion ends after 1.25 s, and Housner's block falls, or does not, long after."""
    exact = rock(Block(WIDTH, HEIGHT), Sine(amplitude, FREQUENCY, 0.0, 1.0 / FREQUENCY), 30.0)
    found, records = engine.solve(shaken(amplitude))
    assert found["collapsed"] is bool(np.isfinite(exact.overturned))
    assert records.history.times[-1] < 1.26
    if found["collapsed"]:
        assert found["ending"] == "collapsed"
        assert found["collapse_time"] > 1.25
        assert found["collapse_time"] == pytest.approx(1.25 + found["followed"], abs=1e-3)  # whole steps
    else:
        assert found["ending"] == ROCKS
        assert not found["at_rest"]


def test_a_longer_motion_sees_the_same_collapse():
    """Looked at every 0.04 s there, every 0.025 s in the coda."""
    short, long = (engine.solve(shaken(8.0, **more))[0] for more in ({}, {"duration": 4.0}))
    assert long["followed"] == 0.0
    assert short["collapse_time"] == pytest.approx(long["collapse_time"], abs=0.04)


def test_the_coda_changes_nothing_that_the_motion_left():
    """Peaks, histories and energies are those of the stated duration, to the bit."""
    (with_it, one), (without, other) = (engine.solve(shaken(6.0, **more)) for more in ({}, {"coda": 0.0}))
    assert (one.history.monitors == other.history.monitors).all()
    assert (one.history.times == other.history.times).all()
    for key in ("duration", "steps", "largest_displacement", "energy_closure", "energy_shares"):
        assert with_it[key] == without[key]
    assert with_it["collapsed"] is True
    assert without["collapsed"] is None  # past its tipping angle, and nobody looked farther
    assert without["ending"] == MOVES
    assert np.abs(one.history.monitors[-1, 0]) > ALPHA


def test_what_trembles_on_its_joint_stands():
    """Undamped, for ever: 0.5 mm to and fro. Not all 5 s are needed."""
    joints = {"dry": {"friction": 5.0, "kn": 1e8}}
    start = {"initial": [{"block": "b", "velocity": [0.0, -0.01, 0.0]}], "damping": {"none": True}, "joints": joints}
    found = engine.solve(shaken(0.01, duration=2.0) | start)[0]
    assert found["ending"] == STOOD
    assert found["at_rest"]
    assert found["followed"] == pytest.approx(2.0, abs=0.1)


def test_the_coda_ends_with_the_rest():
    """A block that lands and is at rest soon after: followed until then, or not at all where the motion is longer."""
    case = shaken(9.5, width=5.0, duration=1.3) | {"damping": {"contact_fraction": 0.35}}
    found = engine.solve(case)[0]
    assert (found["ending"], found["at_rest"]) == (STOOD, False)
    assert 0.1 < found["followed"] < 1.9
    case["analysis"]["duration"] = 1.4 + found["followed"]
    later = engine.solve(case)[0]
    assert (later["ending"], later["at_rest"], later["followed"]) == (STOOD, True, 0.0)


def test_repeats_and_fragility_end_as_the_run_beside_them():
    """All fall after the motion; a fragility counts its levels alike."""
    found = engine.solve(shaken(8.0, repeats=3))[0]
    assert found["repeats"]["share_collapsed"] == 1.0
    assert found["repeats"]["still_moving"] == 0
    cut = engine.solve(shaken(6.0, repeats=2, coda=0.0))[0]
    assert (cut["repeats"]["collapsed"], cut["repeats"]["still_moving"]) == (0, 2)
    assert cut["repeats"]["share_collapsed"] is None
    assert cut["repeats"]["peaks"] == [None]
    assert "2 of 2 runs still moved 0 s after the motion and are left out, neither standing" in " ".join(
        cut["warnings"]
    )
    fragile = shaken(8.0) | {"analysis": {"kind": "fragility", "intensities": [2.0, 8.0]}}
    assert engine.solve(fragile)[0]["share"] == [0.0, 1.0]
    fragile["analysis"] |= {"coda": 0.0}
    with pytest.raises(SolverError, match=r"still moving 0 s after the motion; a longer analysis\.coda may tell"):
        engine.solve(fragile)
    fragile["analysis"] |= {"intensities": [0.01, 8.0]}  # the weaker one moves nothing
    cut = engine.solve(fragile)[0]
    assert (cut["share"], cut["stood_up_to"], cut["collapse_intensities"]) == ([0.0, None], [0.01], [None])
    assert cut["still_moving"] == 1
    assert any("1 of 2 runs still moved 0 s after the motion" in text for text in cut["warnings"])
    assert "nothing collapsed as far as is known" in str(fragility_rows(cut | {"kind": "fragility"}))


class Places:
    """A simulation that is nothing but places, and a smallest edge of 1 m."""

    settings, smallest, free = DEFAULT, 1.0, np.array([0])

    def __init__(self, places):
        self._places, self.now = np.asarray(places), 0

    def places(self):
        return self._places[self.now : self.now + 1, None]


def turned_back(places) -> bool:
    sim = Places(places)
    swings = Swings(sim)
    for sim.now in range(1, len(places)):
        swings.look()
    return swings.turned_back()


def test_what_has_turned_back_and_what_has_not():
    time = np.linspace(0.0, 1.0, 41)
    assert turned_back(np.cos(8.3 * np.pi * time))
    assert turned_back(np.exp(-time) * np.cos(8.3 * np.pi * time))
    assert turned_back(np.zeros(41))
    assert not turned_back(time)  # away
    assert not turned_back(-(time**4))  # falling
    assert not turned_back(np.cos(np.pi * time))  # on its way to the other side
    assert not turned_back(1.0 - np.exp(-4.0 * time))  # creeping up to where it tips
    assert not turned_back(np.exp(0.5 * time) * np.cos(8.3 * np.pi * time))  # more and more


def test_words():
    assert ending_words({"collapsed": True, "collapse_time": 2.481, "ending": "collapsed", "followed": 1.231}) == (
        "collapsed at 2.481 s, 1.23 s after the motion")  # fmt: skip
    assert ending_words({"collapsed": True, "collapse_time": 2.481}) == "collapsed at 2.481 s"
    assert ending_words({"collapsed": False, "ending": ROCKS}) == "stood, still rocking"
    assert ending_words({"collapsed": None, "ending": MOVES}) == (
        "still moving at the end: whether it falls is not known, and a larger peak may follow")  # fmt: skip
    assert ending_words({"collapsed": False}) == "stood"  # of earlier versions
    said = {"collapsed": False, "ending": STOOD, "contradictions": ["on softer joints it collapses"]}
    assert ending_words(said) == "stood; on softer joints it collapses"
    assert ending_words({"collapsed": None}) == ending_words({}) == ""
    assert last_words({"at_rest": False}) == "at the end, still moving"
    assert last_words({}) == "in the end"
    assert undecided(0, 5, 5.0) == []


@pytest.mark.parametrize(("amplitude", "said"), [(0.5, True), (4.0, False)])
@pytest.mark.parametrize("kn", [1e12, "auto"])
def test_a_motion_that_moves_nothing_says_so(amplitude, said, kn):
    """Below g b / h the block stays on its foot; nothing hangs on chance then, nor on stiffness."""
    case = shaken(amplitude)
    case["joints"]["dry"]["kn"] = kn
    warnings = engine.solve(case)[0]["warnings"]
    assert any("nothing rocked or slid" in text for text in warnings) is said
    assert not any("hangs on chance" in text for text in warnings if said)
