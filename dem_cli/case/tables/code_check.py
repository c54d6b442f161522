"""Tables analysis.idealise and analysis.check: bilinear capacity curve, and its check against a response spectrum."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, Positive
from dem_cli.case.tables.spectrum import SpectrumTable

Part = Annotated[float, Field(gt=0.0, lt=1.0)]
OF_METHOD = {"n2": ("corner",), "mechanism": ("confidence", "behaviour")}


class Idealisation(CaseModel):
    """analysis.idealise: the bilinear system of a capacity curve, of the same energy."""

    secant: Part = Field(default=0.7, description="share of the peak through which its elastic branch goes [-]")
    drop: Part = Field(default=0.8, description="share of the peak at which the curve ends, behind the peak [-]")


class CodeCheck(SpectrumTable):
    """analysis.check: the structure on its capacity curve against a response spectrum, as codes ask for it."""

    method: Literal["n2", "mechanism"] = Field(
        default="n2",
        description="n2: the bilinear system against the spectrum (EN 1998-1, annex B); mechanism: activation "
        "acceleration and displacement of a local mechanism on the ground (circular 617/2009, C8A.4)",
    )
    shape: Literal["first", "peak", "end", "uniform"] | None = Field(
        default=None,
        description="how the masses move: as at the first increment, at the peak or at the end of the curve, or all "
        "alike; default: peak, of a mechanism end",
        examples=["first"],
    )
    corner: Positive | None = Field(
        default=None, description="n2: T_C of a spectrum given as a list [s]; Eurocode 8 has its own", examples=[0.5]
    )
    confidence: Annotated[float, Field(ge=1.0, le=2.0)] | None = Field(
        default=None, description="mechanism: confidence factor FC [-]; default: 1", examples=[1.35]
    )
    behaviour: Annotated[float, Field(ge=1.0, le=10.0)] | None = Field(
        default=None, description="mechanism: behaviour factor q of the linear check [-]; default: 2", examples=[2.0]
    )

    @model_validator(mode="after")
    def _keys_of_its_method(self) -> CodeCheck:
        for method, keys in OF_METHOD.items():
            for key in keys:
                if method != self.method and getattr(self, key) is not None:
                    raise KeyProblem(f"only allowed with method = '{method}'", key)
        listed = not isinstance(self.spectrum, str)
        if self.method == "n2" and listed and self.corner is None:
            raise KeyProblem("missing; must be a number > 0: T_C of a spectrum given as a list [s]", "corner")
        if self.corner is not None and not listed:
            raise KeyProblem(f"not allowed beside spectrum = '{self.spectrum}', which has its own", "corner")
        return self
