"""Records that may stand in a checkpoint: the classes, by the names that they have there, and what their fields take.

A class that is not named here is neither kept nor made. One is made without a call of it, from fields that are looked
at first.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np

from dem_cli.registration import Registered

_PLACES = {
    "contact.caps": ("Caps",),
    "contact.chains": ("Chains",),
    "contact.joints": ("JointArrays",),
    "dynamics.coda": ("Ending", "Swings"),
    "dynamics.collapse_criterion": ("CollapsedBlock",),
    "dynamics.snapshots": ("EvenTimes", "Intervals"),
    "engine.measures": ("EnergySums",),
    "engine.placement.clearances": ("Play",),
    "engine.settings": ("DetectionSettings",),
    "engine.state": ("Books", "SavedState"),
    "engine.tracking": ("JointTracking",),
    "kernels.fixed_joints": ("FixedJoints",),
    "kernels.records": (
        "Bodies", "BlockShapes", "Contacts", "Dampers", "Loads", "MovingJoints", "PlanarGeometry", "SpatialGeometry",
        "SpatialMotion", "StrainRates",
    ),
    "kernels.tiles.joint_tiles": ("JointTiles",),
    "limit.associated": ("LimitLoad",),
    "limit.path": ("Path",),
    "links.bar": ("Bars",),
    "links.tie": ("Ties",),
    "model.following_loads": ("FollowingLoads",),
    "model.model": ("Model",),
    "output.record": (
        "ContactRecord", "Energy", "Frame", "HistoryRow", "LinkPlaces", "LinkRecord", "RunRow", "Samples",
    ),
    "output.resume.stages": ("_Checkpoint", "_Outcome"),
    "statics.displacement_control": ("CurvePoint",),
    "statics.equilibrium": ("Verdict",),
    "statics.failure_test": ("FailureTest",),
    "statics.hysteresis": ("PathState",),
    "statics.post_peak": ("CurvePeak",),
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


def unfit(of: type, fields: Mapping[Any, Any]) -> str | None:
    """What is wrong with the fields of such a record; None: nothing."""
    takes = _annotated(of)
    for name, value in fields.items():
        if not isinstance(name, str) or callable(getattr(of, name, None)) or name.startswith("__"):
            return f"{name!r} is no field"
        if name in takes and not isinstance(value, takes[name]):
            return f"{name} is no {' or '.join(each.__name__ for each in takes[name])}"
    missing = takes.keys() - fields.keys()
    return f"{sorted(missing)[0]} is missing" if missing else None


@cache
def _annotated(of: type) -> dict[str, tuple[type, ...]]:
    """What the annotated fields of a class take, those of its bases too; no field of which that is not known."""
    found = {}
    for base in reversed(of.__mro__):
        for name, annotation in vars(base).get("__annotations__", {}).items():
            words = [word.partition("[")[0].strip() for word in str(annotation).split("|")]
            if all(word in _TAKES or word in RECORDS for word in words):
                found[name] = tuple(kind for word in words for kind in _TAKES.get(word) or (RECORDS[word],))
    return found
