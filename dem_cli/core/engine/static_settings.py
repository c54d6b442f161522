"""Settings of static analyses: proof of failure, search of the failure load, collapse, settlement, safety."""

from __future__ import annotations

from dem_cli.frozen_records import dataclass


@dataclass(frozen=True)
class ProofSettings:
    """Settings of the proof of failure by power, and of motion that no elastic structure makes.

    Displacement at constant load grows fourfold when time doubles while it accelerates, twofold at constant speed.
    """

    doublings: int = 4  # of time, the last ones, in which motion must go on in the same way
    accelerated: float = 2.5  # growth while time doubles that counts as acceleration
    steady: float = 1.55  # growth while time doubles that counts as steady motion
    far: float = 30.0  # in elastic displacements; walls of few courses still find equilibrium after 20
    far_per_depth: float = 0.125  # times the square of the courses: walls of 22 find it after 40, of 70 after 300
    closing: float = 1e4  # of integrated faces: one that is pressed over c turns by 2 N/(kn c²)
    beyond: float = 2.0  # times as far as a path reached its equilibrium at the same load, ...
    unexpected: float = 150.0  # ... elastic displacements, where a path carries more, does not say, or there is none
    in_place: float = 0.03  # of the width of a block, that such a way is at most where geometry moves, and mechanisms
    steadily: float = 3.3  # times as far, where the motion does not accelerate
    gross: float = 0.1  # of the width of a block: no elastic motion
    turned: float = 0.05  # rad: no elastic rotation
    not_elastic: float = 10.0  # elastic displacements that gross motion is beyond, where joints are soft


@dataclass(frozen=True)
class StabilitySettings:
    """Settings of the buckling test: tangent stiffness, and motion of blocks pushed a little along its shape."""

    acting: float = 1e-9  # of the largest normal force: points with more carry, and count in the tangent
    negative: float = 1e-10  # of the largest eigenvalue: what is below minus that is negative
    turn: float = 1e-5  # rad: turn of blocks over which following loads are seen to change
    pushed: float = 1e-5  # of the smallest edge: how far blocks are moved
    goes_on: float = 20.0  # of that way, along the shape, where they move on
    goes_back: float = 0.1  # and where they have come back
    looks: int = 400  # at them


@dataclass(frozen=True)
class LoadSearchSettings:
    """Settings of the failure load search: probes, creep to an estimate, loads raised, failures tried again."""

    probes: int = 4  # small loads tried for the compliance, each a tenth of the last
    probe_steps: int = 20_000  # for the equilibrium under one of them, at least
    probe_steps_per_depth: int = 10  # times the square of the courses: a stack of 100 finds it after 51,000
    most_probe_steps: int = 200_000
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
    shares_of_hinges: tuple[float, ...] = (0.5, 0.9)  # the same where nothing slides at the bound: any way leads there
    least: float = 1e-3  # internal multiplier that the resolution is relative to, at least
    jump: float = 5.0  # resolutions; a failure after a larger step is tried again from close by
    leap: float = 0.04  # of a load, that a jump to a failure is at most where the next trial is right below it
    first_step: float = 0.5  # of the resolution: the first step from load to load after the first loads
    growth: float = 1.5  # of the next ones
    below: float = 0.2  # of the resolution: where a start is held; the rest is above it, where failure shows the sooner
    hold_start: int = 20_000  # steps of the fast way to rest there, or where nothing slides, before combined damping
    one_step: float = 0.99  # of the resolution: the next load, so that one failure closes the bracket
    beyond_impossible: float = 1e-4  # of a load proved impossible, that failure is shown at
    shown: float = 5.0  # elastic displacements that show a mechanism moving where limit analysis proves failure
    pushed: float = 1e-3  # of that load, put on besides as long as it is shown: where a mechanism is known
    soft: float = 0.5  # displacement at failure in smallest edges, over the resolution: geometry must move beyond
    likely: float = 0.99  # of the bound by limit analysis: an estimate above it says that the bound may be reached
    unslid: float = 1000.0  # elastic displacements that equilibrium may take below a bound at which nothing slides
    short: float = 0.6  # of the resolution: the trial below a load that limit analysis or the path expect, ...
    beyond: float = 0.35  # ... and the one above it
    small_steps: int = 200  # to the power of two above a load on which histories differ; 100 to 400 agree within 0.3 %
    least_of_fewest: float = 0.5  # of the fewest steps of an equilibrium so far, that small steps take: 0.6 to 1.3
    light: float = 0.05  # load, over the weights, below which balance is required the more closely the smaller it is
    noise: float = 3.0  # times what round-off leaves of balance: less is not required; 0.7 to 2.2 times were measured
    unbalanced: float = 0.5  # resolutions of a load, that this may be at most
    trial: int = 300_000  # steps of one trial until it is left undecided, at least; and
    trial_per_point: int = 100  # steps × number of contact points, and
    trial_per_depth: int = 400  # times the square of the courses, where geometry moves: stacks sway as long as that
    most_undecided: int = 5  # trials, before the bracket stays as wide as it is
    aside: float = 0.45  # of the bracket: how far from an undecided load the next trial is
    effort: float = 2e10  # steps × contact points, about 200 s: from there on a bracket that is known is not narrowed
    effort_of_large: float = 3e9  # the same of what follows the smoothed path of a large structure
    trial_of_large: int = 150_000  # steps of its trials
    step_of_large: float = 0.12  # and the first step of its load, over what is left to the bound
    below_of_large: float = 5e-4  # of the load of its path, where that is held first, if not as far below as others
    beyond_stiff: float = 2.0  # times the load of stiff joints, that an estimate is at most where geometry moves
    softer: float = 10.0  # joints that show how much stiffness matters where geometry moves
    softer_steps: float = 1.0  # of the steps of the search, that this may take, or of a trial
    widest: float = 0.1  # bracket, over its load, that is still given as an answer where it cannot be narrowed


