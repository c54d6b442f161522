"""The contract of an analysis kind."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from pydantic import Field

from dem_cli.case.base import CaseModel


@dataclass(frozen=True)
class Analysis:
    """A registered analysis.

    run(case, model, observer) -> Outcome; imported when called, so that listing kinds loads no solver.
    """

    kind: str
    parameters: type[CaseModel]
    load: Callable[[], Callable]


class AnalysisBase(CaseModel):
    """What every analysis accepts."""

    kinematics: Literal["auto", "fixed", "large"] = Field(
        default="auto",
        description="fixed: geometry of the start (exact for stiff joints); large: geometry that moves; auto chooses",
    )
    max_steps: int = Field(default=4_000_000, ge=1000, description="give up after so many solver steps")


class GravityAnalysis(AnalysisBase):
    """[analysis] with kind = "gravity": does the structure stand under its dead loads?"""

    kind: Literal["gravity"] = "gravity"


class LiveAnalysis(AnalysisBase):
    """What analyses with a live load accept: what the multiplier acts on."""

    direction: tuple[float, float] = Field(default=(1.0, 0.0), description="direction of the horizontal load")
    pattern: Literal["mass", "live", "tilt"] = Field(
        default="mass", description="mass: λ × weight of each block; live: λ × live loads; tilt: table turned by atan λ"
    )


class PushoverAnalysis(LiveAnalysis):
    """[analysis] with kind = "pushover": the load multiplier at which the structure fails."""

    kind: Literal["pushover"] = "pushover"
    resolution: float = Field(default=0.002, ge=1e-4, le=0.1, description="width of the bracket over the failure load")
    step: float | None = Field(
        default=None, gt=0.0, description="largest step of the multiplier on the way from gravity; default: they grow"
    )
    follow: float = Field(default=0.0, ge=0.0, description="follow the collapse until a block moved this far [m]")
    collapse: Literal["auto", "rate", "load"] = Field(
        default="auto",
        description="what is prescribed while the collapse is followed; rate: of displacement, the load is found; "
        "load: that of failure stays; auto: rate, or load where joints snap (a profile, bonds), as no rate can follow",
    )
    max_load: float | None = Field(
        default=None,
        gt=0.0,
        description="give up above this multiplier; default: live loads of 100 times the dead ones",
    )
    start: Literal["auto", "gravity", "path", "limit"] = Field(
        default="auto",
        description="how to come next to failure: gravity: raise the load step by step; path: static path of joints "
        "that do not dilate; limit: forces of limit analysis; auto: by the number of blocks",
    )
    limit: bool = Field(default=False, description="rigid-block limit analysis beside the failure load")


class CycleAnalysis(LiveAnalysis):
    """[analysis] with kind = "cycle": the load multiplier follows a path of given values, slowly, to and fro."""

    kind: Literal["cycle"] = "cycle"
    path: tuple[float, ...] = Field(min_length=1, description="load multipliers to go to one after the other, from 0")
    step: float = Field(gt=0.0, description="largest step of the multiplier; every one is a proven equilibrium")


class SettlementAnalysis(AnalysisBase):
    """[analysis] with kind = "settlement": supports move as [[settlement]] says."""

    kind: Literal["settlement"] = "settlement"


class TimeHistoryAnalysis(CaseModel):
    """[analysis] with kind = "time-history": the motion of the structure while its supports move."""

    kind: Literal["time-history"] = "time-history"
    duration: float | None = Field(default=None, gt=0.0, description="[s]; default: that of the motion")
    time_step: float | None = Field(
        default=None, gt=0.0, description="[s]; default: margin × the largest stable one of joints that all touch"
    )
    margin: float = Field(default=0.2, gt=0.0, le=0.95, description="time step over the largest stable one")
    settle: bool = Field(default=True, description="come to rest under dead loads first; false: start as drawn")
    fallen_deg: float = Field(default=60.0, gt=0.0, description="a block that turned by so much has collapsed")
    dropped: float | None = Field(
        default=None, gt=0.0, description="a block that sank by so much has collapsed [m]; default: its least width"
    )
    after_collapse: float = Field(default=0.5, ge=0.0, description="how long a collapse is followed [s]")
    max_steps: int = Field(default=200_000_000, ge=1000, description="give up rather than take so many steps")

    @property
    def kinematics(self) -> str:
        """Geometry always moves."""
        return "large"


class ModesAnalysis(AnalysisBase):
    """[analysis] with kind = "modes": natural frequencies, mode shapes, joint stiffness from a measured one."""

    kind: Literal["modes"] = "modes"
    count: int = Field(default=6, ge=1, le=200, description="number of natural frequencies, from the lowest")
    contacts: Literal["pressed", "touching"] = Field(
        default="pressed",
        description="which contact points are springs; pressed: those that gravity presses together, and bonds; "
        "touching: also those without a gap that carry nothing, such as dry head joints",
    )
    measured: float | None = Field(
        default=None, gt=0.0, description="measured natural frequency [Hz]: all kn and ks are scaled to meet it"
    )
    mode: int = Field(default=1, ge=1, le=200, description="number of the mode that the measured frequency belongs to")
