"""Settings of dynamic analyses: frequencies, modes, time histories, restitution, statistics of many runs."""

from __future__ import annotations

from dem_cli.frozen_records import dataclass


@dataclass(frozen=True)
class FrequencySettings:
    """Settings of natural frequencies: dense or sparse eigenvalues, and how exact."""

    dense: int = 30  # degrees of freedom up to which a full matrix is used; beyond, threads of BLAS may cost more
    dense_share: float = 0.5  # of all modes: from there on as well
    accurate: float = 1e-6  # residual over the highest eigenvalue, whose error is of its square
    zero: float = 1e-12  # of the highest eigenvalue: no vibration below it
    shift: float = 1e-10  # of the highest eigenvalue: where the lowest ones are looked for
    equal: float = 1e-6  # shares of energy no further apart are the same: the first block or joint is named


@dataclass(frozen=True)
class ModesSettings:
    """Settings of modes under gravity: which contact points are springs, pictures, calibration from a measured
    frequency."""

    pressed: float = 1e-4  # of the mean weight of a block: a point with less than that may be round-off
    closes: float = 1e-6  # of the smallest edge: a gap below that is closed, but for what gravity opened
    pull: float = 1e-6  # of the elastic displacement of a weight on a point, to see whether it carries tension
    visible: float = 0.06  # of the size of the structure: how far the picture of a mode moves
    largest_turn: float = 0.2  # rad
    agrees: float = 1e-4  # of a frequency: how near a calibrated structure comes to the measured one
    rounds: int = 8  # of the calibration, at most
    sinks: float = 0.05  # overlap of an attempt, in smallest edges
    most_steps: int = 200_000  # for an attempt to stand


@dataclass(frozen=True)
class HistorySettings:
    """Settings of time histories: looks along the way, time step, and when one of many runs has ended."""

    longest_look: float = 0.1  # s from one look to the next, at most
    rows: int = 200  # looks along the way: energies, collapse, whether all is well
    settling: int = 4_000_000  # steps to come to rest, at most
    trifle: float = 1e-9  # of a weight × step: an impulse of landing that asks for no more sweeps of what is near
    blow_up: float = 0.2  # energy error over the largest energy from which a run is stopped
    inside: float = 1e-3  # of the smallest edge: blocks moved deeper into others than joints give when they close
    look: float = 0.1  # s of motion between two looks of one of many runs: collapse times are known to this
    energy_every: int = 10  # looks from one check of the energy balance to the next
    loose_step: float = 1e-4  # s: the time step where no joint limits it, at most
    loose_share: float = 1e-3  # of the duration: the same
    drift: float = (
        0.01  # of the largest displacement: error of elastic vibrations above which the step is shortened ...
    )
    shortest: float = 0.1  # ... to no less than this share
    sampled: float = 2e-4  # s between samples that peaks of openings, slips and accelerations on "auto" joints are of
    modes: int = 12  # the slowest, which are looked at for it where there are many
    noticeable: float = 1e-3  # of the smallest edge: energy that lifts the whole structure by it, ways that are none
    carries: float = 1e-3  # of its weight: what pushes a block up with less does not carry it
    sinks: float = 0.03  # of its least width, that a block sinks below what carried it to have lost that support ...
    touches: float = 0.01  # ... where it is farther from these faces than so much of the smallest edge, or beside them
    still: float = 0.01  # unbalanced force, in weights of a block, below which it has come to rest ...
    quiet: float = 1e-3  # ... with so much of the noticeable energy at most
    steady: float = 0.01  # of the smallest edge: what blocks may go beyond earlier places and have turned back
    grows: float = 0.05  # of the way between these, that they may have gone beyond in passing
    least_coda: float = 0.4  # of `least_limit`, before which none that moves is taken for one that has turned back
    least_limit: float = 5.0  # s that a structure is followed after its motion at most, or longer where it is tall:
    limit: float = 20.0  # so many √(half its height / g); a block near its balance falls or turns back within ten
    one_more: float = 1.0  # s that what hardly moves must go on hardly moving to be at rest
    doubles: float = 2.0  # of the way of the first half of a time, that the second half adds where a motion grows ...
    keeps: float = 0.8  # ... or this share of it, where a block goes on in one direction ...
    one_way: float = 0.95  # ... and this share of all its ways leads there ...
    creeps: float = 1e-6  # ... and so much of the smallest edge: below it nothing has moved
    edge: float = 1e-6  # of the smallest edge: points no farther from one place, or one line in space, are an edge


