"""Table [motion]: ground motion of the supports. One table, or several [[motion]], which add up."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, ValidationInfo, field_validator, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, Name, NonNegative, Positive, Vector
from dem_cli.case.named_file import absolute_path, is_file, missing_file
from dem_cli.case.tables.spectrum import SpectrumTable
from dem_cli.core.motion.units import SI_FACTORS
from dem_cli.input_limits import LONGEST, MOST_CYCLES

if TYPE_CHECKING:
    from dem_cli.core.motion.eurocode_suites import Clause
    from dem_cli.core.motion.motion import Motion
    from dem_cli.core.motion.synthetic import ArtificialSuite

Unit = Literal["g", "m/s2", "cm/s2", "gal", "mm/s2", "m/s", "cm/s", "mm/s", "m", "cm", "mm"]
PULSES = {"frequency": ("sine", "cosine", "half-sine", "ricker"), "duration": ("impulse",)}


class MotionTable(CaseModel):
    """Keys of every kind of ground motion."""

    direction: Vector = Field(
        default=(1.0, 0.0), description="of positive values, in 3D any in space; its length does not matter [-]"
    )
    blocks: tuple[str, ...] = Field(
        default=(),
        description="ids of the fixed blocks that move, patterns, groups; default: all of them",
        examples=[["ground"]],
    )
    start: Annotated[NonNegative, Field(le=LONGEST)] = Field(default=0.0, description="time at which it begins [s]")
    event: Name | None = Field(
        default=None,
        description="fragility: name of the record that this is a component of; components of one event are scaled "
        "together, and its peak is that of the strongest; default: a record by itself",
        examples=["kobe"],
    )

    @model_validator(mode="after")
    def _has_direction(self) -> MotionTable:
        if not any(self.direction):
            zeros = ", ".join("0" for _ in self.direction)
            raise KeyProblem(f"[{zeros}] is not allowed; must point somewhere", "direction")
        return self


class PulseTable(MotionTable):
    """[motion] kind = "pulse": one cycle or one blow."""

    kind: Literal["pulse"] = "pulse"
    shape: Literal["sine", "cosine", "half-sine", "ricker", "impulse"] = Field(
        default="sine",
        description="one cycle of sine or cosine, half a cycle of sine, Ricker's wavelet, or a constant for a while",
    )
    amplitude: float = Field(description="peak acceleration of the base [m/s2]", examples=[3.0])
    frequency: Positive | None = Field(
        default=None, description="of the cycle [Hz]; of ricker, where its spectrum peaks", examples=[1.5]
    )
    duration: Positive | None = Field(default=None, description="of impulse: how long it lasts [s]", examples=[0.3])
    rebound: NonNegative = Field(
        default=0.0,
        description="of impulse: then −rebound · amplitude until the base stands still [-]; 0: it keeps its velocity",
        examples=[0.5],
    )

    @model_validator(mode="after")
    def _right_keys(self) -> PulseTable:
        _some(self.amplitude, "amplitude")
        needed = next(key for key, shapes in PULSES.items() if self.shape in shapes)
        other = "duration" if needed == "frequency" else "frequency"
        if getattr(self, needed) is None:
            raise KeyProblem(f"missing; shape = '{self.shape}' needs it: a number > 0", needed)
        if getattr(self, other) is not None:
            raise KeyProblem(f"not allowed with shape = '{self.shape}', which has a {needed}", other)
        if self.rebound and self.shape != "impulse":
            raise KeyProblem(f"not allowed with shape = '{self.shape}'; only 'impulse' has one", "rebound")
        return self


class HarmonicTable(MotionTable):
    """[motion] kind = "harmonic": a sine of the given length."""

    kind: Literal["harmonic"] = "harmonic"
    amplitude: float = Field(description="peak acceleration of the base [m/s2]", examples=[2.0])
    frequency: Positive = Field(description="of the sine [Hz]", examples=[2.0])
    cycles: Positive | None = Field(default=None, description="number of cycles [-]", examples=[10.0])
    duration: Positive | None = Field(
        default=None, description="instead of cycles: how long it lasts [s]", examples=[5.0]
    )
    phase_deg: float = Field(
        default=0.0, description="of the sine at the start [deg]; 90: a cosine, after which the base has not drifted"
    )
    ramp: NonNegative = Field(
        default=0.0, description="cycles over which it rises at the start and falls at the end [-]", examples=[2.0]
    )

    @model_validator(mode="after")
    def _one_length(self) -> HarmonicTable:
        _some(self.amplitude, "amplitude")
        if (self.cycles is None) == (self.duration is None):
            found = "'cycles' and 'duration' are" if self.cycles else "neither 'cycles' nor 'duration' is"
            raise ValueError(f"{found} given; a harmonic motion has one of them")
        if self.length > LONGEST:
            raise KeyProblem(f"{self.length:g} s is not allowed; at most {LONGEST:g} s", self._says_length)
        if self.length * self.frequency > MOST_CYCLES:
            message = f"{self.length * self.frequency:.3g} cycles are not allowed; at most {MOST_CYCLES:,}"
            raise KeyProblem(message, self._says_length)
        if 2.0 * self.ramp > self.length * self.frequency * (1.0 + 1e-9):
            most = 0.5 * self.length * self.frequency
            raise KeyProblem(f"{self.ramp:g} is not allowed; must be at most half of all cycles, {most:g}", "ramp")
        return self

    @property
    def _says_length(self) -> str:
        """Key that sets the duration of the harmonic: duration or cycles."""
        return "duration" if self.cycles is None else "cycles"

    @property
    def length(self) -> float:
        """Duration of the harmonic motion [s]."""
        if self.cycles is not None:
            return self.cycles / self.frequency
        assert self.duration is not None
        return self.duration


class RecordTable(MotionTable):
    """[motion] kind = "record": a measured accelerogram, or one computed elsewhere."""

    kind: Literal["record"] = "record"
    file: Annotated[str, Field(min_length=1)] = Field(
        description="columns of time [s] and value (CSV), or a PEER file (AT2); relative paths start at the case file",
        examples=["record.csv"],
    )
    quantity: Literal["acceleration", "velocity", "displacement"] = Field(
        default="acceleration", description="what the values are"
    )
    unit: Unit | None = Field(
        default=None,
        description="of the values; may be left out where the file says it: AT2, a header like `acceleration [g]`",
        examples=["g"],
    )
    scale: float | None = Field(default=None, description="factor on the values [-]; default: 1", examples=[1.2])
    peak: Positive | None = Field(
        default=None, description="instead of scale: the peak acceleration wanted [m/s2]", examples=[3.0]
    )
    baseline: bool | Annotated[int, Field(ge=0, le=3)] = Field(
        default=False, description="take out a polynomial of this order of the acceleration; true: 1"
    )
    step: Positive | None = Field(
        default=None, description="time step of a file that has values only [s]", examples=[0.01]
    )
    column: Annotated[int, Field(ge=1)] | Literal["all"] | None = Field(
        default=None,
        description="number of the column of values, from 1; may be left out when there is no choice; 'all' beside "
        "step: values go on from line to line, several in each",
        examples=[2],
    )
    uneven: bool = Field(default=False, description="time steps that differ are meant; no gaps are looked for")

    @field_validator("file")
    @classmethod
    def _absolute(cls, file: str, info: ValidationInfo) -> str:
        return absolute_path(file, info)

    @model_validator(mode="after")
    def _consistent(self) -> RecordTable:
        if self.scale is not None and self.peak is not None:
            raise ValueError("'scale' and 'peak' are given; a record has one of them, or none")
        if self.scale == 0.0:
            raise KeyProblem("0 is not allowed; must be another number", "scale")
        units = SI_FACTORS[self.quantity]
        if self.unit is not None and self.unit not in units:
            allowed = ", ".join(f"'{unit}'" for unit in units)
            raise KeyProblem(f"'{self.unit}' is not a unit of {self.quantity} (allowed: {allowed})", "unit")
        if not is_file(Path(self.file)):
            raise KeyProblem(missing_file(Path(self.file), "a record"), "file")
        return self

    @property
    def baseline_order(self) -> int | None:
        """Order of the polynomial of the baseline correction; None: no correction."""
        return (1 if self.baseline else None) if isinstance(self.baseline, bool) else self.baseline


class ArtificialTable(SpectrumTable, MotionTable):
    """[motion] kind = "artificial": accelerograms generated to fit a response spectrum."""

    kind: Literal["artificial"] = "artificial"
    duration: Positive = Field(default=20.0, description="how long each record lasts [s]")
    rise: Positive = Field(default=2.0, description="how long it grows [s], with the square of time")
    plateau: Positive = Field(default=10.0, description="how long it stays strong [s]; Eurocode 8 wants 10 s")
    time_step: Positive = Field(default=0.01, description="time between samples [s]")
    count: Annotated[int, Field(ge=1, le=1000)] = Field(default=1, description="number of records in the suite")
    number: Annotated[int, Field(ge=1)] = Field(default=1, description="which of them a time history uses, from 1")
    iterations: Annotated[int, Field(ge=0, le=200)] = Field(default=12, description="corrections towards the spectrum")
    seed: Annotated[int, Field(ge=0)] | None = Field(
        default=None, description="of the random phases; default: the seed of the case", examples=[7]
    )
    first_period: Positive | None = Field(
        default=None,
        description="T1 of the structure [s]: Eurocode 8 judges a suite from 0.2 T1 to 2 T1",
        examples=[0.4],
    )
    scale: float = Field(default=1.0, description="factor on the finished records [-]")

    @model_validator(mode="after")
    def _consistent(self) -> ArtificialTable:
        _some(self.scale, "scale")
        if self.number > self.count:
            raise KeyProblem(f"{self.number} is not allowed; must be at most count = {self.count}", "number")
        if self.rise + self.plateau > self.duration:
            unsaid = [name for name in ("rise", "plateau") if name not in self.model_fields_set]
            room = f"rise + plateau = {self.rise + self.plateau:g} s is longer than that"
            if unsaid:
                values = " and ".join(f"{name} = {getattr(self, name):g}" for name in unsaid)
                room += f" ({values} where the case gives none: shorten them too)"
            raise KeyProblem(f"{self.duration:g} s is not allowed; {room}", "duration")
        if self.time_step > self.duration / 100.0 or self.time_step > 0.02:
            most = min(0.02, self.duration / 100.0)
            raise KeyProblem(f"{self.time_step:g} s is not allowed; must be at most {most:g}", "time_step")
        if self.duration / self.time_step > 200_000:
            raise KeyProblem(f"{self.time_step:g} s is not allowed; that makes more than 200,000 samples", "time_step")
        return self

    @property
    def asked(self) -> ArtificialSuite:
        """Parameters of the artificial accelerograms to be generated."""
        from dem_cli.core.motion.synthetic import ArtificialSuite

        times = (self.duration, self.rise, self.plateau, self.time_step)
        return ArtificialSuite(self.target, *times, self.count, self.iterations)

    def judged(self, motions: Sequence[Motion]) -> list[Clause]:
        """Check a suite of accelerograms against the clauses of Eurocode 8."""
        from dem_cli.core.motion.eurocode_suites import DAMPING, clauses

        known, strength = isinstance(self.spectrum, str) or self.damping == DAMPING, abs(self.scale)
        elastic = self.model_copy(update={"damping": DAMPING}).target.scaled(strength) if known else None
        return clauses(motions, self.plateau, self.target.scaled(strength), elastic, self.first_period)


class NoMotion(MotionTable):
    """[motion] kind = "none": supports rest."""

    kind: Literal["none"] = "none"


MOTIONS: dict[str, type[MotionTable]] = {
    "pulse": PulseTable,
    "harmonic": HarmonicTable,
    "record": RecordTable,
    "artificial": ArtificialTable,
    "none": NoMotion,
}


def _some(value: float, key: str) -> None:
    if value == 0.0:
        raise KeyProblem("0 is not allowed; must be another number (kind = 'none' is no motion)", key)
