"""Order of blocks in results: as in the case file, structure by structure, then those drawn by hand.

Solvers number blocks from the lowest up, so that neighbours lie close together in memory. Nobody else need know.
"""

from __future__ import annotations

import numpy as np

from dem_cli.core.model.model import Model
from dem_cli.core.records.certificate_record import Certificates
from dem_cli.core.records.frames import FRAME_ARRAYS, FrameStack, JointPlaces, LinkPlaces, LinkRecord


class CaseOrder:
    """Permutation of blocks from solver order to case order."""

    def __init__(self, model: Model):
        self.order = np.argsort(model.ranks, kind="stable")  # number in the solver of each block of the case
        self.same = bool((self.order == np.arange(len(self.order))).all())  # also where a model does not say
        self.places = np.argsort(self.order, kind="stable")

    def model(self, model: Model) -> Model:
        """Reorder the structure, without ties and bars where blocks are renumbered."""
        return model if self.same else model.only(self.order.tolist(), model.fixed[self.order])

    def joints(self, places: JointPlaces) -> JointPlaces:
        """Renumber the blocks of joints as drawn; the order of joints stays."""
        return places if self.same else places._replace(blocks=self.places[places.blocks])

    def links(self, record: LinkRecord) -> LinkRecord:
        """Renumber the blocks of ties and bars."""
        return record if self.same else record._replace(places=self._of_links(record.places))

    def _of_links(self, places: LinkPlaces) -> LinkPlaces:
        held = places.blocks >= 0
        return places._replace(blocks=np.where(held, self.places[places.blocks], places.blocks))

    def certificates(self, found: Certificates) -> Certificates:
        """Reorder the rows of blocks in certificates, and renumber the blocks of their contact points."""
        if self.same:
            return found
        standing, mechanism, failing = found.standing, found.mechanism, found.failing
        if standing is not None:
            blocks = self.places[standing.blocks]
            standing = standing._replace(places=standing.places[self.order], blocks=blocks)
        if mechanism is not None:
            blocks = self.places[mechanism.blocks]
            mechanism = mechanism._replace(rates=mechanism.rates[self.order], blocks=blocks)
        if failing is not None:
            failing = failing._replace(places=failing.places[:, self.order])
        return found._replace(standing=standing, mechanism=mechanism, failing=failing)

    def stack(self, stack: FrameStack) -> FrameStack:
        """Reorder frames: rows of blocks, and the blocks of contact points and links."""
        if self.same:
            return stack
        n, n_blocks = len(stack.frames), len(self.order)
        rows = (n_blocks * np.arange(n)[:, None] + self.order).ravel()
        blocks = stack.contacts.blocks
        arrays = {name: getattr(stack, name)[rows] for name in FRAME_ARRAYS}
        frames = tuple(
            frame._replace(
                **{name: getattr(frame, name)[self.order] for name in FRAME_ARRAYS},
                stresses=_picked(frame.stresses, self.order),
                first_moments=_picked(frame.first_moments, self.order),
                contacts=frame.contacts._replace(blocks=self.places[frame.contacts.blocks]),
                links=frame.links and self.links(frame.links),
            )
            for frame in stack.frames
        )
        return stack._replace(
            frames=frames,
            contacts=stack.contacts._replace(blocks=blocks - blocks % n_blocks + self.places[blocks % n_blocks]),
            stresses=_picked(stack.stresses, rows),
            first_moments=_picked(stack.first_moments, rows),
            **arrays,
        )


def _picked(rows: np.ndarray | None, order: np.ndarray) -> np.ndarray | None:
    """Reorder rows of blocks; None where there are none."""
    return None if rows is None else rows[order]
