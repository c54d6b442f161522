"""Tops of walls: gables, sloped or stepped, and profiles; the masonry of the courses below them."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from dem_cli.case.base import CaseModel, KeyProblem, Pair, Positive, check_count
from dem_cli.core.geometry import cuts, polygon

Profile = np.ndarray  # the top from left to right, (n, 2) [m]


class Gable(CaseModel):
    """Gable: a triangle of masonry on top of a wall."""

    height: Positive = Field(description="from the top of the courses to the ridge [m]", examples=[1.5])
    ridge: Positive | None = Field(
        None, description="of the ridge, from the left end of the wall [m]; default: in the middle", examples=[2.5]
    )
    edges: Literal["cut", "stepped"] = Field(
        "cut", description="cut: along the slopes; stepped: courses end where half of their height is under the slope"
    )


def gable_profile(gable: Gable, start: float, end: float, foot: float) -> Profile:
    """Return the outline of a gable over a wall whose courses end at the level `foot` [m], (3, 2)."""
    ridge = (start + end) / 2.0 if gable.ridge is None else gable.ridge
    return np.array([[start, foot], [ridge, foot + gable.height], [end, foot]])


def with_gable(levels: np.ndarray, gable: Gable, course: float) -> np.ndarray:
    """Add the bed joints of a gable in courses of that height [m]: up to its ridge or above; stepped: below it."""
    count = gable.height / course
    check_count(count, "gable", "height")
    whole = int(np.floor(count + 1e-6)) if gable.edges == "stepped" else int(np.ceil(count - 1e-6))
    return np.concatenate([levels, levels[-1] + course * np.arange(1, max(1, whole) + 1)])


def level_span(profile: Profile, level: float) -> tuple[float, float]:
    """Return both ends of the masonry below a gable at a level [m]."""
    (x0, foot), (ridge, top), (x1, _) = profile.tolist()
    share = min(max((level - foot) / (top - foot), 0.0), 1.0)
    return (x0 + share * (ridge - x0), x1 + share * (ridge - x1))


def cuts_off(profile: Profile, shape: np.ndarray, gap: float) -> bool:
    """Test whether a part of a convex polygon wider than `gap` [m] lies above a profile."""
    left = sum(polygon.area(piece) for piece in below(shape, profile, gap))
    return left < polygon.area(shape) - gap * polygon.size(shape)


def stops(profile: Profile, low: float, high: float) -> list[float]:
    """Return the places where a profile has corners in a course, or meets one of its bed joints [m]."""
    found = [x for x, y in profile.tolist() if low <= y <= high]
    for (x0, y0), (x1, y1) in zip(profile[:-1].tolist(), profile[1:].tolist(), strict=True):
        found += [x0 + (y - y0) / (y1 - y0) * (x1 - x0) for y in (low, high) if (y0 < y) != (y1 < y)]
    return found


def below(shape: np.ndarray, profile: Profile, gap: float) -> list[np.ndarray]:
    """Cut a convex polygon to the part below a profile, in convex pieces; beside its ends the profile is level."""
    low, high = shape[:, 0].min(), shape[:, 0].max()
    inner = profile[(profile[:, 0] > low) & (profile[:, 0] < high)]
    tops = [*np.interp([low, high], *profile.T), *inner[:, 1]]
    if shape[:, 1].max() <= min(tops) + gap:
        return [shape]
    found, rest = [], shape
    corners = [[low, tops[0]], *inner.tolist(), [high, tops[1]]]
    for start, end in zip(corners[:-1], corners[1:], strict=True):
        upright = np.array([end[0], end[1] + 1.0])
        piece, rest = cuts.halves(rest, np.array(end), upright, gap) if end[0] < high else (rest, cuts.NOTHING)
        found.append(cuts.halves(piece, np.array(start), np.array(end), gap)[1])
    return [piece for piece in found if len(piece)]


def check_profile(profile: tuple[Pair, ...], length: float, height: float) -> None:
    """Raise KeyProblem where a profile does not fit the top of a wall of that length and height [m]."""
    if len(profile) < 2:
        raise KeyProblem("a profile has at least two points", "profile")
    ends = ((0, 0.0, "0, the left end"), (len(profile) - 1, length, f"{length:g}, the right end"))
    for i, x, what in ends:
        if abs(profile[i][0] - x) > 1e-6 * length:
            raise KeyProblem(f"x = {profile[i][0]:g} is not allowed; must be {what} of the wall", "profile", i)
    for i, (x, y) in enumerate(profile):
        if i and x <= profile[i - 1][0]:
            raise KeyProblem(f"x = {x:g} is not allowed; points go from left to right", "profile", i)
        if not 0.0 < y <= height * (1.0 + 1e-6):
            raise KeyProblem(
                f"y = {y:g} is not allowed; must be above 0 and at most {height:g}, the top of the courses",
                "profile",
                i,
            )
