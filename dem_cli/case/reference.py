"""Table [reference]: the expected value of an answer, its source, its tolerance; or what is predicted of it, blind."""

from __future__ import annotations

from typing import Annotated, Any, Literal, cast

from pydantic import Field, PrivateAttr, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, NonNegative, Pair, Positive
from dem_cli.case.tolerance_rules import ReferenceKind, allowance, kind_of
from dem_cli.case.wording import show

Loads = tuple[float, ...]  # of a curve
Word = Annotated[str, Field(min_length=1)]
BLIND = "blind"  # kind of what is predicted before it is measured
CURVE = "capacity_curve"  # quantity of the summary that is one
NO_TOLERANCE = "missing; must be a number > 0 (largest difference that passes), as a share of 0 is nothing"


class Reference(CaseModel):
    """[reference], or several [[reference]]: the expected value of an answer, with its tolerance."""

    failure_load: NonNegative | None = Field(
        default=None, description="expected load multiplier at failure [-]", examples=[0.64]
    )
    quantity: Word | None = Field(
        default=None,
        description="instead of failure_load: path of a number, word or truth in summary.json",
        examples=["peaks.top displacement.peak"],
    )
    value: bool | float | Pair | Loads | Word | None = Field(
        default=None,
        description="of the quantity: a number, [lowest, highest], a word or a truth; of a curve its loads [unit of "
        "the quantity]",
        examples=[0.012],
    )
    displacements: tuple[float, ...] | None = Field(
        default=None,
        min_length=2,
        description="quantity = 'capacity_curve': displacements of the live load that the loads belong to, "
        "increasing [m]",
        examples=[[0.001, 0.002, 0.005]],
    )
    tolerance: Positive | None = Field(
        default=None,
        description="largest difference that passes [unit of the quantity], of a curve the mean one; default: by the "
        "rule of its kind",
        examples=[0.001],
    )
    relative: Positive | None = Field(
        default=None, description="instead of tolerance: its share of the value [-]", examples=[0.01]
    )
    reason: Word | None = Field(
        default=None,
        description="why the tolerance is not that of the rule, or of kind 'blind' whence the error of the model; "
        "`dem verify` prints it",
        examples=["the reference leaves out the thickness of the hinge"],
    )
    kind: ReferenceKind = Field(
        default="exact",
        description="where the value comes from: exact (mechanics), bounded (an interval of mechanics; so is an exact "
        "one), experiment, another code's answer, or inference: an input of this case was inferred from it, or chosen "
        "by it, so that it proves nothing; blind: predicted before it is measured",
    )
    scatter: Positive | None = Field(
        default=None,
        description="of an experiment: standard deviation of repeated tests [unit of the quantity]; two of them pass "
        "where 'specimens' are at least 4",
        examples=[0.0137],
    )
    specimens: Annotated[int, Field(ge=2)] | None = Field(
        default=None,
        description="of an experiment: how many tests 'scatter' is of [-]; below 4, or not given, 5 % pass",
        examples=[10],
    )
    source: str = Field(
        default="", description="where the value comes from, in words", examples=["closed form: slides at tan φ"]
    )
    missed: Word | None = Field(
        default=None,
        description="why the value is known to be missed; fails as soon as it is met",
        examples=["the test had wedges under its first course"],
    )
    model: Pair | None = Field(
        default=None,
        description="of kind 'blind': least and largest measured value over the computed one, less 1 [-], as in "
        "similar cases that are validated; [0, 0] where the question is one of mechanics alone; `reason` says whence",
        examples=[[-0.05, 0.1]],
    )
    measured_in: Word | None = Field(
        default=None,
        description="of kind 'blind': where the measured value stands; added with `value`, after the prediction",
        examples=["Table 4, mean of four specimens"],
    )
    _resolution: float | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _one_form(self) -> Reference:
        if self.kind == BLIND:
            self._check_blind()
            return self
        for key in (key for key in ("model", "measured_in") if getattr(self, key) is not None):
            raise KeyProblem(f"only allowed of kind '{BLIND}'", key)
        if (self.failure_load is None) == (self.quantity is None):
            neither = self.quantity is None
            found = "neither 'failure_load' nor 'quantity' is" if neither else "'failure_load' and 'quantity' are both"
            raise ValueError(f"{found} given; a reference has 'failure_load', or 'quantity' and 'value'")
        if self.quantity is None and self.value is not None:
            raise KeyProblem(f"{show(self.value)} is not allowed beside 'failure_load'", "value")
        if self.quantity is not None and self.value is None:
            raise KeyProblem("missing; must be a number, a list of 2 numbers, a string, true or false", "value")
        self._check_curve()
        self._check_tolerance()
        interval = isinstance(self.value, tuple) and self.displacements is None
        if self.kind == "bounded" and not interval:
            raise KeyProblem("'bounded' is not allowed of one value; value = [lowest, highest] is missing", "kind")
        object.__setattr__(self, "kind", cast(ReferenceKind, kind_of(self.kind, interval)))
        return self

    def _check_blind(self) -> None:
        """Check a prediction's question: it has no value before it is measured, and states the error of the model."""
        if self.quantity is None:
            raise KeyProblem("missing; of kind 'blind' it says what is predicted, such as 'failure_load'", "quantity")
        refused = ("failure_load", "displacements", "tolerance", "relative", "scatter", "specimens", "missed")
        for key in (key for key in refused if getattr(self, key) is not None):
            raise KeyProblem(f"not allowed of kind '{BLIND}'; what passes is the band of its prediction", key)
        if isinstance(self.value, (bool, str, tuple)):
            raise KeyProblem(
                f"{show(self.value)} is not allowed; what is measured of kind 'blind' is a number", "value"
            )
        if (self.value is None) != (self.measured_in is None):
            key = "value" if self.value is None else "measured_in"
            raise KeyProblem("missing; a measured value has 'value' and 'measured_in'", key)
        if self.model is None or self.reason is None:
            key = "model" if self.model is None else "reason"
            raise KeyProblem("missing; 'model' is the error of the model [lowest, highest], 'reason' says whence", key)
        if not -1.0 < self.model[0] <= self.model[1]:
            raise KeyProblem(f"{show(self.model)} is not allowed; must be [lowest, highest], above -1", "model")

    def _check_curve(self) -> None:
        loads, places = self.value, self.displacements
        if (places is not None) != (self.quantity == CURVE):
            if places is not None:
                raise KeyProblem(f"only allowed with quantity = '{CURVE}'", "displacements")
            raise KeyProblem(
                "missing; must be a list of numbers: where the loads of the curve are [m]", "displacements"
            )
        if places is None:
            if isinstance(loads, tuple) and len(loads) != 2:
                raise KeyProblem(f"{len(loads)} numbers are not allowed; must be [lowest, highest]", "value")
            return
        if not isinstance(loads, tuple) or len(loads) != len(places):
            raise KeyProblem(f"must be a list of {len(places)} numbers, one for each of 'displacements'", "value")
        for i in range(1, len(places)):
            if places[i] < places[i - 1]:
                raise KeyProblem(f"{places[i]:g} is not allowed; displacements increase", "displacements", i)
        if max(loads) <= 0.0:
            raise KeyProblem("loads above 0 are missing; errors are shares of the largest", "value")

    def _check_tolerance(self) -> None:
        given = [key for key in ("tolerance", "relative") if getattr(self, key) is not None]
        if len(given) == 2:
            raise KeyProblem(f"{show(self.relative)} is not allowed beside 'tolerance'", "relative")
        value = self.expected
        if isinstance(value, tuple) and self.displacements is None and value[0] >= value[1]:
            raise KeyProblem(f"{show(value)} is not allowed; must be [lowest, highest]", "value")
        if isinstance(self.expected, (bool, str)):
            extra = [*given, *(("scatter",) if self.scatter is not None else ())]
            if extra:
                raise KeyProblem(
                    f"{show(getattr(self, extra[0]))} is not allowed; words and truths have none", extra[0]
                )
        elif self.expected == 0.0 and self.relative is not None:
            raise KeyProblem(f"{show(self.relative)} is not allowed; a share of 0 is nothing", "relative")
        elif self.expected == 0.0 and not given and self.scatter is None:
            raise KeyProblem(NO_TOLERANCE, "tolerance")
        self._check_words(given)

    def _check_words(self, given: list[str]) -> None:
        if self.specimens is not None and self.scatter is None:
            raise KeyProblem(
                f"{self.specimens} is not allowed without 'scatter', their standard deviation", "specimens"
            )
        if self.scatter is not None and self.kind != "experiment":
            raise KeyProblem(f"{show(self.scatter)} is not allowed; only an experiment has a scatter", "scatter")
        if self.scatter is not None and given:
            raise KeyProblem(f"{show(self.scatter)} is not allowed beside '{given[0]}'", "scatter")
        if self.reason is not None and not given:
            raise KeyProblem(f"{show(self.reason)} is not allowed without 'tolerance' or 'relative'", "reason")

    def resolved_to(self, resolution: float | None) -> None:
        """Set the relative resolution of loads and factors of the analysis; None: it has none."""
        self._resolution = resolution

    @property
    def path(self) -> str:
        """Path of the compared quantity in summary.json."""
        return self.quantity or "failure_load"

    @property
    def expected(self) -> bool | float | Pair | Loads | Word:
        """Expected value of the compared quantity, from failure_load or value."""
        value = self.failure_load if self.quantity is None else self.value
        assert value is not None
        return float(value) if isinstance(value, int) and not isinstance(value, bool) else value

    @property
    def allowance(self) -> float | None:
        """Absolute tolerance of the comparison, in the unit of the quantity; None for text."""
        if isinstance(self.expected, (bool, str)):
            return None
        bounds = self.expected if isinstance(self.expected, tuple) else (self.expected,)
        if self.displacements is not None:  # the difference that counts is a mean one, its size that of the peak
            bounds = (max(bounds),)
        if self.tolerance is not None:
            return self.tolerance
        if self.relative is not None:
            return self.relative * max(map(abs, bounds))
        return allowance(self.kind, self.path, bounds, self.scatter, self.specimens, self._resolution)


