"""Different laws in one loop: bit for bit what each gives alone."""

from __future__ import annotations

import numpy as np
import pytest
from lawpaths import joint, ramp, through_loop

from dem_cli.core.laws.mixed import mixed, row

CLOSED, U = -(2.0**-16), 2.0**-15
COULOMB, STEEP = joint("coulomb", friction=0.5), joint("coulomb", friction=0.75)
SOFT = joint("coulomb", friction=0.5, softening={"residual": 0.5, "slip_start": U, "slip_length": 4 * U})
BOND = joint("mohr-coulomb", friction=0.5, tension=8.0, cohesion=20.0, dilation_deg=15.0, dilation_slip=2 * U)
CRACK = joint("fracture", {"kn": 2.0**20, "ks": 2.0**19}, friction=0.5, tension=8.0, cohesion=20.0,
              fracture_energy_tension=2.0**-13, fracture_energy_shear=2.0**-11)  # fmt: skip
MIXES = {
    "one law, two tables": [COULOMB, STEEP],
    "two that do not bond": [COULOMB, SOFT, STEEP],
    "one that bonds": [BOND, COULOMB],
    "three": [SOFT, BOND, CRACK],
}
TARGETS = [
    (CLOSED, 0.0),
    (CLOSED, 4 * U),
    (4 * CLOSED, -4 * U),
    (0.0, 0.0),
    (-4 * CLOSED, 0.0),
    (0.0, 2 * U),
    (CLOSED, 8 * U),
]


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("mix", MIXES.values(), ids=MIXES)
def test_each_law_as_if_alone(mix, d):
    path = ramp(*[(gap, *[slide] * (d - 1)) for gap, slide in TARGETS])
    together = through_loop(mix, path)
    parts = [through_loop([part], path) for part in mix]
    for i, (part, alone) in enumerate(zip(mix, parts)):
        assert np.array_equal(together.normal[:, i], alone.normal[:, 0])
        assert np.array_equal(together.shear[:, i], alone.shear[:, 0])
        assert np.array_equal(together.slip[:, i], alone.slip[:, 0])
        size = part.law.n_memory(d)
        assert np.array_equal(together.memory[i, :size], alone.memory[0])
    # Beside a law that bonds the normal springs of the others are in the books too, with nothing but round-off.
    np.testing.assert_allclose(together.lost, sum(alone.lost for alone in parts), rtol=1e-9)


def test_shear_limits_of_each():
    laws = (COULOMB.law, BOND.law)
    parameters = np.stack([row(laws, j.law, j.columns, 9) for j in (COULOMB, BOND, BOND)])
    memory = np.zeros((3, mixed(laws).n_memory(2)))
    memory[1, 0] = 1.0
    limit = mixed(laws).shear_limit(parameters, np.full(3, 10.0), memory, np.full(3, BOND.kn))
    np.testing.assert_allclose(limit, [5.0, 25.0, 5.0])


def test_one_law_is_itself():
    assert mixed((COULOMB.law,)) is COULOMB.law