@dataclass(frozen=True)
class SnapshotSettings:
    """Settings of the snapshots of a time history: how many show its motion, where the request does not say it."""

    per_second: float = 12.5  # [1/s], at least: what a movie of it needs
    per_second_still: float = 2.5  # [1/s], until a block has moved visibly: a frame takes as long as a thousand steps
    per_cycle: float = 8.0  # of the ground, by the mean frequency of its velocity
    per_second_of_collapse: float = 25.0  # [1/s]
    most_per_second: float = 100.0  # [1/s]
    swing: float = 0.25  # of the largest displacement so far: who moves by it asks for one (16 in a cycle of that size)
    turn: float = 0.5  # rad: who turned by it since the last one asks for one
    visible: float = 2e-3  # of the size of the structure: a displacement that counts as such, at least
    look: float = 2.5e-3  # s between two looks, at least
    spaced: int = 16  # times as far apart are they where no block nears its farthest or a swing, ...
    between: float = 0.5  # ... and at most so much of the time between two snapshots
    trifle: float = 1e-4  # of the largest displacement so far: going farther by less is no reason to look closely
    bytes: int = 100_000_000  # on disk, about: more of them are not kept ...
    fewest: int = 100  # ... but so many in any case


@dataclass(frozen=True)
class RockingSettings:
    """Settings of "auto" joint stiffness in time histories (dynamics/rocking_stiffness.py), and of its check.

    Angles are those by which blocks turn on their joints when their weight acts sideways: well-conditioned peaks are
    off by about 0.2 % at 1e-6, 0.5 % at 1e-5, 2 % at 1e-4 (docs/rocking.md, Default settings).
    """

    turn: float = 1e-6  # rad
    doubtful: float = 1e-4  # rad: from here on a run says so
    round_off: float = 2e-6  # of its weight, that round-off of places may do to the force on a block
    work: float = 2e6  # steps × contact points per √(height/g) of motion, that stiffness may lead to: 0.15 s of CPU
    points_per_step: float = 8.0  # contact points that a step costs beside its own
    pressed: float = 0.01  # of the mean weight of a block: joints that carry less hold nobody upright
    mechanism: float = 1e3  # rad: blocks that turn further are not held by their joints
    softer: float = 10.0  # joints of the second run that shows how much stiffness matters
    moved: float = 0.02  # of a peak, that it may move by
    spread: float = 0.2  # of the median peak of repeats, between 16 and 84 %: from here on motion hangs on chance


@dataclass(frozen=True)
class RestitutionSettings:
    """Settings of the dashpot that gives a wanted ratio of angular velocities, found by rocking a block."""

    housner_fraction: float = 2.0  # of critical: within 3e-4 of Housner's ratio for h/b from 2 to 5 (docs/rocking.md)
    most: float = 4.0  # fractions of critical between which a ratio is sought
    least: float = 0.1  # with less, landings are many bounces
    tilt: float = 0.3  # of the angle at which the block would fall
    landed: float = 0.05  # of the first tilt: beyond it on the other side the block has landed and chatters no more
    longest: float = 20.0  # √(radius/g): the block lands before
    look: float = 2e-3  # share of that time between two looks
    accurate: float = 1e-3  # of the fraction that is found
    most_steps: int = 200_000  # for the block to come to rest


@dataclass(frozen=True)
class StatisticsSettings:
    """Settings of many runs: draws of slightly different structures, and the distribution of their loads."""

    largest_draw: float = 3.0  # standard deviations that a draw is limited to
    grid: int = 100  # medians and dispersions, each, that the confidence of a fit is found from
    fewest_known: int = 2  # records that both stood and fell, without which there is no confidence
    points: int = 101  # of the curve in summary.json
    narrowest: float = 1e-4  # least dispersion: all bounds overlap
    few: int = 2  # intervals between levels that any narrow distribution fits
    ask: float = 0.2  # s between two looks at an interrupt and at the progress