class Alternative(CaseModel):
    """[[alternative]]: other values of keys with which a blind case is predicted as well; other commands ignore it."""

    of: Literal["input", "numerical"] = Field(
        default="input",
        description="what the difference that it makes belongs to: input: the source gives a range or is silent; "
        "numerical: contact points, steps, stiffness of the solver's choice",
    )
    why: Word = Field(
        description="what is not known, and where the values come from",
        examples=["friction is not given; sawn granite has 0.5 to 0.8"],
    )
    set: dict[str, Any] = Field(
        min_length=1,
        description="keys of the case and their values, as `--set` takes them",
        examples=[{"joints.dry.friction": 0.5}],
    )


class Prediction(CaseModel):
    """[[prediction]]: an answer before its measurement, of each blind reference; `dem verify --predict` writes it."""

    quantity: Word = Field(description="path of the number in summary.json", examples=["failure_load"])
    value: float = Field(description="what the case gives as it stands [unit of the quantity]", examples=[0.58])
    numerical: Pair = Field(
        description="least and largest one of its bracket and of the numerical alternatives [unit of the quantity]",
        examples=[[0.5799, 0.5801]],
    )
    inputs: Pair = Field(
        description="least and largest one of the alternatives of inputs [unit of the quantity]", examples=[[0.5, 0.66]]
    )
    band: Pair = Field(
        description="least and largest measured value that is expected: both differences added to the value, then "
        "the model's error on top [unit of the quantity]",
        examples=[[0.47, 0.68]],
    )
    date: Annotated[str, Field(pattern=r"^\d{4}-\d\d-\d\d$")] = Field(
        description="day on which it was written (UTC)", examples=["2026-11-29"]
    )
    version: Word = Field(description="version of dem that gave it", examples=["0.21.0"])
    sha256: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")] = Field(
        description="of the case without comments, predictions and measured values; a case whose keys changed is "
        "refused",
        examples=["5fead4d8f1c00bab4f168e0de9e2cf38926ea728c7d4f28e28c15235b1eaaf51"],
    )

    @model_validator(mode="after")
    def _in_order(self) -> Prediction:
        for key in ("numerical", "inputs", "band"):
            low, high = getattr(self, key)
            if low > high:
                raise KeyProblem(f"[{low:g}, {high:g}] is not allowed; must be [lowest, highest]", key)
        return self
