"""Profile of a barrel or groin vault: the arch of its section, and the head joints along its courses."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import ValidationError

from dem_cli.case.base import KeyProblem
from dem_cli.masonry.structures.arch import SHAPE_JOINTS, Arch
from dem_cli.masonry.structures.vaults.table import Vault

NAMES = {"ring": "thickness", "columns": "piers", "inner_radius": "span"}  # of an arch: of a vault


def arch_of(vault: Vault, **others: Any) -> Arch:
    """Create the plane arch of a vault's section. Raises KeyProblem with the key of the vault."""
    half = vault.span / 2.0 if vault.span else 0.0
    given: dict[str, Any] = {"voussoirs": vault.voussoirs, "ring": vault.thickness} | others
    if vault.included_angle_deg is not None:
        angle = np.radians(vault.included_angle_deg) / 2.0
        given |= {"inner_radius": float(half / np.sin(angle)), "included_angle_deg": vault.included_angle_deg}
    elif vault.rise is None:
        given |= {"inner_radius": half}
    else:
        given |= {"shape": "pointed" if vault.rise > half else "segmental", "span": vault.span, "rise": vault.rise}
    try:
        return Arch.model_validate(given)
    except ValidationError as error:
        problem = error.errors()[0].get("ctx", {}).get("error")
        if not isinstance(problem, KeyProblem):
            raise
        raise KeyProblem(str(problem), *(NAMES.get(str(key), key) for key in problem.keys)) from None


def symmetric_joints(arch: Arch) -> np.ndarray:
    """Return the joints [inner, outer] of an arch, (voussoirs + 1, 2, 2), symmetric to the last bit.

    The right half is as drawn; the left one is its mirror image.
    """
    right = SHAPE_JOINTS[arch.shape](arch)[-(arch.voussoirs // 2 + 1) :]
    left = right[::-1] * [-1.0, 1.0]
    return np.concatenate([left[: (arch.voussoirs + 1) // 2], right])


def heads_along(length: float, stone: float, shift: float) -> np.ndarray:
    """Return the head joints of a course from 0 to its length; the first stone is `shift` long, where not 0.

    Pieces shorter than a quarter of a stone join their neighbour.
    """
    inner = shift + stone * np.arange(int(np.ceil(length / stone)) + 1)
    least = stone / 4.0 * (1.0 - 1e-9)
    return np.concatenate([[0.0], inner[(inner >= least) & (inner <= length - least)], [length]])


def side_of_crown(course: int, number: int, count: int) -> str:
    """Return the row of a voussoir by its course and its number from 1 of `count`: "" except next to a crown joint.

    There the uppermost courses of both sides have the same number and meet in a bed: rows "left" and "right".
    """
    if 2 * course != count:
        return ""
    return "left" if number == course else "right"
