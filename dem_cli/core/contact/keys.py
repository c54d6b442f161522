"""Keys that identify a joint or a contact point across detections: rows of whole numbers."""

from __future__ import annotations

from zlib import crc32

import numpy as np

from dem_cli.core.model.model import Model


def same_rows(old: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Find for each of the new rows (n_new, k) the equal one of the old rows (n_old, k), −1: none, (n_new,).

    Numbers are whole and not negative; of several equal rows the first counts.
    """
    if not len(old):
        return np.full(len(new), -1)
    spans = np.maximum(old.max(axis=0), new.max(axis=0, initial=0)) + 1
    key_old, key_new = (np.ravel_multi_index(tuple(rows.T), tuple(spans)) for rows in (old, new))
    order = np.argsort(key_old, kind="stable")
    place = np.minimum(np.searchsorted(key_old[order], key_new), len(order) - 1)
    return np.where(key_old[order][place] == key_new, order[place], -1)


def face_names(model: Model) -> list[int]:
    """Compute a number that identifies each face whatever other blocks there are, (n_faces,)."""
    names, part_faces = [], model.topology.part_faces
    for part, block in enumerate(model.part_blocks):
        of_block = part - int(np.searchsorted(model.part_blocks, block))
        for face in range(int(part_faces[part + 1] - part_faces[part])):
            names.append(crc32(f"{model.block_ids[block]} {of_block} {face}".encode()))
    return names
