"""Keys by which a joint or a contact point is known again: the same row of whole numbers."""

from __future__ import annotations

from zlib import crc32

import numpy as np

from dem_cli.core.model.model import Model


def same_rows(old: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Which of the old rows (n_old, k) each of the new ones (n_new, k) equals, −1: none, (n_new,).

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
    """A number for each face that says whose it is and which: other blocks change nothing, (n_faces,)."""
    names, part_faces = [], model.topology.part_faces
    for part, block in enumerate(model.part_blocks):
        of_block = part - int(np.searchsorted(model.part_blocks, block))
        for face in range(int(part_faces[part + 1] - part_faces[part])):
            names.append(crc32(f"{model.block_ids[block]} {of_block} {face}".encode()))
    return names
