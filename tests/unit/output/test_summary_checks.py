"""Lists of summary.json that go together are of one length: reports of modes ended in an internal error."""

import pytest

from dem_cli.errors import DamagedResults
from dem_cli.results.output.integrity.summary_checks import check_summary

RUN = {"title": "", "kind": "modes", "status": "ok"}
MODES = RUN | {
    "frequencies": [1.0, 2.0], "total_mass": 5.0, "springs": {"pressed": 1, "touching": 1},
    "first_frequency": {"pressed": 1.0, "touching": 1.0}, "effective_masses": {"x": [1.0, 2.0], "y": [0.0, 0.0]},
}  # fmt: skip
CURVE = {
    "displacements": [0.0, 1.0], "loads": [0.0, 1.0], "last_displacement": 1.0, "last_load": 1.0,
    "peak_displacement": 1.0, "peak_load": 1.0,
}  # fmt: skip
MEASURED = {"value": [1.0, 2.0], "displacements": [0.0, 1.0], "tolerance": 0.1, "passed": True}
FITTED = {"intensity": [1.0, 2.0], "share": [0.1, None], "low": [0.0, 0.1]}


def test_summaries_that_are_whole():
    for found in (MODES, RUN | {"capacity_curve": CURVE}, RUN | {"reference": [MEASURED]}, RUN | {"curve": FITTED}):
        assert check_summary(found) is found
    assert check_summary(RUN | {"levels": [1.0], "share": [None], "reference": MEASURED})


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        (MODES | {"effective_masses": {"x": [1.0, 2.0], "y": [0.0]}}, "effective_masses.y has 1 values, frequencies 2"),
        (MODES | {"total_mass": 0.0}, "total_mass is not above 0"),
        (MODES | {"total_mass": 1e300}, "total_mass is not in its range"),
        (RUN | {"capacity_curve": CURVE | {"loads": [0.0]}}, "capacity_curve.loads has 1 values, displacements 2"),
        (RUN | {"reference": MEASURED | {"value": [1.0]}}, "reference.value has 1 values, displacements 2"),
        (RUN | {"reference": [MEASURED, MEASURED | {"value": []}]}, "reference.value has 0 values, displacements 2"),
        (RUN | {"curve": FITTED | {"low": []}}, "curve.low has 0 values, intensity 2"),
        (RUN | {"curve": {"intensity": [], "share": []}}, "curve.intensity is not"),
        (RUN | {"levels": [1.0], "share": [0.5, 0.5]}, "share has 2 values, levels 1"),
        (RUN | {"failure_load": -1e300}, "failure_load is not in its range"),
    ],
)
def test_what_does_not_go_together(changed, says):
    with pytest.raises(DamagedResults) as error:
        check_summary(changed)
    assert error.value.damage.startswith(f"summary.json: {says}")
