"""What the cost of a step is measured on: points, steps and time of each kind of step."""

from __future__ import annotations

import pytest
from bench.cases import SIZES
from bench.kernels import COMPARED, FIRST_STEPS, KINDS, QUICK_BLOCKS, blocks_of, points_of, rows_of
from bench.record import BenchOptions

POINTS = 98  # of the wall of 21 blocks; as prisms it has two rows of them


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_a_job_does_the_steps_that_it_counts(kind):
    sim, job, work = kind.start(SIZES[0])
    assert points_of(sim) == (2 * POINTS if kind.in_space else POINTS)  # slots without a point do not count
    steps, before = work // points_of(sim), sim.steps
    job.once()
    assert sim.steps - before == steps
    if kind.dashpots is not None:
        assert sim.time == pytest.approx((FIRST_STEPS + steps) * sim.dt)
        assert sim.damping.in_joints == (kind.dashpots > 0.0)
        assert sim.kinetic_energy() < 1e-3 * sim.noticeable_energy  # it stands


def test_what_moves_is_measured_in_the_plane_and_in_space():
    """All kinds at the sizes that are compared; the smallest wall alone for a quick look."""
    sizes = {kind.name: [blocks_of(known) for known, of in rows_of(BenchOptions()) if of == kind] for kind in KINDS}
    assert all(set(COMPARED) <= set(found) for found in sizes.values())
    quick = list(rows_of(BenchOptions(quick=True)))
    assert [kind for _, kind in quick] == list(KINDS)
    assert {blocks_of(known) for known, _ in quick} == set(QUICK_BLOCKS)
