"""Joints in tiles and threads over them: the bits of the loop that takes one point after the other."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bench.cases import KNOWN_STRUCTURES, prisms
from bench.kernels import simulation as wall_in_space
from engine import running_wall, simulation, tables

from dem_cli.core.engine.loops import compiled_advance
from dem_cli.core.engine.simulation import Simulation
from dem_cli.core.engine.threads.crew import called_by_all, crew_of
from dem_cli.core.kernels import records as slot
from dem_cli.results.output.resume.kept_objects import decoded, encoded

WAYS = {"fire": slot.FIRE, "hold": slot.HOLD_LOAD, "creep": slot.CREEP, "guided": slot.GUIDED}


def pushed(courses: int, length: int, threads: int = 1, **more) -> Simulation:
    """A wall under most of what it carries, with a rate for those ways that prescribe one."""
    with crew_of(threads):
        sim = simulation(tables(*running_wall(courses, length), **more))
    sim.set_load(0.55)
    sim.use(0.6, 0.3, 0.3)
    sim.prescribe_rate(1e-5)
    return sim


def made_of_prisms() -> Simulation:
    """A wall of 21 blocks in space."""
    sim = wall_in_space(prisms(KNOWN_STRUCTURES["T21 μ 0.6"]), "fixed")
    sim.prescribe_rate(1e-5)
    return sim


def state(sim: Simulation) -> list[np.ndarray]:
    """All that a step changes."""
    return [array.copy() for array in (*sim.bodies[:5], *sim.contacts[:4], sim.ledger, sim.control)]


def stepped(sim: Simulation, mode: int, tiled: bool, plain: bool, n_steps: int = 40) -> list[np.ndarray]:
    """The state after some steps of one loop or the other."""
    if tiled:
        sim.tracking.tile(sim.n_in_lanes, 1)
    loop = compiled_advance(sim.kinematics, sim.law, dimension=sim.model.dimension, tiled=tiled, elastic=sim.integrates)
    (loop.py_func if plain else loop)(
        n_steps, mode, 1.0, sim.bodies, sim.shape, sim.joints, sim.geometry, sim.contacts, sim.links, sim.loads,
        sim.control, sim.ledger, sim.like, sim.like_rotation,
    )  # fmt: skip
    return state(sim)


def assert_same(one: list[np.ndarray], other: list[np.ndarray]) -> None:
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(one, other, strict=True))


STEPPED = """
import sys
from test_tiles import fired
found, used = fired(2)
assert used == 1
sys.stdout.buffer.write(found)
"""


def fired(threads: int) -> tuple[bytes, int]:
    """The state of a wall of 1,600 blocks after some steps, and how many threads had work."""
    sim = pushed(40, 40, threads)
    assert sim.tiled
    with crew_of(threads) as crew:
        sim.advance(12, slot.FIRE)
    return b"".join(array.tobytes() for array in state(sim)), crew.used


@pytest.mark.parametrize("mode", WAYS)
def test_many_at_once_are_one_after_the_other(mode):
    """To the last bit, compiled and as it is written, with points that stick, slide, open and close."""
    expected = stepped(pushed(3, 3), WAYS[mode], tiled=False, plain=False)
    assert_same(stepped(pushed(3, 3), WAYS[mode], tiled=True, plain=False), expected)
    assert_same(stepped(pushed(3, 3), WAYS[mode], tiled=True, plain=True), expected)


def test_points_slide_and_open_there():
    """What the test above is about does happen in it."""
    sim = pushed(3, 3)
    stepped(sim, slot.HOLD_LOAD, tiled=True, plain=False)
    assert 0 < (sim.contacts.slip > 0.0).sum() < len(sim.contacts.slip)
    assert 0 < (sim.contacts.normal == 0.0).sum() < len(sim.contacts.slip)


def test_the_same_in_space():
    """As it is written."""
    expected, found = (
        stepped(made_of_prisms(), slot.CREEP, tiled=tiled, plain=True, n_steps=8) for tiled in (False, True)
    )
    assert_same(found, expected)


def test_any_number_of_threads_finds_the_same_bits():
    """Of blocks of several chunks, in all ways to step; some blocks' joints belong to several threads."""
    found = {}
    for threads in (1, 2, 3):
        sim = pushed(40, 40, threads)
        assert sim.tiled
        found[threads] = []
        for mode in WAYS.values():
            sim.advance(12, mode)
            found[threads] += state(sim)
    assert_same(found[2], found[1])
    assert_same(found[3], found[1])


def test_numba_as_it_comes_finds_the_same_bits():
    """It has one thread for a structure, whatever was asked for."""
    environment = os.environ | {"DEM_PLAIN_NUMBA": "1", "NUMBA_NUM_THREADS": "2"}
    command, here = [sys.executable, "-c", STEPPED], Path(__file__).parent
    plain = subprocess.run(command, env=environment, cwd=here, capture_output=True, check=True).stdout
    found, used = fired(2)
    assert used == 2
    assert plain == found


def test_a_run_goes_on_with_other_threads():
    """It takes the number that it is resumed with, as far as these have work: three chunks of blocks but the first."""
    begun = {threads: pushed(40, 40, threads) for threads in (1, 3)}
    for sim in begun.values():
        sim.advance(12, slot.FIRE)
    ended = {}
    for before, after, used in ((1, 10**9, 3), (3, 1, 1)):
        ended[used] = pushed(40, 40, after)
        decoded(encoded([begun[before]], None), [ended[used]])
        with crew_of(after) as crew:
            ended[used].advance(12, slot.FIRE)
        assert crew.used == used
    begun[1].advance(12, slot.FIRE)
    assert len(ended[3].joints.tiles.controls) == 3
    assert_same(state(ended[3]), state(begun[1]))
    assert_same(state(ended[1]), state(begun[1]))


def test_few_points_are_no_tiles():
    """They are not worth another kernel."""
    sim = pushed(3, 3)
    assert not sim.tiled
    settings = replace(sim.settings, detection=replace(sim.settings.detection, tiled_from=1))
    assert Simulation(sim.model, sim.law, sim.properties, settings=settings).tiled


def test_an_interrupt_leaves_no_thread_waiting():
    """Who waits for the others is interrupted when one of them has been called: all are called, and then it is told."""
    calls, done = [], []

    class Arguments(tuple):
        """Interrupts the second time that a call is made."""

        def __iter__(self):
            calls.append(1)
            if len(calls) == 2:
                raise KeyboardInterrupt
            return super().__iter__()

    with pytest.raises(KeyboardInterrupt):
        called_by_all(done.append, Arguments((1,)), 3)
    assert done == [1, 1, 1]
