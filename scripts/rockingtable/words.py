"""What rocking.md says around its tables."""

HEAD = """\
# Rocking, sliding and bouncing blocks against exact motions

Written by `scripts/rocking --write` from `docs/rocking.json`; do not edit. The exact motions are programs of their own
(`tests/oracle`: Housner's block event by event, Newmark's slider, two blocks by Lagrange's equations, a bouncing block
in closed form), tested against elliptic integrals, closed-form bounds and tight integration
(`tests/verification/test_oracle_dynamics.py`). Errors are dem over exact, less 1.

Unless a table says otherwise: friction 10 (blocks do not slide), `restitution = "housner"`, joint stiffness
kn h/W = 1e6 (kn = 1e6 ρ g; W the weight of a block, kn times its base), the default time step (a quarter of the
largest stable one). "auto" joints of time histories have kn h/W = 1e5.
"""
FREE = """\
## Free rocking

Blocks of 1 m height, let go at 0.6 of the angle at which they would fall. All swings above 0.02 of that angle are
compared; below it the elastic joint rocks as much as the block. Each column has the worst of all swings.

![free rocking: lines exact, dots dem](rocking_free.png)"""
MAP = """\
## What an impact leaves

Angular velocity after over before the first impact, from the heights of the swings. `contact_fraction` is that of
critical damping at √(kn A/M): the ratio tends to Housner's from above, as dashpots do not pull. (The elastic energy
that a softer joint holds counts as lost here: some 0.001 at kn h/W = 1e5.)"""
BOUNDS = """\
## Overturning by one sine

A block of 0.5 m × 2 m (p = 2.672 rad/s) under one sine of acceleration A. Overturning is not monotone in A: up to three
bounds at one frequency lie below A = 16 g tan α. The oracle is asked along a grid of amplitudes 1 % apart; each change
of its answer is a bound, bisected. dem must have the oracle's answers 3 % below and above it (nearer where bounds
are closer than 6 %), and is bisected in between. {count} bounds, {missed} not found, largest error {worst}.

![bounds of overturning: shaded exact, dots dem](rocking_pulses.png)"""
PAIRS = """\
## Earthquake records: ensembles

Single records of rocking are ill-conditioned, so ensembles are compared: pairs of a block (h/b 2 to 6, height 1 to 4 m)
and 20 s of band-limited noise (0.3 to 6 Hz, peak 1.2 to 4 g tan α), drawn from seeds (`tests/oracle/pairs.py`).
Peaks are those of |θ|/α; of blocks that overturned, 2. The lower rows compare the oracle with itself after the record
was scaled by 0.1 %: that is what the peak of a single record means. Median differences are of blocks that stood twice.
A p above 0.05 means that the two cannot be told apart: McNemar's exact test for the outcomes, Kolmogorov and Smirnov's
for the distributions, the sign test for bias.

![distributions of peaks, and single pairs](rocking_pairs.png)"""
SLIDES = """\
## Sliding

A block of 1 m × 0.3 m on friction 0.2 (sine), 0.3 or, on the slope, 0.4; `contact_fraction = 0.35`. Where the block
comes back the final slip is a small rest of a long way: see the last column."""
STACKS = """\
## Two blocks until the first closure

0.4 m × 1.2 m on 0.5 m × 1 m, let go from angles of 0.04 to 0.15 rad. Angles are compared up to the closure, over the
largest of them; the time of closure is a sample, 5000 of them per second."""
BOUNCE = """\
## A block that bounces

A fall of 50 mm on an elastic joint, flat. Without a dashpot nothing is lost. The joint closes and opens somewhere
within a step, so that the error has either sign, and falls with the square of the step; at the default step it is up
to a per cent. `margin` is that of `[analysis]`, 0.25 by default. With a dashpot the two points of the joint are
solved one after the other, which leaves the block turned a little after its first landing: later ones are on a
corner, and the third bounce is another. Rocking with "housner" does not mind: its landings are plastic."""
ENERGY = """\
## Energy

A column of 8 blocks of 0.4 m × 0.5 m rocks for 20 s under five records of 1.4 m/s². The error of the books, over the
largest energy in them: root mean square of the five, and the largest. The step in which
a point closes or opens decides: its spring takes what it stores (`meeting` in `kernels/contact_forces.py`) but for what
the speed changes within that step. Undamped columns chatter most. The default margin is 0.25."""
