"""Settings of the solvers: tolerances, damping, search of failure, proofs, post-peak path, time histories.

A case file offers none of them; benchmarks and studies hand in others. Each was chosen once, for all structures
(docs/numerics.md), and a summary names those that differ from the default.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any

from dem_cli.limit.settings import LimitSettings
from dem_cli.model.scales import DOUBTFUL_CLOSURE, DOUBTFUL_OVERLAP


@dataclass(frozen=True)
class AutomaticStiffness:
    """kn·h/W of "auto" joints: normal stiffness [Pa/m] times smallest edge over mean weight per joint area."""

    statics: float = 1e6  # where the stiffness drops out
    dynamics: float = 1e5  # in time histories: the deeper joints give, the longer the step
    settlement_overlap: float = 1e-3  # overlap that the dead loads may cause where supports move, in smallest edges


@dataclass(frozen=True)
class DetectionSettings:
    """Contact detection, and how long a compiled call may be."""

    skin: float = 0.05  # reach, as a share of the smallest edge
    wide_skin: float = 0.15  # of blocks that rock and move far: fewer detections are worth more joints to look at
    same_place: float = 0.01  # of the reach: blocks that moved less have the same faces as before
    meant_gap: float = 1e-3  # of the smallest edge: narrower gaps of the start may close, and geometry has to move
    longest_call: int = 20_000_000  # points × steps of one compiled call, about 0.2 s: Ctrl-C waits no longer


@dataclass(frozen=True)
class ClearanceSettings:
    """How far blocks may move until gaps of the start have closed: motion that is neither elastic nor failure."""

    margin: float = 1.25  # for the slip that goes with a microrotation, and finite rotations
    widest: float = 0.25  # of the smallest edge: gaps beyond are meant to stay
    amplified: float = 20.0  # motion of blocks over the gap that it closes
    farthest: float = 0.5  # of the width of a block: motion beyond is failure, whatever gaps it closes
    steepest: float = 0.3  # rad: the same of a rotation
    bare: float = 1e-3  # of an edge: faces that overlap by less meet corner to corner


@dataclass(frozen=True)
class RelaxationSettings:
    """Equilibrium at a constant load: tolerances, damping, fictitious masses, ramps of loads.

    Mass scaling (`*_safety`) for FIRE, for local damping (numerics, section 3) and for combined damping, which makes a
    reversal of force 1 + 2 combined_damping times as strong and is stable below 1/√(1 + 2 combined_damping) = 0.79.
    """

    tolerance: float = 1e-5  # unbalanced force on any block of a claimed equilibrium, in its own weight
    gravity_tolerance: float = 1e-5  # the same under dead loads alone
    chunk: int = 100  # steps between two looks
    local_damping: float = 0.4  # near failure
    combined_damping: float = 0.3  # as much against the velocity as against the change of force
    fire_mix: float = 0.1  # share of velocity that FIRE turns into the direction of force, at first
    fire_safety: float = 0.6
    creep_safety: float = 0.85
    combined_safety: float = 0.75
    narrowest_arm: float = 1e-3  # of its radius: the least width that a block's moments are compared with
    free_fall: float = 1e-4  # acceleration of a structure without any contact, in radii of its blocks per step²
    gentle: float = 0.01  # of what a block falls by itself: how fast a new load may move what it rests on
    fall_speed: float = 2e-3  # of the narrowest block: what a block that falls may move in a step, where geometry moves
    shortest_ramp: int = 500  # steps: a shorter ramp of a load is none
    longest_ramp: int = 20_000  # steps
    stair: int = 20  # steps between the loads of a ramp
    # The same where joints remember: a load put on at once swings to nearly twice its size, and cracks or crushes what
    # it would not by itself.
    ramp_of_memory: int = 100  # steps per course
    stair_of_memory: int = 5


@dataclass(frozen=True)
class ProofSettings:
    """Proof of failure by power, and motion that no elastic structure makes.

    Displacement at constant load grows fourfold when time doubles while it accelerates, twofold at constant speed.
    """

    accelerated: float = 2.5  # growth while time doubles that counts as acceleration
    steady: float = 1.55  # growth while time doubles that counts as steady motion
    far: float = 30.0  # in elastic displacements; walls of few courses still find equilibrium after 20
    far_per_depth: float = 0.125  # times the square of the courses: walls of 22 find it after 40, of 70 after 300
    steadily: float = 3.3  # times as far, where the motion does not accelerate
    gross: float = 0.1  # of the width of a block: no elastic motion
    turned: float = 0.05  # rad: no elastic rotation
    not_elastic: float = 10.0  # elastic displacements that gross motion is beyond, where joints are soft


@dataclass(frozen=True)
class LoadSearchSettings:
    """The search of the failure load: probes, creep to an estimate, loads raised, failures tried again."""

    reach: float = 15.0  # displacement of the creep, in elastic displacements at multiplier 1
    first_phase: int = 1000  # steps of the first phase of the creep
    phases: int = 5  # how often the rate is halved after it
    looks: int = 20  # how often the load is looked at in the first phase
    hold_steps: int = 3000  # of the creep at rate zero
    softened: float = 0.95  # of the highest load: a creep past its peak
    probe: float = 0.02  # internal multiplier of the first load
    probe_in_play: float = 2e-4  # the same where microrotations may begin early
    first_in_play: float = 2e-3  # the first step there
    doublings: int = 4  # of that load
    locked: float = 100.0  # internal multiplier at which a structure counts as self-locking
    shares: tuple[float, ...] = (0.5, 0.8, 0.9, 0.95, 0.98)  # of the estimate: first loads
    least: float = 1e-3  # internal multiplier that the resolution is relative to, at least
    jump: float = 5.0  # resolutions; a failure after a larger step is tried again from close by
    growth: float = 1.5  # of the step from load to load after the first loads
    below: float = 0.2  # of the resolution: where a start is held; the rest is above it, where failure shows the sooner
    one_step: float = 0.99  # of the resolution: the next load, so that one failure closes the bracket
    beyond_impossible: float = 1e-4  # of a load proved impossible, that failure is shown at
    coarse: float = 0.01  # bracket, over its load, narrow enough between a held load and one proved impossible
    shown: float = 5.0  # elastic displacements that show a mechanism moving where limit analysis proves failure
    soft: float = 0.5  # displacement at failure in smallest edges, over the resolution: geometry must move beyond


@dataclass(frozen=True)
class WarmStartSettings:
    """A start next to failure from a static solver: for which sizes, and when its path has come to failure."""

    small: int = 100  # blocks, up to which raising the load from gravity is as fast
    large: int = 1000  # blocks, beyond which the path takes too many factorisations
    flat: float = 0.5  # of the resolution: growth of the load along the path that counts as none
    drop: float = 0.98  # of the highest load: a path that ends below it does not say that the highest was a failure
    at_the_end: int = 4  # last increments, among which the highest load is a plateau and not a peak


@dataclass(frozen=True)
class PostPeakSettings:
    """The collapse at a prescribed rate, or under the load of failure."""

    elastic: float = 7e-4  # elastic displacement at failure that "auto" joints may show, in smallest edges
    steps: int = 200  # in which the rate passes the elastic displacement of a multiplier of one, at least
    fewest: int = 40_000  # steps of the whole way, about: fewer would throw the blocks about
    most: int = 60_000
    growth: float = 1.1  # of the rate from one look to the next, so that nothing is thrown at the start
    rows: int = 250  # of the history
    softest: float = 1e3  # kn·h/W
    stiffest: float = 1e7
    fall_speed: float = 1e-3  # of blocks that fall, in smallest edges per step: they land softly
    steps_up: tuple[float, ...] = (0.5, 0.8, 0.9, 0.95, 0.98)  # of the load of failure, held before the collapse
    harder: float = 1.005  # growth of a load that holds after all
    near_peak: float = 0.97  # share of the failure load at which loading counts as over


@dataclass(frozen=True)
class MechanismSettings:
    """Who takes part in a failure, and how it is called."""

    rocking: float = 0.02  # share of friction in the released work, below which nothing slides
    turns: float = 0.1  # rotation × size of the structure over the largest motion, below which nothing turns
    takes_part: float = 0.1  # of the largest motion
    listed: int = 20  # names in a summary


@dataclass(frozen=True)
class SettlementSettings:
    """How slowly supports move."""

    rows: int = 200  # looks along the way
    per_step: float = 0.05  # movement of a support in a step, in elastic displacements under the dead loads
    fewest: int = 20_000  # steps of the whole movement, at least


@dataclass(frozen=True)
class FrequencySettings:
    """Natural frequencies: dense or sparse eigenvalues, and how exact."""

    dense: int = 30  # degrees of freedom up to which a full matrix is used; beyond, threads of BLAS may cost more
    dense_share: float = 0.5  # of all modes: from there on as well
    accurate: float = 1e-6  # residual over the highest eigenvalue, whose error is of its square
    zero: float = 1e-12  # of the highest eigenvalue: no vibration below it
    shift: float = 1e-10  # of the highest eigenvalue: where the lowest ones are looked for
    equal: float = 1e-6  # shares of energy no further apart are the same: the first block or joint is named


@dataclass(frozen=True)
class ModesSettings:
    """Modes under gravity: which contact points are springs, pictures, calibration from a measured frequency."""

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
    """Time histories: looks along the way, time step, and when one of many runs has ended."""

    longest_look: float = 0.1  # s from one look to the next, at most
    rows: int = 200  # looks along the way: energies, collapse, whether all is well
    settling: int = 4_000_000  # steps to come to rest, at most
    blow_up: float = 0.2  # energy error over the largest energy from which a run is stopped
    inside: float = 1e-3  # of the smallest edge: blocks moved deeper into others than joints give when they close
    look: float = 0.1  # s of motion between two looks of one of many runs: collapse times are known to this
    energy_every: int = 10  # looks from one look into the books to the next
    still: float = 0.01  # unbalanced force, in weights of a block, below which it has come to rest ...
    quiet: float = 1e-3  # ... with so much of the noticeable energy at most


@dataclass(frozen=True)
class RestitutionSettings:
    """The dashpot that gives a wanted ratio of angular velocities, found by rocking a block."""

    housner_fraction: float = 2.0  # of critical: within 3e-4 of Housner's ratio for h/b from 2 to 5 (docs/rocking.md)
    most: float = 4.0  # fractions of critical between which a ratio is sought
    least: float = 0.1  # with less, landings are many bounces
    tilt: float = 0.3  # of the angle at which the block would fall
    landed: float = 0.05  # of the first tilt: beyond it on the other side the block has landed and chatters no more
    look: float = 2e-3  # share of the longest possible time between two looks
    most_steps: int = 200_000  # for the block to come to rest


@dataclass(frozen=True)
class SafetySettings:
    """Safety analyses: loads of each run, and the bisection of the value."""

    shares: tuple[float, ...] = (0.5, 0.8, 0.9, 0.95, 0.98, 1.0)  # of the load, held one after the other
    near: float = 0.9  # a failure that near the whole load is tried again by halves of its step, down to
    gentle: float = 0.005  # this: a larger step may have shaken down what a smaller one does not
    soft: float = 0.5  # displacement in smallest edges, over the resolution: geometry must move beyond
    closer: float = 0.1  # width of the bracket of limit analysis over that of the runs
    first: float = 0.4  # resolutions from a guess to the first value on either side of it
    growth: float = 4.0  # of the next steps
    stride: float = 1.5  # from factor to factor where there is no guess; the next steps grow
    nothing: float = 1e-3  # of the range, below which a resolution relative to a value makes no sense


@dataclass(frozen=True)
class StatisticsSettings:
    """Many runs: draws of slightly different structures, and the distribution of what they carry."""

    largest_draw: float = 3.0  # standard deviations that a draw is limited to
    resamples: int = 400  # of the bootstrap
    points: int = 101  # of the curve in summary.json
    narrowest: float = 1e-4  # least dispersion: all bounds overlap
    few: int = 2  # intervals between levels that any narrow distribution fits
    ask: float = 0.2  # s between two looks at an interrupt and at the progress


@dataclass(frozen=True)
class DoubtSettings:
    """From where on a run warns about its own answer."""

    shear_low: float = 0.01  # ks/kn of given joints that structures were tested with
    shear_high: float = 10.0
    leans: float = 0.006  # displacement before failure, in widths: loads were more than 0.5 % off beyond
    uneven: float = 1e3  # how much faster than another a block may fall in pseudo-time
    closure: float = DOUBTFUL_CLOSURE  # energy error over the largest energy
    overlap: float = DOUBTFUL_OVERLAP  # in smallest edges
    overshoot: float = 0.02  # of the failure load, that the curve of the collapse may peak above it
    above: float = 0.005  # of the associated load, that a failure load may lie above it
    lowered: float = 0.005  # of the load on stiff joints, that soft ones may change it by
    beyond: float = 0.005  # of the value, that a structure may stand beyond what limit analysis proved impossible
    governs: float = 0.05  # share of numerical damping in all that is lost


@dataclass(frozen=True)
class Settings:
    """All settings of the solvers, in groups by what they belong to."""

    stiffness: AutomaticStiffness = AutomaticStiffness()
    detection: DetectionSettings = DetectionSettings()
    clearance: ClearanceSettings = ClearanceSettings()
    relaxation: RelaxationSettings = RelaxationSettings()
    proof: ProofSettings = ProofSettings()
    load_search: LoadSearchSettings = LoadSearchSettings()
    warm_start: WarmStartSettings = WarmStartSettings()
    post_peak: PostPeakSettings = PostPeakSettings()
    mechanism: MechanismSettings = MechanismSettings()
    settlement: SettlementSettings = SettlementSettings()
    frequency: FrequencySettings = FrequencySettings()
    modes: ModesSettings = ModesSettings()
    history: HistorySettings = HistorySettings()
    restitution: RestitutionSettings = RestitutionSettings()
    safety: SafetySettings = SafetySettings()
    statistics: StatisticsSettings = StatisticsSettings()
    limit: LimitSettings = field(default_factory=LimitSettings)
    doubts: DoubtSettings = DoubtSettings()

    def changed(self) -> dict[str, Any]:
        """The settings that differ from the default, by their path, such as "relaxation.tolerance"."""
        return dict(_differences(self, ""))


def _differences(settings: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Path and value of each setting of a record, and of the records in it, that is not the default."""
    for part in fields(settings):
        value = getattr(settings, part.name)
        if is_dataclass(value):
            yield from _differences(value, f"{path}{part.name}.")
        elif value != part.default:
            yield path + part.name, value


DEFAULT = Settings()
