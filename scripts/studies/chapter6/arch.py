"""The arch of 8 blocks: static load, harmonic motion, and which outcomes depend on what nobody knows (thesis 6.2.1)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from bench.table import percent
from reference import results

from dem_cli.results.post import style
from studies.chapter6.shaken_case import run
from studies.storage import rounded
from studies.template import commands, table

UNIT = 0.325 * 9.81  # m/s² at a = 1
TRIED = {"harm_25": (2.5, 1.1), "harm_5_15": (5.0, 1.5), "harm_5": (5.0, 2.0), "harm_10": (10.0, 2.0)}
FALLS = "harm_25"  # the only one of them in which the thesis's arch collapses
HEADS = tuple(f"{frequency:g} Hz, a = {a:g}" for frequency, a in TRIED.values())
FREQUENCIES = (2.0, 2.5, 3.5, 5.0, 7.0, 10.0)  # Hz
RING = ("arch-left-1", *(f"arch-{k}" for k in range(1, 7)), "arch-right-1")  # blocks of the ring, from the left
JOINTS = {"springings": (0, 6), "1 on 2 and 6 on 5": (1, 5), "2 on 3 and 5 on 4": (2, 4)}  # by their left block
LADDER = tuple(round(0.5 + 0.1 * k, 2) for k in range(31))  # a, up to the first collapse
EDGE = (0.9, 1.0, 1.2, 1.3)  # a, where it falls
REPEATS = 20


def sizes(angle: float, ring: float, radius: float) -> tuple[str, ...]:
    """Another arch on the same columns: included angle [deg], depth of the ring and inner radius [m]."""
    return (
        f"structure.0.included_angle_deg={angle:g}",
        f"structure.0.ring={ring:g}",
        f"structure.0.inner_radius={radius:g}",
    )


SEMICIRCLE = sizes(180.0, 0.08, 0.20)  # of cases/verification/portal.toml: the load is met, nothing else
ARCHES: dict[str, tuple[str, ...]] = {"arch of 120°": (), "semicircle": SEMICIRCLE}
VARIANTS: dict[str, dict[str, tuple[str, ...]]] = {
    "what the thesis does not say of the motion": {
        "cosine: phase 90°": ("motion.phase_deg=90",),
        "the other way: phase 180°": ("motion.phase_deg=180",),
        "two cycles to rise": ("motion.ramp=2",),
    },
    "joints": {
        "friction 0.55": ("joints.dry.friction=0.55",),
        "friction 0.65": ("joints.dry.friction=0.65",),
        "kn and ks × 0.2": ("joints.dry.kn=1.7125e8", "joints.dry.ks=1.7125e8"),
        "kn and ks × 10": ("joints.dry.kn=8.5625e9", "joints.dry.ks=8.5625e9"),
        "ks = kn / 10": ("joints.dry.ks=8.5625e7",),
    },
    "damping": {
        "ζ = 0.15": ("damping.contact_fraction=0.15",),
        "ζ = 0.75": ("damping.contact_fraction=0.75",),
        "0.35 of critical of each joint": ("damping={ contact_fraction = 0.35 }",),
        "of mass as well, 2 /s": ("damping.mass=2.0",),
    },
    "numbers": {"a third of the step": ("analysis.margin=0.05",)},
}


def measure() -> dict[str, Any]:
    """Static loads, outcomes under harmonic motion, perturbed structures, variants, ladders of amplitude."""
    return {
        "static": {name: run("arch_8_static", *more).answer for name, more in ARCHES.items()},
        "harmonic": {name: outcome(name) for name in TRIED},
        "perturbed": {name: perturbed(name) for name in TRIED},
        "edge": {f"{a:g}": perturbed(FALLS, a=a) for a in EDGE},
        "variants": {name: four(*more) for group in VARIANTS.values() for name, more in group.items()},
        "slips": {name: _slips(*more) for name, more in ARCHES.items()},
        "ladders": {name: [_ladder(f, *more) for f in FREQUENCIES] for name, more in ARCHES.items()},
    }


def outcome(name: str, *more: str) -> dict[str, Any]:
    """One of the motions of the thesis."""
    return shaken(*TRIED[name], *more)


def four(*more: str) -> dict[str, Any]:
    """All of them."""
    return {name: outcome(name, *more) for name in TRIED}


def shaken(frequency: float, a: float, *more: str) -> dict[str, Any]:
    """One run; peak: largest |rotation| of a column [rad], slid: slip of each foot in the end [m]; means of the last
    cycle: left, right: rotations [rad], crown: drop [m].
    """
    found = run("arch_8_harmonic_5hz", f"motion.frequency={frequency:g}", f"motion.amplitude={a * UNIT:.5g}",
                "analysis.after_collapse=0.0", "output.frames=0", *more)  # fmt: skip
    answer = found.answer
    if len(found.values):
        last = found.times > found.times[-1] - 1.0 / frequency
        right, left, crown = found.values[last, :3].mean(axis=0)
        answer |= rounded({
            "peak": np.abs(found.values[:, :2]).max(), "crown": -crown, "left": left, "right": right,
            "slid": found.values[-1, 3:5],
        })  # fmt: skip
    return answer


def perturbed(name: str, *more: str, repeats: int = REPEATS, a: float | None = None) -> dict[str, Any]:
    """One of the motions on slightly different structures; a: another amplitude of it."""
    frequency, usual = TRIED[name]
    a = usual if a is None else a
    return run("arch_8_harmonic_5hz", f"motion.frequency={frequency:g}", f"motion.amplitude={a * UNIT:.5g}",
               f"analysis.repeats={repeats}", "output.frames=0", *more).answer  # fmt: skip


def _ladder(frequency: float, *more: str) -> dict[str, Any]:
    """The lowest a of a grid at which the arch collapses; None: none of them."""
    for a in LADDER:
        found = shaken(frequency, a, *more)
        if found.get("collapsed") is not False:
            return {"frequency": frequency, "a": a, "run": found}
    return {"frequency": frequency, "a": None, "run": found}


def _slips(*more: str) -> dict[str, list[float]]:
    """Slip of the joints at 5 Hz, a = 1.5, means of the first four cycles and of both sides [mm]."""
    monitors = ", ".join(f'{{ between = ["{a}", "{b}"], quantity = "slip" }}' for a, b in zip(RING[:-1], RING[1:]))
    frequency, a = TRIED["harm_5_15"]
    found = run("arch_8_harmonic_5hz", f"motion.frequency={frequency:g}", f"motion.amplitude={a * UNIT:.5g}",
                "analysis.after_collapse=0.0", f"monitor=[{monitors}]", *more)  # fmt: skip
    cycles = np.floor(found.times * frequency + 1e-9)
    slip = 1e3 * np.array([np.abs(found.values[cycles == k].mean(axis=0)) for k in range(4)])
    return {name: rounded(slip[:, sides].mean(axis=1), 3) for name, sides in JOINTS.items()}


def as_thesis(name: str, answer: dict[str, Any]) -> bool:
    """Whether an arch collapses where that of the thesis does, and stands where it stands."""
    return answer.get("collapsed") is (name == FALLS)


def said(answer: dict[str, Any]) -> str:
    """What became of an arch, in a cell."""
    if answer.get("collapsed") is None:
        return "no answer"
    if answer["collapsed"]:
        return f"collapses, {answer['collapse_time']:.1f} s"
    return f"stands, crown {1e3 * answer['crown']:.1f} mm lower"


def marked(name: str, answer: dict[str, Any]) -> str:
    """The same, bold where the thesis's arch did otherwise."""
    return said(answer) if as_thesis(name, answer) else f"**{said(answer)}**"


