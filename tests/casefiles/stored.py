"""What a run left in its folder, to be compared byte by byte."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np


def datasets(folder: Path) -> dict[str, bytes]:
    """Raw bytes of everything under /dem of results.h5, with type and shape."""
    found = {}

    def collect(name, item):
        if isinstance(item, h5py.Dataset):
            value = item[()]
            raw = value.tobytes() if isinstance(value, np.ndarray) and value.dtype != object else repr(value).encode()
            found[name] = str((item.dtype, item.shape)).encode() + raw

    with h5py.File(folder / "results.h5", "r") as file:
        file["dem"].visititems(collect)
    return found


def without_times(value):
    """A summary without what depends on the clock."""
    if isinstance(value, dict):
        return {key: without_times(item) for key, item in value.items() if "seconds" not in key}
    return [without_times(item) for item in value] if isinstance(value, list) else value
