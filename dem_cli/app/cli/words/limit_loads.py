"""Loads of limit analysis in words: lower and upper bounds, and their accuracy."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from dem_cli.app.cli.words.numbers import load_text, seconds

LEAST_OF = {  # what is known of other collapse states
    "all": "of all collapse states of joints that do not dilate",
    "local": "a local least: no collapse state that differs in up to {changed} openings and slips is lower",
    "some": "a collapse state of joints that do not dilate; others may lie lower",
}


WEDGED = "head joints dilate in it and wedge: out of plane such a bound can be several times too high"
SLIGHT = 0.01  # of the load: what head joints may take before this is said


def wedged(limits: Mapping[str, Any]) -> bool:
    """Test whether friction of dilating head joints carries some of the associated load, in space."""
    return (limits.get("associated_head_friction") or 0.0) > SLIGHT


def limit_rows(limits: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return label and text of each load, from the highest to the lowest; `limit_analysis` of a summary."""
    return [*_associated(limits), *_path(limits), *_least(limits), *_lower(limits), *_hand_check(limits)]


def _associated(limits: Mapping[str, Any]) -> list[tuple[str, str]]:
    if limits["associated"] is None:
        in_space = "associated_head_friction" in limits and limits["associated_status"].startswith("no load")
        return [("associated", f"{limits['associated_status']}, if joints dilate as they slide")] if in_space else []
    low, high = limits["associated_bounds"]
    how = f"upper bound, between {low:.7g} and {high:.7g}, {seconds(limits['seconds'])}"
    rows = [("associated", f"{load_text(limits['associated'])}  ({how})")]
    return [*rows, ("", WEDGED)] if wedged(limits) else rows


def _path(limits: Mapping[str, Any]) -> list[tuple[str, str]]:
    status, spent = limits.get("non_associated_status"), float(limits.get("non_associated_seconds") or 0.0)
    if limits.get("non_associated") is not None:
        how = f"{_smoothed(limits)}residual {limits['non_associated_residual']:.1g} W, {seconds(spent)}"
        if (rest := limits.get("non_associated_first_plateau")) is not None:
            how = f"rests at {load_text(rest)} on the way, {how}"
        final = limits.get("non_associated_final_load")
        if final is not None and final < 0.98 * limits["non_associated"]:
            unseen = "in the first increment, so that its peak is between two loads, " * _at_once(limits)
            how = f"highest load of a path that drops to {load_text(final)} then, {unseen}{how}"
        return [("non-associated", f"{load_text(limits['non_associated'])}  ({how})")]
    if limits.get("non_associated_at_least") is not None:
        at_least = load_text(limits["non_associated_at_least"])
        return [("non-associated", f"at least {at_least}  ({_smoothed(limits)}{status}, {seconds(spent)})")]
    return [("non-associated", str(status))] if str(status).startswith("not looked for") else []


def _smoothed(limits: Mapping[str, Any]) -> str:
    """Describe the smoothing of friction along the path, used for large structures."""
    return "smoothed path: an estimate, " if limits.get("non_associated_smoothing") else ""


def _at_once(limits: Mapping[str, Any]) -> bool:
    """Test whether the load of a path was highest after its first increment from gravity."""
    return limits.get("non_associated_highest_increment") == 1


def _least(limits: Mapping[str, Any]) -> list[tuple[str, str]]:
    known, proved = limits.get("least_of"), limits.get("least_proved")
    if known is None:
        return []
    how = LEAST_OF.get(known, "").format(changed=limits["least_changed"])
    if known == "local" and not limits["least_changed"]:
        how = "a local least: no opening or slip that it leaves open leads lower"
    if known == "all":
        how += f", at rates up to {limits['least_rates']:g}"
        how += "" if limits["least_forces_bounded"] else " and forces up to 20 times all loads"
    if proved is not None and known != "all":
        how = f"{how}; none at all below {load_text(proved)}".removeprefix("; ")
    spent = f"{limits['least_nodes']:,} nodes, {seconds(limits['least_seconds'])}"
    if limits["least"] is None:
        return [("least", f"no collapse state was found  ({', '.join(filter(None, (how, spent)))})")]
    return [("least", f"{load_text(limits['least'])}  ({how}; {spent})")]


def _lower(limits: Mapping[str, Any]) -> list[tuple[str, str]]:
    if "lower_bound" not in limits:
        return []
    rows = []
    if limits["reduced_domain"]:
        how = "reduced domain: lower bound of joints that keep their cohesion where they open"
        rows.append(("reduced", f"{load_text(limits['reduced_domain'])}  ({how})"))
    if limits["lower_bound"] is None:
        return [*rows, ("lower bound", str(limits["lower_bound_status"]))]
    how = f"joints that do not dilate collapse at no lower load, {seconds(limits['lower_bound_seconds'])}"
    return [*rows, ("lower bound", f"{load_text(limits['lower_bound'])}  ({how})")]


def _hand_check(limits: Mapping[str, Any]) -> list[tuple[str, str]]:
    if limits.get("rigid_wall") is None:
        return []
    return [("hand check", f"{load_text(limits['rigid_wall'])}  (a rigid part turns about the toe; no bound)")]