def sliding(answer: dict[str, Any]) -> str:
    """Joints that slide in the mechanism of a static load."""
    joints = answer["mechanism"].get("sliding_joints", {"first": []})["first"]
    return ", ".join(" on ".join(name.removeprefix("arch-") for name in joint) for joint in joints) or "none"


def load_of(answer: dict[str, Any]) -> float:
    """Middle of the bracket of a failure load."""
    return sum(answer["failure_load_bracket"]) / 2.0


def values(found: dict[str, Any]) -> dict[str, Any]:
    """What arch.md.j2 shows."""
    return _static(found) | _harmonic(found) | _variants(found)


def _static(found: dict[str, Any]) -> dict[str, Any]:
    thesis = results("thesis_arch_shaking")["static_exp_num"]["value"]
    rows = [
        (name, f"{load_of(one):.4f}", percent(load_of(one) / thesis - 1.0), one["failure_mode"], sliding(one),
         f"{one['mechanism']['opening_joints']['count']}")
        for name, one in found["static"].items()
    ]  # fmt: skip
    head = ("", "dem λ", "over 0.325", "mode", "joints that slide", "that open")
    return {"thesis": thesis, "static": table(head, rows), "static_commands": commands(*found["static"].values())}


def _harmonic(found: dict[str, Any]) -> dict[str, Any]:
    rows = []
    for name, motion in zip(TRIED, HEADS, strict=True):
        repeats, ours = found["perturbed"][name]["repeats"], found["harmonic"][name]
        theirs = "collapses" if name == FALLS else "stands, crown lower" if name == "harm_5_15" else "stands"
        rows.append((motion, theirs, said(ours), f"{repeats['collapsed']} of {repeats['runs']}",
                     "yes" if as_thesis(name, ours) else "**no**"))  # fmt: skip
    ladders = [
        (f"{rung['frequency']:g} Hz", *(_lowest(row[i]) for row in found["ladders"].values()))
        for i, rung in enumerate(found["ladders"]["arch of 120°"])
    ]
    steady = found["harmonic"]["harm_5_15"]
    slips = [
        (name, joints, *(f"{slip:.1f}" for slip in row))
        for name, one in found["slips"].items()
        for joints, row in one.items()
    ]
    return {
        "harmonic": table(("motion", "thesis", "dem", "perturbed", "as the thesis"), rows),
        "ladders": table(("frequency", *found["ladders"]), ladders),
        "steady": {key: 1e3 * steady[key] for key in ("crown", "left", "right")},
        "edge": ", ".join(f"{one['repeats']['collapsed']} at {a}" for a, one in found["edge"].items()),
        "slips": table(("", "joints", *(f"cycle {k}" for k in range(1, 5))), slips),
        "harmonic_commands": commands(*found["harmonic"].values()),
    }


