"""Arguments of kept machine code: arrays that were there in the last call are not asked for their address again."""

import numpy as np

from dem_cli.core.kernels.compilation.kinds import words_of


def test_known_arrays_keep_their_words_and_new_ones_have_their_own():
    one, two, new = np.zeros(3), np.ones((2, 2)), np.zeros(3)
    first, second = {}, {}
    words = words_of((one, two), first, {})
    assert words == [
        0, 0, 3, 8, one.ctypes.data, 3, 8, 0, 0, 4, 8, two.ctypes.data, 2, 2, 16, 8,
    ]  # fmt: skip
    assert words_of((new, two), second, first)[:7] == [0, 0, 3, 8, new.ctypes.data, 3, 8]
    assert second[id(two)] is first[id(two)]
    assert id(one) not in second