@dataclass(frozen=True)
class WarmStartSettings:
    """Settings of the static solver's path, as a start or beside it: for which sizes, and when it has come to
    failure."""

    repeated: int = 1000  # blocks of one structure, beyond which no load is raised again in small steps
    beside_implicit: int = 300  # blocks of one structure, up to which the path is followed beside an implicit history
    flat: float = 1.0  # resolutions: growth of the load along the path, over that of displacement, that counts as none
    drop: float = 0.98  # of the highest load: a path that ends below it does not say that the highest was a failure
    at_the_end: float = 0.4  # of the displacement of a path: beyond it the highest load is a plateau and not a peak


@dataclass(frozen=True)
class ImplicitHistorySettings:
    """Settings of overdamped implicit steps under constant loads (statics/implicit_history.py): loads, steps, and
    verdicts."""

    blocks: int = 150  # of one structure in the plane, from which on it is quicker than the path and loads after it
    effort: float = 3e7  # factorisations × points before giving up
    narrow: float = 0.5  # of the resolution: width of the bracket, so that a load beyond it fails soon
    widest: float = 0.025  # of the load: bracket from which the explicit solver goes on where it stayed wider
    shares: tuple[float, ...] = (0.5, 0.8, 0.9)  # of the bound: first loads
    growth: float = 1.02  # of the next loads, until one fails
    small: float = 1.005  # the same in small steps
    beyond: float = 2e-4  # of the bound, above which no load is tried
    beside: float = 0.4  # resolutions: how far from a plateau of the resistance the next loads are
    under_dead_loads: int = 2  # of the attempts of the path to stand under dead loads
    first_under_dead_loads: float = 1e2  # first step of time where they come at once, in displacements of own weights
    most_under_dead_loads: int = 60  # of these steps
    first_step: float = 50.0  # of time, in largest elastic displacements at the multiplier 1
    growth_of_step: float = 8.0  # at most, and as long as
    share: float = 0.3  # of its displacement is what it grows by; at 0.6 loads come out 0.4 % too high
    at_rest: float = 1e-4  # force of the viscosity, in own weights, of an equilibrium
    far: float = 2.5  # displacements of the last equilibrium, beyond which a load may be seen to fail, and
    far_per_load: float = 5.0  # elastic ones, and
    far_of_ties: float = (
        15.0  # times as far as the longest way of a tie before it yields: at 3 loads were 1.6 % too low
    )
    flat: float = 0.7  # of what resistance lacked at half the displacement: so much still lacks where the load fails
    tau: float = 3e-4  # of the first products of a step, over the square of the largest normal force
    other_tau: tuple[float, ...] = (3e-6, 1e-2, 1e-7, 1.0)  # the same where steps fail, one after the other
    end: float = 1e-7  # of the last ones
    ahead: float = 1.5  # of the last slips, that the next step expects at most
    cut: float = 4.0  # where a step fails: so much shorter
    most_failed: int = 12  # times in turn
    most_steps: int = 400


@dataclass(frozen=True)
class PostPeakSettings:
    """Settings of the collapse at a prescribed rate, or under the load of failure."""

    elastic: float = 7e-4  # elastic displacement at failure that "auto" joints may show, in smallest edges
    steps: int = 200  # in which the rate passes the elastic displacement of a multiplier of one, at least
    fewest: int = 40_000  # steps of the whole way, about: fewer would throw the blocks about
    most: int = 60_000
    growth: float = 1.1  # of the rate from one look to the next, so that nothing is thrown at the start
    start_up: int = 50  # looks over which it grows
    ceiling: float = 1.015  # of the failure load: steps whose mean load is above are done again at ...
    slower: float = 0.7  # ... this share of the rate, ...
    tries: int = 12  # ... so often; what is above then is carried at rest
    growth_again: float = 1.03  # of the rate from then on, from one look to the next
    longest_look_slowed: int = 2000  # steps from one look to the next, as long as the rate has not grown again
    patience: int = 2_000_000  # steps of the whole way, at most
    rows: int = 250  # of the history
    first_look: int = 50  # steps to it; from one look to the next they at most double, and are
    shortest_look: int = 20  # at least, and at most
    longest_look_before_peak: int = 100
    longest_look: int = 20_000  # steps
    softest: float = 1e3  # kn·h/W
    stiffest: float = 1e7
    fall_speed: float = 1e-3  # of blocks that fall, in smallest edges per step: they land softly
    fall_pace: float = 20.0  # the same, in mean speeds of the whole way, where that is more
    steps_up: tuple[float, ...] = (0.5, 0.8, 0.9, 0.95, 0.98)  # of the load of failure, held before the collapse
    harder: float = 1.005  # growth of a load that holds after all
    near_peak: float = 0.97  # share of the failure load at which loading counts as over; or of the highest load, ...
    falls_from: float = 0.8  # ... where that was at least this share of the failure load
    at_peak: float = 0.99  # of the highest load or that of failure: the displacement there is where the curve first was