def _lowest(rung: dict[str, Any]) -> str:
    return f"more than {LADDER[-1]:g}" if rung["a"] is None else f"{rung['a']:g}"


def _variants(found: dict[str, Any]) -> dict[str, Any]:
    rows = [("**the case**", *(marked(*one) for one in found["harmonic"].items()))]
    for title, group in VARIANTS.items():
        rows.append((f"*{title}*", "", "", "", ""))
        rows += [(name, *(marked(*one) for one in found["variants"][name].items())) for name in group]
    runs = [one for row in found["variants"].values() for one in row.items()]
    return {
        "variants": table(("", *HEADS), rows),
        "as_thesis": sum(as_thesis(*one) for one in runs), "runs": len(runs),
        "variant_commands": commands(next(iter(found["variants"].values()))[FALLS], more=len(runs) - 1),
    }  # fmt: skip


def draw(found: dict[str, Any], path: Path) -> None:
    """Lowest collapses over frequency, beside what the thesis tried."""
    with style.figure(path, figsize=(6.8, 4.6)) as figure:
        axis = figure.subplots()
        for (name, row), colour in zip(found["ladders"].items(), (style.THRUST, style.GREY)):
            known = [(r["frequency"], r["a"]) for r in row if r["a"] is not None]
            axis.plot(*zip(*known), "o-", ms=6, lw=1.2, color=colour, label=f"dem collapses from here, {name}")
            beyond = [r["frequency"] for r in row if r["a"] is None]
            axis.plot(beyond, [LADDER[-1]] * len(beyond), "^", ms=8, color=colour)
        for name, (frequency, a) in TRIED.items():
            falls = name == FALLS
            axis.plot(frequency, a, "X" if falls else "s", ms=9, mfc="none" if not falls else style.COLLAPSE,
                      color=style.COLLAPSE if falls else style.INK)  # fmt: skip
        axis.plot([], [], "X", ms=9, color=style.COLLAPSE, label="thesis: collapses")
        axis.plot([], [], "s", ms=9, mfc="none", color=style.INK, label="thesis: stands")
        axis.set(xlabel="frequency [Hz]", ylabel="a = peak over 0.325 g", ylim=(0.4, 3.7), xticks=FREQUENCIES)
        axis.plot([], [], "^", ms=8, color=style.THRUST, label=f"arch of 120° stands up to {LADDER[-1]:g}")
        figure.legend(loc="outside lower center", ncols=2)


PICTURES = {"arch": draw}
