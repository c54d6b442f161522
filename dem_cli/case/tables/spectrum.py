"""Keys of a response spectrum: elastic ones of Eurocode 8, or a list of periods and accelerations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, field_validator, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, NonNegative, Positive

if TYPE_CHECKING:
    from dem_cli.core.motion.eurocode import TargetSpectrum

Period = tuple[NonNegative, Positive]  # period [s], acceleration [m/s2]
EC8_KEYS = ("soil", "ag")


class SpectrumTable(CaseModel):
    """Keys of every table that specifies a response spectrum."""

    spectrum: Literal["EC8-1", "EC8-2"] | Annotated[tuple[Period, ...], Field(min_length=2)] = Field(
        description="elastic spectrum of Eurocode 8, type 1 or 2, or a list of [period [s], acceleration [m/s2]]",
        examples=["EC8-1"],
    )
    soil: Literal["A", "B", "C", "D", "E"] | None = Field(
        default=None, description="ground type of Eurocode 8", examples=["B"]
    )
    ag: Positive | None = Field(
        default=None, description="ground acceleration on rock [m/s2], with Eurocode 8", examples=[3.0]
    )
    damping: Annotated[float, Field(gt=0.0, lt=1.0)] = Field(
        default=0.05, description="damping ratio that the spectrum is for [-]"
    )

    @field_validator("spectrum")
    @classmethod
    def _rising_periods(cls, spectrum: str | tuple[Period, ...]) -> str | tuple[Period, ...]:
        if isinstance(spectrum, tuple):
            for i in range(1, len(spectrum)):
                if spectrum[i][0] <= spectrum[i - 1][0]:
                    raise KeyProblem(f"{spectrum[i][0]:g} is not allowed; periods increase", i, 0)
        return spectrum

    @model_validator(mode="after")
    def _keys_of_its_spectrum(self) -> SpectrumTable:
        for key in EC8_KEYS:
            if isinstance(self.spectrum, str) and getattr(self, key) is None:
                raise KeyProblem(f"missing; spectrum = '{self.spectrum}' needs it", key)
            if not isinstance(self.spectrum, str) and getattr(self, key) is not None:
                raise KeyProblem("not allowed beside a spectrum given as a list", key)
        return self

    @property
    def target(self) -> TargetSpectrum:
        """Response spectrum given by name or as a list."""
        from dem_cli.core.motion.eurocode import eurocode, listed

        if isinstance(self.spectrum, str):
            assert self.soil is not None
            assert self.ag is not None
            return eurocode(self.spectrum, self.soil, self.ag, self.damping)
        return listed(self.spectrum, self.damping)
