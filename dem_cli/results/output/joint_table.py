"""Write joints.csv: every joint as drawn, with its opening, crack width, slip and stress in one frame."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from dem_cli.core.arithmetic import functions
from dem_cli.core.records.frames import STATES
from dem_cli.errors import UsageError
from dem_cli.results.output.atomic_file import whole
from dem_cli.results.output.csv_cells import cell
from dem_cli.results.output.layout import JOINT_STATES
from dem_cli.results.output.reader import JointHistory, Results

JOINTS_TABLE = "joints.csv"
PLACES = ("steepness [deg]", "length [m]", "area [m2]")


def joints_of(results: Results) -> JointHistory:
    """Return the joints of a run. Raises UsageError where it kept none."""
    if results.joints is None:
        raise UsageError(
            "the results hold no joints: the run kept no frames (output.frames = 0), or an earlier version made it"
        )
    return results.joints


def steepness(joints: JointHistory) -> np.ndarray:
    """Compute the angle of each joint to the horizontal [rad], (n,): 0 of a bed joint, π/2 of a head joint."""
    normals = np.abs(joints.places.normals)
    return functions.arctan2(np.hypot.reduce(normals[:, :-1], axis=1), normals[:, -1])


def write_joints(results: Results, frame: int, path: Path) -> Path:
    """Write one line per joint at a frame, by its number, with units in the first line, exactly. Raises DemError."""
    joints = joints_of(results)
    places, states = joints.places, joints.at(frame)
    middle = places.middles().T
    numbers = [*middle, np.degrees(steepness(joints)), places.length, places.area]
    measured = {name: said.units for name, said in JOINT_STATES.items() if name != "state"}
    numbers += [getattr(states, name) for name in measured]
    coordinates = [f"{axis} [m]" for axis in "xyz"[: len(middle)]]
    named = [f"{name.replace('_', ' ')} [{unit}]" for name, unit in measured.items()]
    head = ["block a", "block b", *coordinates, *PLACES, *named, "state"]
    names = results.model.block_ids
    with whole(path) as part, part.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(head)
        for pair, row, state in zip(places.blocks, np.column_stack(numbers).tolist(), states.state, strict=True):
            table.writerow([*(cell(names[block]) for block in pair), *row, STATES[state]])
    return path
