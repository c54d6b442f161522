"""Responses of a contact point driven along displacement paths, as lines of diagrams."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from dem_cli.case.tables.declared import table_of
from dem_cli.core.laws.displacement_path import PathResponse, drive
from dem_cli.core.laws.law import Law
from dem_cli.core.laws.registry import LAWS


class Graph(NamedTuple):
    """A line, or points with their scatter."""

    x: Any
    y: Any
    label: str = ""
    colour: str = "blue"
    dash: str = "-"
    width: float = 1.8
    arrows: tuple[float, ...] = ()  # where its direction is shown, as shares of its points
    points: bool = False
    scatter: Any = None


class Panel(NamedTuple):
    """One diagram."""

    title: str
    x: str
    y: str
    lines: Sequence[Graph]
    log: bool = False
    legend: str = "best"


class LawPage(NamedTuple):
    """What is said of a law beside its own words."""

    law: Law
    keys: dict[str, Any]  # of the table in the example and in the picture
    kn: float  # [Pa/m]
    ks: float
    panels: Callable[[LawPage], list[Panel]]
    numbers: Callable[[], dict[str, str]] = dict  # for the {{names}} in notes/NAME.md
    chosen: str = ""  # in a case file; by default: law = "name"

    @property
    def name(self) -> str:
        return self.law.name

    @property
    def key(self) -> str:
        """`law` in a case file."""
        return self.law.name if self.law.name in LAWS else "coulomb"

    def along(self, path: Any, **options: Any) -> PathResponse:
        """A point of 1 m² moved along a path: forces are stresses."""
        keys = self.keys | options.pop("keys", {})
        table = table_of(LAWS[self.key].parameters).model_validate({"law": self.key, **keys})
        return drive(LAWS[self.key], table, path, kn=self.kn, ks=self.ks, **options)


def through(*corners: Sequence[float], n: int = 400) -> np.ndarray:
    """Straight from corner to corner."""
    shares = np.arange(1, n + 1)[:, None] / n
    return np.concatenate([np.asarray(a) + np.subtract(b, a) * shares for a, b in zip(corners, corners[1:])])


def slid(
    page: LawPage, stress: float, *slides: float, n: int = 400, keys: dict | None = None, **options: Any
) -> tuple[Any, Any, PathResponse]:
    """Slide [m], shear stress against it [Pa], everything; under a normal stress [Pa], slid from place to place."""
    gap = -stress / page.kn
    done = page.along(through((0.0, 0.0), (gap, 0.0), *[(gap, s) for s in slides], n=n), keys=keys or {}, **options)
    return done.path[n - 1 :, 1], -done.shear[n - 1 :, 0], done


def three_paths(page: LawPage, stress: float, far: float, title: str, millimetres: bool = False) -> Panel:
    """Shear under a normal stress [Pa]: one way up to `far` [m], with unloading, and reversed."""
    length, unit = (1e3, "mm") if millimetres else (1e6, "µm")
    lines = []
    for slides, label, colour, dash, width, arrows in (
        ((0.7 * far, -far, far), "reversed", "grey", "-", 4.0, (0.3, 0.6, 0.9)),
        ((far,), "one way", "blue", "-", 1.8, ()),
        ((0.5 * far, 0.5 * far - 0.7 * back(page, stress), 0.7 * far), "unloaded", "red", "--", 1.8, ()),
    ):
        slide, shear, _ = slid(page, stress, *slides)
        lines.append(Graph(slide * length, shear * 1e-3, label, colour, dash, width, arrows))
    return Panel(title, f"slide [{unit}]", "shear stress [kPa]", lines, legend="lower right")


def back(page: LawPage, stress: float) -> float:
    """Slide in which the shear stress of a sliding point is unloaded [m], about."""
    return 0.6 * stress / page.ks


def pulled(page: LawPage, *gaps: float, n: int = 400, **options: Any) -> tuple[Any, Any, PathResponse]:
    """Gap [m], normal stress, compression positive [Pa], everything; moved from gap to gap."""
    done = page.along(through((0.0, 0.0), *[(gap, 0.0) for gap in gaps], n=n), **options)
    return done.path[:, 0], done.normal, done