@dataclass(frozen=True)
class DisplacementControlSettings:
    """Settings of equilibria at prescribed displacements of the live load, from gravity to far beyond the peak of
    the curve.

    Increments grow from a share of the elastic displacement to the requested one; ramps grow with their square
    root, so that blocks are accelerated as much.
    """

    first: float = 0.05  # increment, in elastic displacements at an internal multiplier of one
    growth: float = 1.2  # of the next ones
    ramp: int = 200  # steps of the first increment; its rate grows and falls smoothly
    stairs: int = 10  # rates in a ramp
    tolerance: float = 1e-4  # unbalanced force in own weights at which an increment is at rest
    look: int = 25  # steps from one look at the forces to the next
    looks_at_rest: int = 3  # one after the other, at which they balance
    most: int = 20_000  # steps to come to rest, then the increment is tried again in
    shares: int = 4  # parts, and
    tries: int = 2  # once more in parts of these
    driven: float = 1e-6  # of the displacement of blocks: a monitor that moves less is not moved by the live load
    approach: tuple[float, ...] = (0.9, 1.0, 1.0)  # shares of what is left, in which a monitor comes to where it should
    near_target: float = 0.02  # of a step: how near it comes
    implicit_effort: float = 2e7  # factorisations × points of a curve in implicit increments: about a minute
    implicit_longer: float = 2.0  # increments there
    implicit_rounds: int = 4  # one of them and, where it ends further out of balance than so many own weights, ...
    implicit_near: float = 1e-2  # ... others without a displacement
    # Steps of a ramp, by dimension, from which on an increment is implicit: in space solutions are dear and rarer.
    long_ramp: tuple[float, ...] = (0.0, 0.0, 2e3, 2e4)
    implicit_starts: tuple[float, ...] = (1.0, 1e2)  # first products of the interior point, tried in turn
    mostly: float = 0.1  # of the increments, that may need ramps
    coarser: float = 2.0  # increments of the curve that the peak is compared with
    near: float = 0.25  # of the resolution: what the load may lack where that curve ends
    past: float = 0.999  # of the highest load so far: a curve that fell below it is past its peak


@dataclass(frozen=True)
class MechanismSettings:
    """Thresholds of the blocks and joints that take part in a failure, and of its name."""

    rocking: float = 0.02  # share of friction in the released work, below which nothing slides
    turns: float = 0.1  # rotation × size of the structure over the largest motion, below which nothing turns
    parts: float = 0.01  # slip over the largest motion, below which what does not turn comes off and does not slide
    takes_part: float = 0.1  # of the largest motion
    follows: float = 0.02  # of the largest motion: what goes elsewhere by more is not the mechanism it is compared with
    slides: float = 1e-6  # of the shear limit: a point that is as near to it slides
    listed: int = 20  # names in a summary


@dataclass(frozen=True)
class SettlementSettings:
    """Settings of the rate at which supports move."""

    rows: int = 200  # looks along the way
    station: int = 10  # looks from one state that is kept to the next
    per_step: float = 0.05  # movement of a support in a step, in elastic displacements under the dead loads
    fewest: int = 20_000  # steps of the whole movement, at least


@dataclass(frozen=True)
class SafetySettings:
    """Settings of safety analyses: loads of each run, and the bisection of the value."""

    shares: tuple[float, ...] = (0.5, 0.8, 0.9, 0.95, 0.98, 1.0)  # of the load, held one after the other
    near: float = 0.9  # a failure that near the whole load is tried again by halves of its step, down to
    gentle: float = 0.005  # this: a larger step may have shaken down what a smaller one does not
    soft: float = 0.5  # displacement in smallest edges, over the resolution: geometry must move beyond
    closer: float = 0.1  # width of the bracket of limit analysis over that of the runs
    first: float = 0.4  # resolutions from a guess to the first value on either side of it
    growth: float = 4.0  # of the next steps
    stride: float = 1.5  # from factor to factor where there is no guess; the next steps grow
    nothing: float = 1e-3  # of the range, below which a resolution relative to a value makes no sense
