"""Settings of the solvers, all in one record: tolerances, damping, detection, and those of each kind of analysis.

No input file can set them; benchmarks and studies pass others. Each was chosen once, for all structures
(docs/numerics.md), and a summary names those that differ from the default.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field, fields, is_dataclass, replace
from typing import Any

from dem_cli.core.engine.dynamic_settings import (
    FrequencySettings,
    HistorySettings,
    ModesSettings,
    RestitutionSettings,
    RockingSettings,
    SnapshotSettings,
    StatisticsSettings,
)
from dem_cli.core.engine.static_settings import (
    DisplacementControlSettings,
    ImplicitHistorySettings,
    LoadSearchSettings,
    MechanismSettings,
    PostPeakSettings,
    ProofSettings,
    SafetySettings,
    SettlementSettings,
    StabilitySettings,
    WarmStartSettings,
)
from dem_cli.core.limit.settings import LimitSettings
from dem_cli.core.model.scales import DOUBTFUL_CLOSURE, DOUBTFUL_OVERLAP, DOUBTFUL_REWEIGHTING
from dem_cli.frozen_records import dataclass


@dataclass(frozen=True)
class AutomaticStiffness:
    """Settings of "auto" stiffness kn·h/W: normal stiffness [Pa/m] times smallest edge over mean weight per joint
    area."""

    fixed: float = 1e10  # where geometry is that of the start, and stiffness drops out
    digits: float = 1e-4  # there too, a weight sinks by the last digit of a coordinate over this
    beside_links: float = 100.0  # there too, joints over the stiffest tie or bar: both have to settle in the same steps
    statics: float = 1e6  # where geometry moves; with ties and bars everywhere at least
    dynamics: float = 1e5  # in time histories, at least: rocking may ask for more (dynamics/rocking_stiffness.py)
    settlement_overlap: float = 1e-3  # overlap that the dead loads may cause where supports move, in smallest edges
    # Share of its load that leaning over its joints may cost a structure that moves: where failed loads are tried again
    # from close by, so that only the last step of the load counts (far from 0.8: it falls by itself), and elsewhere.
    leaning: float = 0.1
    leaning_at_once: float = 0.002
    noise: float = 0.3  # unbalanced force that round-off may leave in stiffer joints, in tolerances of an equilibrium


@dataclass(frozen=True)
class DetectionSettings:
    """Settings of contact detection, and of the length of a compiled call."""

    skin: float = 0.05  # reach, as a share of the smallest edge
    wide_skin: float = 0.15  # of blocks that rock and move far: fewer detections are worth more joints to look at
    passing: float = 1e-4  # of a part: corners that met at the start have not passed each other before
    overlaps: float = 2.0  # nor before so many times the largest elastic overlap
    looks: float = 0.1  # of that way: between two looks whether they have
    same_place: float = 0.01  # of the reach: blocks that moved less have the same faces as before
    shortest_call: int = 100  # steps of one compiled call, at least
    tiled_from: int = 1_000  # contact points from which joints of fixed geometry are worked on many at once
    longest_call: int = 20_000_000  # points × steps of one compiled call, about 0.2 s: Ctrl-C waits no longer


@dataclass(frozen=True)
class ClearanceSettings:
    """Settings of clearance: motion until gaps of the start have closed is neither elastic nor failure."""

    margin: float = 1.25  # for the slip that goes with a microrotation, and finite rotations
    widest: float = 0.25  # of the smallest edge: gaps beyond are meant to stay
    amplified: float = 20.0  # motion of blocks over the gap that it closes
    farthest: float = 0.5  # of the width of a block: motion beyond is failure, whatever gaps it closes
    steepest: float = 0.3  # rad: the same of a rotation
    bare: float = 1e-3  # of an edge: faces that overlap by less meet corner to corner


@dataclass(frozen=True)
class RelaxationSettings:
    """Settings of relaxation to equilibrium at a constant load: tolerances, damping, fictitious masses, ramps of
    loads.

    Mass scaling (`*_safety`) for FIRE, for local damping (numerics, section 3) and for combined damping, which makes a
    reversal of force 1 + 2 combined_damping times as strong and is stable below 1/√(1 + 2 combined_damping) = 0.79.
    """

    tolerance: float = 1e-5  # unbalanced force on any block of a claimed equilibrium, in its own weight
    gravity_tolerance: float = 1e-5  # the same under dead loads alone
    live: float = 0.1  # of the live load on a light block, that its unbalanced force is measured by at least
    carried: float = 1e-3  # the same of what its joints carry
    chunk: int = 100  # steps between two looks
    looks_at_rest: int = 2  # one after the other, at which forces balance: not only passed by
    most_steps: int = 40_000  # of the fast way to an equilibrium, before it is sought with combined damping
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
    shortest_ramp: int = 500  # steps: a shorter ramp of a load is left out
    longest_ramp: int = 20_000  # steps
    stair: int = 20  # steps between the loads of a ramp
    follow_every: int = 50  # steps between two looks at where loads that follow blocks are: they hardly turn meanwhile
    # The same where joints remember: a load put on at once swings to nearly twice its size, and cracks or crushes what
    # it would not by itself.
    ramp_of_memory: int = 100  # steps per course
    ramp_of_links: float = 100.0  # of dead loads: periods of the heaviest block on the softest tie or bar that yields
    stair_of_memory: int = 5
    stair_of_strain: int = 1  # of blocks that swell or shrink, which else leap off each other: joints slip as they jump

    def stretched(self, factor: float) -> RelaxationSettings:
        """Return settings with time steps longer by a factor, by lighter fictitious masses."""
        names = ("fire_safety", "creep_safety", "combined_safety")
        safeties = {name: factor * getattr(self, name) for name in names}
        return replace(self, **safeties)


@dataclass(frozen=True)
class ReliefSettings:
    """Settings of relief: elastic closure of "auto" joints, taken back where blocks are at rest
    (engine/rigid_joints.py)."""

    shown: float = 0.005  # of it, that geometry may show in a state that counts as an equilibrium, at most
    of_resolution: float = 0.25  # of the resolution of a load, that what is shown may cost
    gain: float = 0.5  # of what is shown: where more is left after a round, another one would not end it either
    sliding: float = 1e-3  # of the shear stiffness: points go back without sliding where that is possible
    singular: float = 1e-12  # of the stiffness of a block, that holds what no joint holds: a mechanism is not elastic
    pushed: float = 10.0  # largest closures, by which an open point may be pushed into overlap: 1e-5 of a block
    rounds: int = 20  # in which points are held that would be pushed further


@dataclass(frozen=True)
class DoubtSettings:
    """Thresholds from which a run warns about its own answer."""

    shear_low: float = 0.01  # ks/kn of given joints that structures were tested with
    shear_high: float = 10.0
    leans: float = 0.006  # displacement before failure, in widths: loads were more than 0.5 % off beyond
    leans_pressed: float = 8e-4  # where pressure is integrated: a block that rocks loses six times this (see there)
    lumped: float = 0.5  # kn h/E of joints that carry the deformation of blocks: a wall gave way by 2 % too much at 0.4
    unbending: float = 0.1  # the same of blocks of uniform strain: a column that bends gave way by 8 % too little
    uneven: float = 1e3  # how much faster than another a block may fall in pseudo-time
    closure: float = DOUBTFUL_CLOSURE  # energy error over the largest energy
    overlap: float = DOUBTFUL_OVERLAP  # in smallest edges
    rigid_overlap: float = 3e-3  # the same where elastic closure is taken back: 1e-4 to 6e-4 were seen of sound runs
    reweighted: float = DOUBTFUL_REWEIGHTING  # of the energy, that went or came as the areas of contact points changed
    off_the_load: float = 0.02  # of the failure load, that the curve of the collapse may peak above or below it
    clamped: float = 0.02  # of the associated load, that a run with ties or bars may lie below it without a word
    lowered: float = 0.005  # of the load on stiff joints, that soft ones may change it by
    beyond: float = 0.005  # of the value, that a structure may stand beyond what limit analysis proved impossible
    buckles: float = 0.3  # of its load, that leaning over "auto" joints costs a structure; it falls by itself at 0.8
    governs: float = 0.05  # share of numerical damping in all that is lost


@dataclass(frozen=True)
class Settings:
    """Settings of the solvers, in groups by what they belong to."""

    stiffness: AutomaticStiffness = field(default_factory=AutomaticStiffness)
    detection: DetectionSettings = field(default_factory=DetectionSettings)
    clearance: ClearanceSettings = field(default_factory=ClearanceSettings)
    relaxation: RelaxationSettings = field(default_factory=RelaxationSettings)
    relief: ReliefSettings = field(default_factory=ReliefSettings)
    proof: ProofSettings = field(default_factory=ProofSettings)
    stability: StabilitySettings = field(default_factory=StabilitySettings)
    load_search: LoadSearchSettings = field(default_factory=LoadSearchSettings)
    implicit_history: ImplicitHistorySettings = field(default_factory=ImplicitHistorySettings)
    warm_start: WarmStartSettings = field(default_factory=WarmStartSettings)
    post_peak: PostPeakSettings = field(default_factory=PostPeakSettings)
    displacement_control: DisplacementControlSettings = field(default_factory=DisplacementControlSettings)
    mechanism: MechanismSettings = field(default_factory=MechanismSettings)
    settlement: SettlementSettings = field(default_factory=SettlementSettings)
    frequency: FrequencySettings = field(default_factory=FrequencySettings)
    modes: ModesSettings = field(default_factory=ModesSettings)
    history: HistorySettings = field(default_factory=HistorySettings)
    snapshots: SnapshotSettings = field(default_factory=SnapshotSettings)
    rocking: RockingSettings = field(default_factory=RockingSettings)
    restitution: RestitutionSettings = field(default_factory=RestitutionSettings)
    safety: SafetySettings = field(default_factory=SafetySettings)
    statistics: StatisticsSettings = field(default_factory=StatisticsSettings)
    limit: LimitSettings = field(default_factory=LimitSettings)
    doubts: DoubtSettings = field(default_factory=DoubtSettings)

    def changed(self) -> dict[str, Any]:
        """Return the settings that differ from the default, by their path, such as "relaxation.tolerance"."""
        if self is DEFAULT:
            return {}
        return dict(_differences(self, type(self)(), ""))


def _differences(settings: Any, default: Any, path: str) -> Iterator[tuple[str, Any]]:
    """List path and value of each setting of a record, and of records in it, that differs from the default record."""
    for part in fields(settings):
        value, usual = getattr(settings, part.name), getattr(default, part.name)
        if is_dataclass(value):
            yield from _differences(value, usual, f"{path}{part.name}.")
        elif value != usual:
            yield path + part.name, value


DEFAULT = Settings()
