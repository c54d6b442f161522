"""Table [analysis] of the case file: one table per kind of analysis, and the contract of a kind."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, NonNegative, Positive, Vector
from dem_cli.case.tables.code_check import CodeCheck, Idealisation
from dem_cli.input_limits import LONGEST

Share = Annotated[float, Field(ge=0.0, le=0.2)]


@dataclass(frozen=True)
class Analysis:
    """Registered kind of analysis: its table, its solver and its documentation.

    run(case, model, observer, settings) -> Outcome, with `batch` besides where it consists of many runs; imported when
    called, so that listing kinds loads no solver.
    """

    kind: str
    parameters: type[CaseModel]
    load: Callable[[], Callable]


class AnalysisBase(CaseModel):
    """Keys that every analysis accepts."""

    kinematics: Literal["auto", "fixed", "large"] = Field(
        default="auto",
        description="fixed: geometry of the start (exact for stiff joints); large: geometry that moves; auto chooses",
    )
    max_steps: int = Field(default=4_000_000, ge=1000, description="give up after so many solver steps")


class GravityAnalysis(AnalysisBase):
    """[analysis] with kind = "gravity": does the structure stand under its dead loads?"""

    kind: Literal["gravity"] = "gravity"


class LiveAnalysis(AnalysisBase):
    """Keys of analyses with a live load that a load multiplier scales."""

    direction: Vector = Field(
        default=(1.0, 0.0),
        description="direction of the horizontal load, of a table the one towards which it tilts; its length does not "
        "matter [-]",
    )
    pattern: Literal["mass", "live", "tilt"] = Field(
        default="mass", description="mass: λ × weight of each block; live: λ × live loads; tilt: table turned by atan λ"
    )


class PushoverAnalysis(LiveAnalysis):
    """[analysis] with kind = "pushover": the load multiplier at which the structure fails."""

    kind: Literal["pushover"] = "pushover"
    resolution: float = Field(
        default=0.002, ge=1e-4, le=0.1, description="width of the bracket over the failure load [-]"
    )
    step: float | None = Field(
        default=None,
        gt=0.0,
        description="largest step of the multiplier on the way from gravity [-]; default: they grow",
        examples=[0.02],
    )
    follow: float = Field(
        default=0.0, ge=0.0, description="follow the collapse until a block moved this far [m]", examples=[0.02]
    )
    collapse: Literal["auto", "rate", "load"] = Field(
        default="auto",
        description="what is prescribed while the collapse is followed; rate: of displacement, the load is found; "
        "load: that of failure stays; auto: rate, or load where joints snap (a profile, bonds), as no rate can follow",
    )
    max_load: float | None = Field(
        default=None,
        gt=0.0,
        description="give up above this multiplier [-]; default: live loads of 100 times the dead ones",
        examples=[10.0],
    )
    start: Literal["auto", "gravity", "path", "limit"] = Field(
        default="auto",
        description="how to come next to failure: gravity: raise the load step by step; path: static path of joints "
        "that do not dilate; limit: forces of limit analysis, in equilibrium but maybe never reached; auto: gravity",
    )
    limit: bool = Field(default=False, description="rigid-block limit analysis beside the failure load")
    control: Literal["load", "displacement"] = Field(
        default="load",
        description="what grows: load: the multiplier, up to failure; displacement: that of the live load, at whose "
        "every step the multiplier is found, up to `follow`: the whole capacity curve, then the proof of its peak",
    )
    of: str | None = Field(
        default=None,
        description="control = 'displacement': name of the [[monitor]] whose displacement, with a component, is "
        "controlled; default: that of the live load",
        examples=["roof"],
    )
    increments: int = Field(
        default=100, ge=10, le=100_000, description="control = 'displacement': so many steps to `follow` at least"
    )
    idealise: Idealisation = Field(
        default=Idealisation(),
        description="control = 'displacement': the bilinear system of the curve, { secant, drop }; the Italian code "
        "takes 0.6 and 0.85",
    )
    loads_at: tuple[Positive, ...] = Field(
        default=(),
        description="control = 'displacement': displacements of the live load whose loads are wanted [m]",
        examples=[[0.001, 0.002]],
    )
    check: CodeCheck | None = Field(
        default=None,
        description="control = 'displacement', pattern = 'mass': the structure against a response spectrum, "
        "{ method, spectrum, ... }",
    )

    @model_validator(mode="after")
    def _a_way_to_go(self) -> PushoverAnalysis:
        if self.control == "displacement":
            if self.follow <= 0.0:
                raise KeyProblem("0 is not allowed with control = 'displacement': how far the curve goes [m]", "follow")
            refused = {"step": self.step is not None, "start": self.start not in ("auto", "gravity")}
            refused["collapse"] = self.collapse != "auto"
            for key in (key for key, given in refused.items() if given):
                raise KeyProblem("not allowed with control = 'displacement'", key)
            if self.check is not None and self.of is not None:
                raise KeyProblem("not allowed with 'of': it takes the displacement of the live load", "check")
            if self.check is not None and self.pattern != "mass":
                raise KeyProblem(f"not allowed with pattern = '{self.pattern}'; only with 'mass'", "check")
            return self
        of_curves = {"of": None, "increments": 100, "idealise": Idealisation(), "loads_at": (), "check": None}
        for key in (key for key, default in of_curves.items() if getattr(self, key) != default):
            raise KeyProblem("only allowed with control = 'displacement'", key)
        return self


class CycleAnalysis(LiveAnalysis):
    """[analysis] with kind = "cycle": the live load, or its displacement, follows a path of given values to and fro."""

    kind: Literal["cycle"] = "cycle"
    control: Literal["load", "displacement"] = Field(
        default="load",
        description="what the path is of: load: of multipliers; displacement: of displacements of the live load, at "
        "which the multiplier is found",
    )
    of: str | None = Field(
        default=None,
        description="control = 'displacement': name of the [[monitor]] whose displacement, with a component, is "
        "controlled; default: that of the live load",
        examples=["roof"],
    )
    path: tuple[float, ...] = Field(
        min_length=1,
        description="load multipliers [-], or displacements of the live load [m], to go to one after the other, from 0",
        examples=[[0.2, -0.2, 0.0]],
    )
    step: float = Field(
        gt=0.0,
        description="largest step of the multiplier [-] or displacement [m]; after every one all forces balance",
        examples=[0.02],
    )

    @model_validator(mode="after")
    def _what_is_controlled(self) -> CycleAnalysis:
        if self.of is not None and self.control == "load":
            raise KeyProblem("only allowed with control = 'displacement'", "of")
        return self


class SettlementAnalysis(AnalysisBase):
    """[analysis] with kind = "settlement": supports move as [[settlement]] says."""

    kind: Literal["settlement"] = "settlement"


class Perturbation(CaseModel):
    """analysis.perturb: relative standard deviations of what `repeats` change, each drawn from the seed of the case."""

    friction: Share = Field(default=0.02, description="of the friction coefficient, a factor per joint in [joints] [-]")
    geometry: Share = Field(
        default=0.001,
        description="of the size of blocks [-]: mass and centre of mass of each change as by such errors, and the "
        "ground leans by as many radians; joints stay closed",
    )
    motion: Share = Field(default=0.001, description="of the strength of the ground motion [-]")


class ShakingAnalysis(CaseModel):
    """Keys of analyses of structures under ground motion."""

    duration: Annotated[float, Field(le=LONGEST)] | None = Field(
        default=None, gt=0.0, description="time that is computed [s]; default: that of the motion", examples=[15.0]
    )
    time_step: float | None = Field(
        default=None,
        gt=0.0,
        description="of the integration [s]; default: margin × the largest stable one of joints that all touch",
        examples=[1e-4],
    )
    margin: float = Field(default=0.25, gt=0.0, le=0.95, description="time step over the largest stable one [-]")
    settle: bool = Field(default=True, description="come to rest under dead loads first; false: start as drawn")
    fallen_deg: float = Field(
        default=60.0,
        gt=0.0,
        description="a block that leans by so much has collapsed [deg]; turns about the vertical do not count",
    )
    dropped: float | None = Field(
        default=None,
        gt=0.0,
        description="a block that sank by so much has collapsed [m]; default: its least width, or 3 % of it where it "
        "lost its support",
        examples=[0.3],
    )
    max_steps: int = Field(default=200_000_000, ge=1000, description="give up rather than take so many steps")
    coda: NonNegative | None = Field(
        default=None,
        description="how long a structure that still moves after the motion is followed at most, to see whether it "
        "falls and how far it goes [s]; default: 5, or 20 √(H/2g) of a structure of height H where that is more",
        examples=[10.0],
    )
    repeats: int = Field(
        default=0, ge=0, le=10_000, description="runs of slightly different structures beside it", examples=[20]
    )
    perturb: Perturbation = Field(default=Perturbation(), description="how different: { friction, geometry, motion }")

    @property
    def kinematics(self) -> str:
        """Kinematics of time histories: always large displacements."""
        return "large"


class TimeHistoryAnalysis(ShakingAnalysis):
    """[analysis] with kind = "time-history": the motion of the structure while its supports move."""

    kind: Literal["time-history"] = "time-history"
    after_collapse: float = Field(default=0.5, ge=0.0, le=LONGEST, description="how long a collapse is followed [s]")


class FragilityAnalysis(ShakingAnalysis):
    """[analysis] with kind = "fragility": which intensities of a set of records the structure survives.

    Every record of an artificial suite and every other [[motion]] is one record of the set. Intensity is peak ground
    acceleration over unit_acceleration.
    """

    kind: Literal["fragility"] = "fragility"
    intensities: tuple[Positive, ...] | None = Field(
        default=None,
        min_length=1,
        description="levels to run [-], increasing: peak acceleration over unit_acceleration; or lowest, highest "
        "and resolution",
        examples=[[0.5, 1.0, 1.5, 2.0]],
    )
    lowest: Positive | None = Field(
        default=None, description="bisection between two intensities: the lower one [-]", examples=[0.5]
    )
    highest: Positive | None = Field(default=None, description="bisection: the higher intensity [-]", examples=[2.0])
    resolution: Positive | None = Field(
        default=None, description="bisection: how closely a collapse is found [-]", examples=[0.1]
    )
    search: Literal["grid", "bisection"] | None = Field(
        default=None,
        description="grid: every record at every level (default with intensities); bisection: per record only the runs "
        "that lead to one change from standing to collapse, which need not be the lowest",
        examples=["bisection"],
    )
    unit_acceleration: Positive = Field(default=1.0, description="peak acceleration at intensity 1 [m/s2]")
    confidence: float = Field(
        default=0.9, gt=0.0, lt=1.0, description="confidence level of the band around the curve [-]"
    )

    @model_validator(mode="after")
    def _levels_or_range(self) -> FragilityAnalysis:
        ends = {key: getattr(self, key) for key in ("lowest", "highest", "resolution")}
        given = [key for key, value in ends.items() if value is not None]
        if self.intensities is not None:
            if given:
                raise KeyProblem("not allowed beside intensities", given[0])
            for i in range(1, len(self.intensities)):
                if self.intensities[i] <= self.intensities[i - 1]:
                    raise KeyProblem(f"{self.intensities[i]:g} is not allowed; intensities increase", "intensities", i)
            return self
        if len(given) < len(ends):
            missing = next(key for key, value in ends.items() if value is None)
            raise KeyProblem("missing; give intensities, or lowest, highest and resolution", missing)
        if self.search == "grid":
            raise KeyProblem("'grid' needs intensities", "search")
        lowest, highest, resolution = self.range
        if not lowest < highest:
            raise KeyProblem(f"{highest:g} is not allowed; must be more than lowest", "highest")
        if resolution > highest - lowest:
            raise KeyProblem(f"{resolution:g} is not allowed; is more than highest − lowest", "resolution")
        return self

    @property
    def levels(self) -> tuple[float, ...]:
        """Intensities that were given, or the ends of the range."""
        return self.intensities or self.range[:2]

    @property
    def range(self) -> tuple[float, float, float]:
        """Lowest intensity, highest intensity and resolution of a case without a list of intensities."""
        assert self.lowest is not None
        assert self.highest is not None
        assert self.resolution is not None
        return self.lowest, self.highest, self.resolution

    @property
    def bisects(self) -> bool:
        """Tell whether intensities are searched by bisection, so that only some of the runs are done."""
        return self.intensities is None or self.search == "bisection"


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
        default=None,
        gt=0.0,
        description="measured natural frequency [Hz]: all kn and ks are scaled to meet it",
        examples=[10.0],
    )
    mode: int = Field(default=1, ge=1, le=200, description="number of the mode that the measured frequency belongs to")
