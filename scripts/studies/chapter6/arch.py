"""The arch of 8 blocks: static load, harmonic motion, and which outcomes depend on what nobody knows (thesis 6.2.1)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from reference import results

from dem_cli.bench.table import percent
from dem_cli.post import style
from studies.chapter6.shaken_case import run
from studies.storage import rounded
from studies.template import commands, table

UNIT = 0.325 * 9.81  # m/s² at a = 1
TRIED = {"harm_25": (2.5, 1.1), "harm_5_15": (5.0, 1.5), "harm_5": (5.0, 2.0), "harm_10": (10.0, 2.0)}
LADDER = tuple(round(0.5 + 0.05 * k, 2) for k in range(51))  # a, up to the first collapse
REPEATS = 20


def sizes(ring: float, radius: float) -> tuple[str, str]:
    return f"structure.0.ring={ring:g}", f"structure.0.inner_radius={radius:g}"


SAME_LOAD = {
    (0.06, 0.20): "",
    (0.08, 0.20): "",
    (0.10, 0.183): "",
    (0.11, 0.16): "",
    (0.12, 0.129): "",
    (0.13, 0.089): "",
}  # ring and inner radius [m] of arches that fail at 0.325
VARIANTS: dict[str, dict[str, tuple[str, ...]]] = {
    "what the thesis does not say of the motion": {
        "cosine: phase 90°": ("motion.phase_deg=90",),
        "two cycles to rise": ("motion.ramp=2",),
    },
    "joints": {
        "friction 0.55": ("joints.dry.friction=0.55",),
        "friction 0.65": ("joints.dry.friction=0.65",),
        "friction 0.7": ("joints.dry.friction=0.7",),
        "friction 0.8": ("joints.dry.friction=0.8",),
        "friction 1.0": ("joints.dry.friction=1.0",),
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
    "other sizes": {
        "ring 0.10 m, inner radius 0.20 m": sizes(0.10, 0.20),
        "ring 0.12 m, inner radius 0.16 m": sizes(0.12, 0.16),
        "ring 0.12 m, inner radius 0.20 m": sizes(0.12, 0.20),
    },
}

MARGINAL = ("friction 0.8", "friction 1.0", "ring 0.12 m, inner radius 0.16 m", "ring 0.12 m, inner radius 0.20 m")


def measure() -> dict[str, Any]:
    """Static loads, outcomes under harmonic motion, ladders of amplitude, variants, perturbed structures."""
    static = {f"{t:g} {r:g}": run("arch_8_static", *sizes(t, r)).answer for t, r in SAME_LOAD}
    return {
        "static": static,
        "harmonic": {name: outcome(*TRIED[name]) for name in TRIED},
        "shapes": {f"{t:g} {r:g}": _four(*sizes(t, r)) for t, r in SAME_LOAD},
        "variants": {name: _four(*more) for group in VARIANTS.values() for name, more in group.items()},
        "ladders": {f"{friction:g}": [_ladder(f, friction) for f in (2.5, 5.0, 10.0)] for friction in (0.6, 0.8)},
        "perturbed": {name: _perturbed(*TRIED[name]) for name in TRIED},
        "margins": margins(),
    }


def outcome(frequency: float, a: float, *more: str) -> dict[str, Any]:
    """One run; peak: largest |rotation| of a column [rad], crown: drop in the end [m], slid: slip of each foot [m]."""
    found = run("arch_8_harmonic", f"motion.frequency={frequency:g}", f"motion.amplitude={a * UNIT:.5g}",
                "analysis.after_collapse=0.0", "output.frames=0", *more)  # fmt: skip
    answer = found.answer
    if len(found.values):
        right, left, crown, slid_left, slid_right = found.values.T
        answer |= rounded({
            "peak": max(np.abs(right).max(), np.abs(left).max()), "crown": -crown[-1],
            "left": left[-1], "right": right[-1], "slid": [slid_left[-1], slid_right[-1]],
        })  # fmt: skip
    return answer


def margins() -> dict[str, Any]:
    """Perturbed structures of variants that stand in some cases."""
    every = {name: more for group in VARIANTS.values() for name, more in group.items()}
    return {
        name: {motion: _perturbed(*TRIED[motion], *every[name], repeats=REPEATS // 2) for motion in TRIED}
        for name in MARGINAL
    }


def _four(*more: str) -> dict[str, Any]:
    return {name: outcome(*TRIED[name], *more) for name in TRIED}


def _ladder(frequency: float, friction: float) -> dict[str, Any]:
    """The lowest a of a grid at which the arch collapses; None: none of them."""
    for a in LADDER:
        found = outcome(frequency, a, f"joints.dry.friction={friction:g}")
        if found.get("collapsed") is not False:
            return {"frequency": frequency, "a": a, "run": found}
    return {"frequency": frequency, "a": None, "run": found}


def _perturbed(frequency: float, a: float, *more: str, repeats: int = REPEATS) -> dict[str, Any]:
    found = run("arch_8_harmonic", f"motion.frequency={frequency:g}", f"motion.amplitude={a * UNIT:.5g}",
                f"analysis.repeats={repeats}", "output.frames=0", *more)  # fmt: skip
    return found.answer


def said(answer: dict[str, Any]) -> str:
    """What became of an arch, in a cell."""
    if answer.get("collapsed") is None:
        return "no answer"
    if answer["collapsed"]:
        return f"collapses, {answer['collapse_time']:.1f} s"
    return f"stands, crown {1e3 * answer['crown']:.0f} mm lower"


def values(found: dict[str, Any]) -> dict[str, Any]:
    """What arch.md.j2 shows."""
    return _static(found) | _harmonic(found) | _variants(found)


def _static(found: dict[str, Any]) -> dict[str, Any]:
    thesis, rows = results("thesis_arch_shaking")["static_exp_num"]["value"], []
    for name, one in found["static"].items():
        ring, radius = map(float, name.split())
        load, mechanism = sum(one["failure_load_bracket"]) / 2, one["mechanism"]
        sliding = ", ".join(" on ".join(n.removeprefix("arch-") for n in joint)
                            for joint in mechanism["sliding_joints"]["first"]) or "none"  # fmt: skip
        rows.append((f"{ring:g}", f"{radius:g}", f"{load:.4f}", percent(load / thesis - 1.0), one["failure_mode"],
                     sliding, f"{mechanism['opening_joints']['count']}"))  # fmt: skip
    head = ("ring [m]", "inner radius [m]", "dem λ", "error", "mode", "joints that slide", "that open")
    shown = commands(found["static"]["0.08 0.2"], more=len(rows) - 1)
    return {"thesis": thesis, "static": table(head, rows), "static_command": shown}


def _harmonic(found: dict[str, Any]) -> dict[str, str]:
    thesis, rows = results("thesis_arch_shaking"), []
    for name, (frequency, a) in TRIED.items():
        repeats = found["perturbed"][name]["repeats"]
        falls = bool(thesis[name]["value"]) and name == "harm_25"
        theirs = "collapses" if falls else "stands, crown lower" if name == "harm_5_15" else "stands"
        ours = found["harmonic"][name]
        rows.append((f"{frequency:g} Hz, a = {a:g}", theirs, said(ours), f"{repeats['collapsed']} of {repeats['runs']}",
                     "yes" if ours["collapsed"] == falls else "**no**"))  # fmt: skip
    ladders = [
        (f"{rung['frequency']:g} Hz", *(_lowest(row[i]) for row in found["ladders"].values()))
        for i, rung in enumerate(found["ladders"]["0.6"])
    ]  # fmt: skip
    return {
        "harmonic": table(("motion", "thesis", "dem", "perturbed", "as the thesis"), rows),
        "ladders": table(("frequency", *(f"friction {friction}" for friction in found["ladders"])), ladders),
        "harmonic_commands": commands(*found["harmonic"].values()),
    }


def _lowest(rung: dict[str, Any]) -> str:
    return f"more than {LADDER[-1]:g}" if rung["a"] is None else f"{rung['a']:g}"


def _variants(found: dict[str, Any]) -> dict[str, str]:
    rows = [("**as the thesis**", *(said(one) for one in found["harmonic"].values()))]
    rows += [
        (f"ring {float(name.split()[0]):g} m, inner radius {float(name.split()[1]):g} m, λ = 0.325",
         *(said(one) for one in four.values()))
        for name, four in found["shapes"].items() if name != "0.08 0.2"
    ]  # fmt: skip
    for title, group in VARIANTS.items():
        rows.append((f"*{title}*", "", "", "", ""))
        rows += [(name, *(said(one) for one in found["variants"][name].values())) for name in group]
    heads = [f"{frequency:g} Hz, a = {a:g}" for frequency, a in TRIED.values()]
    shares = [
        (name, *(f"{one['repeats']['collapsed']} of {one['repeats']['runs']}" for one in four.values()))
        for name, four in found["margins"].items()
    ]
    return {
        "variants": table(("", *heads), rows),
        "shares": table(("", *heads), shares),
        "variant_commands": commands(next(iter(found["variants"].values()))["harm_25"], more=4 * len(rows)),
    }


def draw(found: dict[str, Any], path: Path) -> None:
    """Lowest collapses over frequency, beside what the thesis tried."""
    with style.figure(path, figsize=(6.4, 4.0)) as figure:
        axis = figure.subplots()
        for (friction, row), colour in zip(found["ladders"].items(), (style.THRUST, style.LIMIT)):
            known = [(r["frequency"], r["a"]) for r in row if r["a"] is not None]
            label = f"dem collapses from here, friction {friction}"
            axis.plot(*zip(*known), "o-", ms=6, lw=1.2, color=colour, label=label)
            beyond = [r["frequency"] for r in row if r["a"] is None]
            axis.plot(beyond, [LADDER[-1]] * len(beyond), "^", ms=8, color=colour)
        for name, (frequency, a) in TRIED.items():
            falls = name == "harm_25"
            axis.plot(frequency, a, "X" if falls else "s", ms=9, mfc="none" if not falls else style.COLLAPSE,
                      color=style.COLLAPSE if falls else style.INK)  # fmt: skip
        axis.plot([], [], "X", ms=9, color=style.COLLAPSE, label="thesis: collapses")
        axis.plot([], [], "s", ms=9, mfc="none", color=style.INK, label="thesis: stands")
        axis.set(xlabel="frequency [Hz]", ylabel="a = peak over 0.325 g", ylim=(0.4, 3.1), xticks=(2.5, 5, 7.5, 10))
        axis.legend(loc="upper left")


PICTURES = {"arch": draw}
