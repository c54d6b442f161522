"""Compiled code reads from records what Python reads, whatever stands in them."""

from __future__ import annotations

import numpy as np
import pytest

from dem_cli.core.kernels.compilation.references import Record
from dem_cli.core.kernels.jit import kernel
from dem_cli.core.kernels.records import Ground, Watch


@kernel
def _read(watch, others, out):
    out[0], out[1], out[2] = watch.every, watch.blocks.shape[0], watch.samples.size
    out[3], out[4] = watch.blocks[-1], watch.samples[1, 0, 2, 1]
    row = watch.samples[1]
    out[5] = row[0, 2, 1]
    flat = watch.samples.ravel()
    out[6] = flat[-1]
    out[7] = others[0].accelerations[2, 1]
    watch.blocks[0] = 70


@pytest.mark.parametrize("strided", [False, True])
def test_compiled_code_reads_what_python_reads(strided: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DEM_STRICT_KERNELS")  # arrays with gaps are never kept

    def made() -> tuple[Watch, tuple[Ground], np.ndarray]:
        blocks = np.arange(12)[::3] if strided else np.arange(4)
        samples = np.arange(48.0).reshape(2, 4, 3, 2)
        ground = Ground(np.arange(6.0).reshape(2, 3).T, blocks, np.zeros((0, 4, 3)))  # columns first
        return Watch(blocks, 7, samples), (ground,), np.zeros(8)

    compiled, plain = made(), made()
    _read(*compiled)
    _read.py_func(*plain)
    assert list(compiled[2]) == list(plain[2])
    assert list(compiled[0].blocks) == list(plain[0].blocks)


def test_kernels_take_records_by_reference() -> None:
    watch = Watch(np.arange(4), 7, np.zeros((2, 4, 3, 2)))
    out = np.zeros(8)
    _read(watch, (Ground(np.zeros((3, 2)), watch.blocks, np.zeros((0, 4, 3))),), out)
    taken = _read.signatures[0]
    assert isinstance(taken[0], Record)
    assert isinstance(taken[1][0], Record)
