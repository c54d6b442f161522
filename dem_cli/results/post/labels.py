"""Axis labels: names of columns in words, with their units."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from difflib import get_close_matches
from typing import Any, NamedTuple

from dem_cli.errors import UsageError

Describe = Callable[[str], tuple[str, str]]  # a key of the case file -> its meaning and unit; "" where unknown


class Quantity(NamedTuple):
    """Physical quantity of a column, in words and with its unit."""

    words: str
    unit: str = ""

    def label(self, unit: str | None = None) -> str:
        """Return the axis label; `unit` where values are shown in another one."""
        shown = _UNITS.get(unit or self.unit, unit or self.unit)
        return f"{self.words} [{shown}]" if shown else self.words


_UNITS = {"m/s2": "m/s²", "kg/m3": "kg/m³", "-": "", "none": "", "N m": "N·m", "degrees": "°", "deg": "°"}
KNOWN_QUANTITIES = {
    "load": Quantity("load multiplier λ"),
    "displacement": Quantity("control displacement", "m"),
    "live_displacement": Quantity("displacement of the live load", "m"),
    "step": Quantity("solver step"),
    "time": Quantity("time", "s"),
    "unbalanced": Quantity("largest unbalanced force over the weight of its block"),
    "overlap": Quantity("largest overlap", "m"),
    "failure_load": Quantity("failure load multiplier λ"),
    "failure_mode": Quantity("failure mode"),
    "failure_load_bracket.0": Quantity("highest load in equilibrium λ"),
    "failure_load_bracket.1": Quantity("lowest load of failure λ"),
    "displacement_at_failure": Quantity("displacement at failure", "m"),
    "safety_factor": Quantity("factor of safety"),
    "critical_value": Quantity("critical value"),
    "collapse_time": Quantity("time of collapse", "s"),
    "collapsed": Quantity("collapsed"),
    "ending": Quantity("how it ended"),
    "followed": Quantity("time for which it was followed after the motion", "s"),
    "median": Quantity("median collapse intensity"),
    "dispersion": Quantity("dispersion of the collapse intensity"),
    "limit_analysis.associated": Quantity("associated limit load λ"),
    "limit_analysis.non_associated": Quantity("non-associated limit load λ"),
    "blocks": Quantity("number of blocks"),
    "joints": Quantity("number of joints"),
    "contacts": Quantity("number of contact points"),
    "steps": Quantity("number of steps"),
    "time_step": Quantity("time step", "s"),
    "energy_closure": Quantity("error of the energy balance over the energy moved"),
    "reweighting.net": Quantity("energy that changed with the areas of contact points", "J"),
    "reweighting.sum": Quantity("all amounts of energy that changed with the areas of contact points", "J"),
    "onset_of_displacements": Quantity("load at the onset of displacements λ"),
    "peak_of_curve": Quantity("largest load of the curve λ"),
    "settlement_at_collapse.share": Quantity("share of the settlement at collapse"),
    "fallen_blocks.count": Quantity("number of blocks that fell"),
    "joint_state.open": Quantity("number of open joints"),
    "after_collapse.open": Quantity("number of open joints after the collapse"),
    "friction_share": Quantity("share of the work done by friction"),
}
_JOINTS = {  # the largest of all joints
    "crack_width": Quantity("widest crack", "m"),
    "slip": Quantity("largest slip of a joint", "m"),
    "normal_stress": Quantity("largest compressive stress of a joint", "Pa"),
    "shear_stress": Quantity("largest shear stress of a joint", "Pa"),
}
_PARTS = {  # last words of a path inside a summary
    "residual": "last value", "time": "time of the peak", "value": "", "load": "load λ at the last value",
    "max": "largest value", "min": "smallest value", "max_time": "time of the largest value",
    "min_time": "time of the smallest value", "peak": "peak", "during_motion": "peak during the motion",
    "during_motion_time": "time of the peak during the motion",
}  # fmt: skip
_KEYS = {"density": "density", "thickness": "thickness"}  # where the meaning only paraphrases the word
_MOST_WORDS = 46  # letters of a meaning that still fits an axis


def of_output(name: str, units: Mapping[str, Any]) -> Quantity:
    """Describe a column of results by its path in the summary; `units`: values of the ".unit" columns."""
    if name in KNOWN_QUANTITIES:
        return KNOWN_QUANTITIES[name]
    if match := re.fullmatch(r"(joint_state|after_collapse)\.(\w+)\.value", name):
        known = _JOINTS.get(match[2], Quantity(match[2].replace("_", " ")))
        return known if match[1] == "joint_state" else known._replace(words=f"{known.words} after the collapse")
    if match := re.fullmatch(r"(peaks|monitors)\.(.+)\.(\w+)", name):
        _, monitor, part = match.groups()
        own = str(units.get(f"{match[1]}.{monitor}.unit", ""))
        unit = "s" if part.endswith("time") else "" if part in ("load", "unit") else own
        said = _PARTS.get(part, part)
        return Quantity(f"{monitor}, {said}" if said else monitor, unit)
    return Quantity(name.replace("_", " ").replace(".", ", "))


def of_key(key: str, describe: Describe | None) -> Quantity:
    """Describe a key of the case file, with the name given by the user, as in "friction (dry)"."""
    steps = [step.strip("\"'") for step in re.findall(r'"[^"]*"|[^.]+', key)]
    meaning, unit = describe(key) if describe else ("", "")
    meaning = re.split(r"[;:(,]| instead of ", meaning.replace(" tan(φ)", " tan φ"))[0].strip()
    meaning = _KEYS.get(steps[-1], meaning)
    words = meaning if 0 < len(meaning) <= _MOST_WORDS else steps[-1].replace("_deg", "").replace("_", " ")
    if steps[-1].endswith("_deg") and not unit:
        unit = "deg"
    owner = f" ({steps[1]})" if steps[0] in ("joints", "materials") and len(steps) > 2 else ""
    return Quantity(words + owner, unit)


def plain(name: str) -> str:
    """Normalise a typed name: capitals and underscores do not matter."""
    return name.lower().replace("_", " ").strip()


def nearest(name: str, names: list[str]) -> str | None:
    """Return the column that `name` means, or None."""
    if name in names:
        return name
    alike = [one for one in names if plain(one) == plain(name)]
    return alike[0] if len(alike) == 1 else None


def unknown(name: str, names: list[str]) -> UsageError:
    """Create the error of an unknown column, with the nearest name."""
    close = get_close_matches(plain(name), list(map(plain, names)), 1, 0.5)
    inside = [one for one in names if plain(name) in plain(one)]
    found = next((one for one in names if close and plain(one) == close[0]), inside[0] if inside else None)
    hint = f", did you mean '{found}'?" if found else ""
    return UsageError(f"no column '{name}'{hint} (--list shows all)")
