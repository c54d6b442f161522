"""Record classes allowed in a checkpoint, by name, and the types of their fields.

A class that is not named here is neither kept nor made. One is made without a call of it, from fields that are looked
at first. Its module is imported when a checkpoint holds one: names alone point from here to where the solvers are.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from dem_cli.registration import Registered

_PLACES = {
    "analyses.bound_beside": ("Carried",),
    "core.contact.caps": ("Caps",),
    "core.contact.chains": ("Chains",),
    "core.contact.joints": ("JointArrays",),
    "core.contact.start": ("CornerMeetings",),
    "core.dynamics.coda": ("Ending", "Swings"),
    "core.dynamics.collapse_criterion": ("CollapsedBlock",),
    "core.dynamics.extremes": ("Extremes",),
    "core.dynamics.snapshots": ("EvenTimes", "Intervals"),
    "core.engine.loads": ("ActingForces",),
    "core.engine.measures": ("EnergySums", "Moment", "Touching"),
    "core.engine.placement.clearances": ("Play",),
    "core.engine.settings": ("DetectionSettings",),
    "core.engine.state": ("Books", "Carriers", "SavedState"),
    "core.engine.tracking": ("JointTracking",),
    "core.kernels.fixed_joints": ("FixedJoints",),
    "core.kernels.records": (
        "Bodies", "BlockShapes", "Contacts", "Dampers", "Loads", "MovingJoints", "PlanarGeometry", "SpatialGeometry",
        "SpatialMotion", "StrainRates",
    ),
    "core.kernels.tiles.joint_tiles": ("JointTiles",),
    "core.limit.associated": ("LimitLoad",),
    "core.limit.path": ("Path",),
    "core.links.bar": ("Bars",),
    "core.links.tie": ("Ties",),
    "core.model.following_loads": ("FollowingLoads",),
    "core.model.model": ("Model",),
    "results.output.resume.stages": ("_Checkpoint", "_Outcome"),
    "core.records.frames": ("ContactRecord", "Frame", "LinkPlaces", "LinkRecord"),
    "core.records.history_rows": ("Energy", "HistoryRow", "RunRow", "Samples"),
    "core.statics.displacement_control": ("CurvePoint",),
    "core.statics.equilibrium": ("Verdict",),
    "core.statics.failure_test": ("FailureTest",),
    "core.statics.hysteresis": ("PathState",),
    "core.statics.implicit_history": ("HeldState", "Level", "LoadHistory"),
    "core.statics.post_peak": ("CurvePeak",),
}  # fmt: skip
RECORDS: Registered[type] = Registered(
    {name: (f"dem_cli.{module}", name) for module, names in _PLACES.items() for name in names}
)
_NUMBERS = (int, float, np.number, np.bool_)
_TAKES: dict[str, tuple[type, ...]] = {  # by the word of an annotation; any other word takes anything
    "np.ndarray": (np.ndarray,),
    "float": _NUMBERS,
    "int": _NUMBERS,
    "bool": _NUMBERS,
    "str": (str,),
    "None": (type(None),),
    "tuple": (tuple,),
    "list": (list,),
    "dict": (dict,),
}


class Field(NamedTuple):
    """Types that a field accepts."""

    kinds: tuple[type, ...]
    items: tuple[type, ...] | None  # of which all items of a list or a tuple are; None: anything

    def takes(self, value: Any) -> bool:
        """Test whether the field accepts a value."""
        if self.items is not None and isinstance(value, (tuple, list)):
            return isinstance(value, self.kinds) and all(isinstance(each, self.items) for each in value)
        return isinstance(value, self.kinds)


def unfit(of: type, fields: Mapping[Any, Any]) -> str | None:
    """Describe what is wrong with the fields of a record; None: nothing."""
    annotated = _annotated(of)
    for name, value in fields.items():
        if not isinstance(name, str) or callable(getattr(of, name, None)) or name.startswith("__"):
            return f"{name!r} is no field"
        if name in annotated and not annotated[name].takes(value):
            return f"{name} may not be a {type(value).__name__}"
    missing = annotated.keys() - fields.keys()
    return f"{sorted(missing)[0]} is missing" if missing else None


@cache
def _annotated(of: type) -> dict[str, Field]:
    """Return the annotated fields of a class and its bases whose types are known."""
    found = {}
    for base in reversed(of.__mro__):
        for name, annotation in vars(base).get("__annotations__", {}).items():
            said = getattr(annotation, "__forward_arg__", str(annotation))
            kinds = [_kinds(word) for word in said.split("|")]
            if "ClassVar" not in said and all(kinds):
                found[name] = Field(tuple(each for kind in kinds for each in kind), _items(said))
    return found


def _kinds(word: str) -> tuple[type, ...]:
    """Return the classes that a word of an annotation means; none where that is not known."""
    name = word.partition("[")[0].strip()
    return _TAKES.get(name) or ((RECORDS[name],) if name in RECORDS else ())


def _items(annotation: str) -> tuple[type, ...] | None:
    """Return the item types of a plain list or tuple: list[float], tuple[str, ...]."""
    found = re.fullmatch(r"(?:list\[|tuple\[)([\w.]+)(?:, \.\.\.)?\]", annotation)
    return (_kinds(found[1]) or None) if found else None
