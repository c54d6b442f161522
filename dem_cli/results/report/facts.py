"""Answer, soundness and model of a report page in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from dem_cli.analysis_kinds import kind_of
from dem_cli.core.model.model import Model
from dem_cli.core.model.scales import DOUBTFUL_CLOSURE, DOUBTFUL_OVERLAP, DOUBTFUL_REWEIGHTING, smallest_edge
from dem_cli.results.output.ending import ending_words, median_words, unfound_load
from dem_cli.results.output.paraview.vertices import size_in_words
from dem_cli.results.output.reader import Results
from dem_cli.results.post import style

BALANCED = 1e-5  # unbalanced force over the block's own weight that core/statics/equilibrium.py accepts
GOOD, LOOK, BAD = "good", "look", "bad"
_MOST_IN_LIST = 12  # values of a list that the table of all numbers shows


class Headline(NamedTuple):
    """Headline of a report page."""

    label: str
    value: str
    more: str  # how sure, and how it fails
    tone: str  # GOOD, LOOK or BAD


class SoundnessCheck(NamedTuple):
    """Soundness check of a run."""

    name: str
    value: str
    tone: str  # "" where it says nothing by itself
    words: str  # what is good


def answer(summary: Mapping[str, Any]) -> Headline:
    """Return the headline of a run of any kind; a run that did not end well says so."""
    status = str(summary.get("status", "unfinished"))
    tone = GOOD if status == "ok" else BAD
    found = (_ANSWERS.get(str(summary.get("kind"))) or _status)(summary)
    if status != "ok" and found[1] != status:
        found = (found[0], found[1], "; ".join(filter(None, (status, found[2]))))
    return Headline(*found, tone)


def _status(summary: Mapping[str, Any]) -> tuple[str, str, str]:
    status = str(summary.get("status", "unfinished"))
    moved = summary.get("largest_displacement")
    more = "" if moved is None else f"largest displacement {_metres(moved)}"
    return ("result", _ENDS.get(str(summary.get("kind")), status) if status == "ok" else status, more)


def _load(summary: Mapping[str, Any]) -> tuple[str, str, str]:
    load, bracket = summary.get("failure_load"), summary.get("failure_load_bracket")
    if load is None:
        turns = summary.get("turning_points")
        loads = [turn["load"] for turn in turns or ()]
        if loads:
            ends = f"{min(loads):.4g} … {max(loads):.4g}".replace("-", "−")
            return ("load multiplier", ends, "followed the load path without failure")
        known = unfound_load(summary)
        return ("failure load λ", "not found", known) if known else _status(summary)
    more = f"between {bracket[0]:.4f} and {bracket[1]:.4f}" if bracket and None not in bracket else ""
    mode = str(summary.get("failure_mode") or "").replace("mixed", "sliding and rocking")
    return ("failure load λ", f"{load:.4f}", ", ".join(filter(None, (more, mode and f"failure by {mode}"))))


def _limit(summary: Mapping[str, Any]) -> tuple[str, str, str]:
    loads = summary.get("limit_analysis") or {}
    found = {name.replace("_", "-"): loads[name] for name in ("non_associated", "associated") if loads.get(name)}
    if not found:
        return _status(summary)
    more = ", ".join(f"{name} {load:.4f}" for name, load in found.items())
    return ("failure load λ", f"{next(iter(found.values())):.4f}", more)


def _shaken(summary: Mapping[str, Any]) -> tuple[str, str, str]:
    how = ending_words(summary)
    if not how:
        return _status(summary)
    peaks = summary.get("peaks") or {}
    more = [
        f"{name}: peak {_value(found['peak'], found['unit'])}"
        for name, found in list(peaks.items())[:1]
        if found["peak"] is not None
    ]
    ground = summary.get("peak_ground_acceleration")
    more += [] if ground is None else [f"peak ground acceleration {ground:.3g} m/s²"]
    return ("result", how, ", ".join(more))


def _fragile(summary: Mapping[str, Any]) -> tuple[str, str, str]:
    median, records = summary.get("median"), f"{len(summary.get('collapse_intensities') or ())} records"
    if summary.get("median_between"):
        return ("half collapse", median_words(summary), f"levels do not resolve it, {records}")
    if median is None:
        return ("half collapse at", "no median", str(summary.get("status", "")))
    sure = summary.get("confidence")
    more = f"dispersion {summary['dispersion']:.2g}"
    if sure:
        more += f", {100 * sure['level']:.0f} % confidence {sure['median'][0]:.4g} to {sure['median'][1]:.4g}"
    unit = summary.get("unit_acceleration", 1.0)
    more += f", {records}"
    if unit == 1.0:
        return ("half collapse at", f"{median:.4g} m/s²", more)
    return ("half collapse at intensity", f"{median:.4g}", f"{median * unit:.3g} m/s², {more}")


def _modes(summary: Mapping[str, Any]) -> tuple[str, str, str]:
    found = summary.get("frequencies")
    if not found:
        return _status(summary)
    more = f"highest {summary['highest_frequency']:.4g} Hz" if summary.get("highest_frequency") else ""
    return ("first frequency", f"{found[0]:.4g} Hz", f"{len(found)} modes" + (f", {more}" if more else ""))


def _safety(summary: Mapping[str, Any]) -> tuple[str, str, str]:
    strength = summary.get("vary") == "strength"
    value = summary.get("safety_factor" if strength else "critical_value")
    stands, fails = summary.get("stands_at"), summary.get("fails_at")
    label = "factor of safety" if strength else f"critical {summary.get('vary', 'value')}"
    pairs = (("stands", stands), ("fails", fails))
    more = ", ".join(f"{word} at {number:.5g}" for word, number in pairs if number is not None)
    return (label, "none found" if value is None else f"{value:.4g}", more)


_ENDS = {"gravity": "stands", "settlement": "followed to the end"}  # what status "ok" means
_ANSWERS = {
    "pushover": _load, "cycle": _load, "limit": _limit, "time-history": _shaken, "fragility": _fragile, "modes": _modes,
    "safety": _safety,
}  # fmt: skip


def audit(summary: Mapping[str, Any], results: Results | None) -> list[SoundnessCheck]:
    """Check how far a run can be trusted, with the criteria in plain words."""
    status = str(summary.get("status", "unfinished"))
    checks = [SoundnessCheck("status", status, GOOD if status == "ok" else BAD, "“ok”: the analysis reached its end.")]
    closure = summary.get("energy_closure")
    if closure is not None:
        tone = GOOD if abs(closure) <= DOUBTFUL_CLOSURE else BAD
        words = "What the loads put in is stored, moving or lost to friction and damping; "
        words += f"good below {DOUBTFUL_CLOSURE:.0%}."
        checks.append(SoundnessCheck("energy that is missing", f"{abs(closure):.2g} of the largest entry", tone, words))
    checks += _reweighting(summary, results)
    overlap = summary.get("largest_overlap")
    if overlap is not None and results is not None:
        share = overlap / smallest_edge(results.model)
        hit = kind_of(summary.get("kind")).timed  # blocks that fall sink in for a moment
        tone = GOOD if share <= DOUBTFUL_OVERLAP else LOOK if hit else BAD
        text = f"{_metres(overlap)}, {share:.2g} of the smallest edge"
        words = (
            f"Stone does not sink into stone; good below {DOUBTFUL_OVERLAP:.0%}{', but for blocks that fall' * hit}."
        )
        checks.append(SoundnessCheck("largest overlap", text, tone, words))
    if summary.get("certificates"):
        words = "What of the answer others can check from results.h5 without this program: docs/certificates.md."
        checks.append(SoundnessCheck("certificates", str(summary["certificates"]), "", words))
    return checks + _balance(summary, results)


def _reweighting(summary: Mapping[str, Any], results: Results | None) -> list[SoundnessCheck]:
    """Check the energy change by reweighted areas of contact points, where blocks move in space."""
    found = summary.get("reweighting")
    if not found or results is None or not len(results.history.get("step", ())):
        return []
    entries = ["kinetic"] if kind_of(summary.get("kind")).timed else list(results.energy)
    largest = max(float(np.abs(results.energy[name]).max()) for name in entries)
    if largest <= 0.0:
        return []
    share = max(abs(found["net"]), found["sum"]) / largest
    of = "the largest kinetic energy" if entries == ["kinetic"] else "the largest entry"
    words = "Blocks that slide over each other change the areas of their contact points, which takes or makes energy; "
    text = f"{share:.2g} of {of}, net {found['net'] / largest:.2g}".replace("-", "−")
    tone = GOOD if share <= DOUBTFUL_REWEIGHTING else LOOK
    return [SoundnessCheck("energy of changing areas", text, tone, f"{words}good below {DOUBTFUL_REWEIGHTING:.0%}.")]


def _balance(summary: Mapping[str, Any], results: Results | None) -> list[SoundnessCheck]:
    """Check the equilibrium under self-weight, the start of every static analysis, and that of the last state."""
    checks = []
    words = f"Largest force on a block that nothing balances, over its own weight; at rest below {BALANCED:.0e}."
    if results is not None and len(results.history.get("stage", ())):
        rows = np.flatnonzero(results.history["stage"] == "gravity")
        if len(rows):
            value = float(results.history["unbalanced"][rows[-1]])
            tone = GOOD if value <= BALANCED else LOOK
            checks.append(SoundnessCheck("unbalanced under own weight", f"{value:.1g}", tone, words))
    last = summary.get("unbalanced_force")
    if last is not None and (not checks or f"{last:.1g}" != checks[0].value):
        falls = summary.get("failure_load") is not None or summary.get("kind") == "safety"
        tone = GOOD if last <= BALANCED else ""
        moving = "The last state is one of failure: blocks move, and forces need not balance." if falls else words
        checks.append(SoundnessCheck("unbalanced in the end", f"{last:.1g}", tone, moving))
    return checks


def model_rows(model: Model, summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    """List size, mass and numbers of the model."""
    free = ~model.fixed
    depth = sorted({f"{value:.3g}" for value in model.thickness[free].tolist()}, key=float)
    held = int(model.restrained.any(axis=1).sum())
    restrained = f", {held:,} with motions that are held" if held else ""
    rows = [
        ("blocks", f"{model.n_blocks:,}, {int(model.fixed.sum()):,} of them fixed{restrained}"),
        ("joints", f"{summary['joints']:,}, {summary['contacts']:,} contact points" if "contacts" in summary else "–"),
        ("size", f"{size_in_words(model)} (free blocks)"),
        ("mass", f"{float(model.masses[free].sum()):.6g} kg (free blocks)"),
    ]
    if model.dimension == 2 and depth:
        rows.append(("thickness", f"{depth[0]} m" if len(depth) == 1 else f"{depth[0]} to {depth[-1]} m"))
    for i, name in enumerate(model.material_names):
        own = free & (model.block_material == i)
        if own.any():
            rows.append((f"material “{name}”", f"{int(own.sum()):,} blocks, {float(model.masses[own].sum()):.6g} kg"))
    return rows


def all_numbers(summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    """List everything in summary.json by its path; long lists are counted, not listed."""
    found: list[tuple[str, str]] = []

    def walk(path: str, value: Any) -> None:
        if isinstance(value, Mapping):
            for key, item in value.items():
                walk(f"{path}.{key}" if path else str(key), item)
        elif isinstance(value, list) and any(isinstance(item, (Mapping, list)) for item in value[:_MOST_IN_LIST]):
            for i, item in enumerate(value[:_MOST_IN_LIST]):
                walk(f"{path}.{i}", item)
            if len(value) > _MOST_IN_LIST:
                found.append((path, f"… {len(value)} in all, see summary.json"))
        else:
            found.append((path, _listed(value) if isinstance(value, list) else written(value)))

    walk("", summary)
    return found


def _listed(values: Sequence[Any]) -> str:
    shown = ", ".join(map(written, values[:_MOST_IN_LIST]))
    return shown + (f", … {len(values)} in all" if len(values) > _MOST_IN_LIST else "") or "none"


def written(value: Any) -> str:
    """Format a value as in summary.json: every digit of a number."""
    if isinstance(value, bool) or value is None:
        return {True: "true", False: "false", None: "–"}[value]
    return str(value)


def _metres(value: float) -> str:
    factor, unit = style.length_unit(abs(value))
    return f"{factor * value:.3g} {unit}"


def _value(value: float | None, unit: str) -> str:
    if value is None:
        return "–"
    return (_metres(value) if unit == "m" else f"{value:.3g} {unit}").replace("-", "−", value < 0)
