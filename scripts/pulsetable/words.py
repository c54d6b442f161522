"""What pulses.md says around its tables."""

HEAD = """\
# Published pulse tests: a column, an arch on buttresses, an arch of voussoirs

Written by `scripts/pulses --write` from `docs/pulses.json`; do not edit. Cases: `cases/validation/dimitri_column.toml`,
`dimitri_arch.toml`, `lemos_arch_pulse.toml`, `lemos_arch_elastic.toml`. Published values are those of the data book
(`tests/reference/dimitri_column_arch.toml`, `lemos_arch_pulse.toml`); all of them are results of other discrete element
programs, none is exact. Errors are ours over theirs, less 1. Nothing was fitted."""
STATIC = """\
## Static loads

Horizontal body force on all blocks, in g. Bracket: of the explicit solver (stands, falls), with the joint stiffness of
the case and geometry that moves. The arch of 17 voussoirs gives so much at kn = 1e10 Pa/m that it fails earlier."""
COLUMN = """\
## Column: which impulses overturn it

Dimitri, De Lorenzis and Zavarise 2011: seven drums and a cap, 5.95 m high, friction 0.7, kn = ks = 1e10 Pa/m; the
base is accelerated by +a for tp and by −a/2 for 2 tp. Theirs: UDEC and LMGC90. Their damping, their stiffness (ours is
that of a later input file), how long they looked, and what they call overturned are not known to us. Ours:
amplitudes 4 % apart from 0.8 of the least amplitude that overturns the column as one rigid block (from 2 g where none
does), the first change bisected to 0.3 %; {lasts:g} s after the impulse; a block that sank by 0.21 m has fallen; time
step {margin:g} of the largest stable one.

![least amplitudes](pulses_column.png)

−: it fell to the side to which the first push turned it; +: to the other side, so after impact. Errors in brackets."""
COLUMN_AFTER = """\
The jump is real and is one of kind: above it the column overturns while it is pushed first, below it it comes
back, lands and overturns to the other side. Between tp = {first} s and {last} s both happen, with amplitudes
between them at which it stands (bars of the picture, and the table below), so the answer is not monotone: a bisection
finds one bound or the other, depending on where it starts. How the published series were searched is not said. At
0.33 s, where we fall short of them by 42 % with 0.35 of critical, both have the amplitude of our second bound, and of
our only one with dashpots at or above critical: in this range damping and chance decide whether it overturns after
impact. Without damping it does from 0.32 s on, with critical damping only beyond 0.34 s; the jump of both published
series lies between. From 0.4 s on damping hardly matters, and UDEC is up to 9 % above us, LMGC90 up to 5 %. At
0.1 s dampings spread as far as the two programs do. As one rigid block, which loses a tenth of its energy when it
lands, the column overturns after impact at all tp from 0.15 s on: joints between drums take far more."""
FINE = "Time step {fine:g} instead of {coarse:g} of the largest stable one, 0.35 of critical:"
BUTTRESSES = """\
## Arch on buttresses: our domain

The same paper: arch of 12 voussoirs, inner radius 10 m, on buttresses of 30 m; friction 1, kn = ks = 4e10 Pa/m
(the input file that is public). No table of theirs is known to us, so this is ours alone. Amplitudes 10 % apart,
bisected to 0.3 %; 12 s after the impulse."""
VAULT = """\
## Arch of 17 voussoirs under a half sine

Lemos and Sarhosis 2023: inner radius 3.75 m, ring 0.5 m, friction 35°, kn = ks = 1e10 Pa/m; half a sine of body
acceleration, 0.15 g for 0.25 s, g = 10 m/s². Theirs: 3DEC. Displacement of the crown against the base, positive to
the side of the body acceleration.

What the data book leaves open was read from their 3DEC input files and series, public in the repository that it names
(thlgrs/HybriDFEM-3.1, `Figures Lemos/data-eq`):

* The history is the horizontal displacement of the vertex nearest to (0, 0, 4.2): the middle of the extrados of the
  keystone at z = 4.232 m (the 0.5 m by which the arch is "lower" are along its axis, out of the plane).
* Gravity is tilted by +0.15 g sin: body force to the positive side, so the base moves to the negative one.
* Faces are cut "radial-8", 3 × 3 contact points each. With areas by triangles that is 1/4, 1/2, 1/4 of the joint
  at inner edge, middle and outer edge. Here each voussoir consists of two parts with two points per joint: the same.
* Stiffness-proportional damping stands there as `rayleigh [2*appdamp] 11.0 stiff`, in a comment of the file of the
  Maxwell runs: 5 % at 11 Hz. Their elastic series confirms it: after the pulse it swings at {their_f:.2f} Hz with
  {their_r:.1f} % of critical. Ours with the same points: first frequency {our_f:.2f} Hz (`kind = "modes"`, elastic
  joints). 7.1 Hz is only that of the middle Maxwell element. Under gravity the joints without tension have a first
  frequency of {pressed:.2f} Hz: many points carry nothing.
* What makes our elastic arch 1.5 % lower in frequency, and so its elastic peaks 2 to 5 % higher, is not known.
* The voussoirs at the springings stand on wider bases.

![histories](pulses_arch.png)"""
STEPS = """\
With Maxwell elements the way back is a matter of chance: with time steps of {margins} of the largest stable one (0.25
is the default) the first peak is {first} mm, the one to the other side {second} mm, after {time} s."""
POINTS = """\
### What it depends on

First frequency with elastic joints [Hz] and largest displacement [mm], with the change against the case."""
POINTS_AFTER = """\
![places of contact points](pulses_points.png)

The places of the contact points matter more than anything else: their shares of the area say how soft the edge is
on which a joint turns. With 1/20 at the edge (5 points) the arch falls under this pulse, with 1/2 (2 points) it moves
by three quarters of the published value. The published value is one of a layout at kn = 1e10 Pa/m, not of the
arch: stiffer joints bring the layouts together. Largest displacement, no tension, 5 % stiffness [mm]:"""
ELEMENTS = """\
### Maxwell elements

An element of ratio ξ has the stiffness 4 ξ of the spring beside it, in dem. In closed form (all joints alike, elastic:
modes keep their shapes and answer s² + ω²(1 + Σ 4ξ s/(s + 2πf)) = 0) the three published elements, 0.0385 at 1 Hz,
0.0335 at 7.1 Hz and 0.052 at 50 Hz, give:"""
ELEMENTS_AFTER = """\
That is about 5 % from 1 to 50 Hz, as published. Elements stiffen: does the published kn hold without them (dem) or with
them ("kn and ks with the elements" above)? Free vibration after the pulse decides for the first: theirs is faster
with the elements than without by what ours is. It is damped more than ours, though; how 3DEC makes an element of a
ratio is not known to us. Frequencies and ratios from five half swings:"""
SPREAD = """\
### Earthquakes: a plausibility check only

Theirs: one synthetic record, scaled to 0.10 g and 0.20 g (its file is in the named repository; it is not copied
here). Ours: {count} artificial records, Eurocode 8 type 2, ground A, 15 s, each scaled to the same peak; ground type
and spectrum are a guess. Largest |displacement| of the crown [mm]."""
