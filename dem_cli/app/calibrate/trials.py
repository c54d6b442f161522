"""Trial cases of a calibration: the given case with plane joints, and with every shape and aperture."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from dem_cli.app.calibrate.table import Calibration, NamedShape
from dem_cli.case.schema import Monitor

if TYPE_CHECKING:
    from dem_cli.case.base import CaseModel
    from dem_cli.case.schema import Case


class CalibrationTrial(NamedTuple):
    """Trial case of a calibration; without a shape its joints are plane."""

    case: Case
    shape: NamedShape | None = None
    aperture: float | None = None  # [m]

    @property
    def name(self) -> str:
        """Name of the trial in the table and messages."""
        if self.shape is None or self.aperture is None:
            return "plane joints"
        return f"shape {self.shape.name}, aperture {1e3 * self.aperture:.3g} mm"


def trials(case: Case) -> list[CalibrationTrial]:
    """Create all trial cases: plane joints first, then all apertures of the first shape, and so on.

    Each watches the displacement that was measured, in its last monitor. Without [reference] and [calibration]:
    these belong to the case in the file.
    """
    calibration: Calibration = case.calibration
    joint = calibration.joint or case.default_joint
    watched = Monitor(block=calibration.block, point=calibration.point, component=calibration.component)
    bare = case.model_copy(update={"calibration": None, "reference": None, "monitor": (*case.monitor, watched)})
    found = [CalibrationTrial(_with(bare, joint, case.joints[joint].model_copy(update={"profile": None})))]
    for shape in calibration.shapes:
        for aperture in calibration.apertures:
            found.append(
                CalibrationTrial(_with(bare, joint, profiled(case.joints[joint], shape, aperture)), shape, aperture)
            )
    return found


def profiled(joint: CaseModel, shape: NamedShape, aperture: float) -> CaseModel:
    """Replace the profile or the points of a joint by this profile."""
    table = joint.model_dump(exclude_unset=True, exclude={"profile", "points"})
    profile = shape.model_dump(exclude_none=True, exclude={"name"})
    return type(joint).model_validate({**table, "profile": {**profile, "aperture": aperture}})


def _with(case: Case, name: str, joint: CaseModel) -> Case:
    return case.model_copy(update={"joints": {**case.joints, name: joint}})
