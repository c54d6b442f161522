"""Datasets that grow: rows wait in memory as they were, in whatever order, and reach the file together."""

from __future__ import annotations

import io

import h5py
import numpy as np

from dem_cli.results.output.growing_dataset import GrowingGroup


def test_rows_wait_as_they_were_appended():
    with h5py.File(io.BytesIO(), "w") as file:
        group = GrowingGroup(file, {})
        rows = np.asfortranarray(np.arange(12.0).reshape(1, 3, 4))
        assert [group.append("field", rows), group.append("field", rows + 12.0)] == [0, 1]
        rows[:] = -1.0
        assert len(file["field"]) == 0
        group.write_out()
        assert group.append("field", np.full((1, 3, 4), 5.0)) == 2
        group.write_out()
        group.write_out()
        assert file["field"][:2].ravel().tolist() == list(range(24))
        assert (file["field"][2:] == 5.0).all()
        assert len(file["field"]) == 3


def test_a_dataset_that_is_there_is_taken_unless_made_for_fewer_rows():
    with h5py.File(io.BytesIO(), "w") as file:
        names = ("few", "many", "none")
        for name in names:
            GrowingGroup(file, {}, 4).make(name, (2,), np.dtype(float))
        group = GrowingGroup(file, {}, 4, made=names)
        for name, count in (("few", 3), ("many", 9)):
            group.append(name, np.arange(2.0 * count).reshape(-1, 2))
        group.write_out()
        group.drop_unused()
        assert {name: (data.chunks, len(data)) for name, data in file.items()} == {
            "few": ((4, 2), 3),
            "many": ((9, 2), 9),
        }
        assert file["many"][-1].tolist() == [16.0, 17.0]


def test_rows_come_back_however_they_meet_the_pieces_of_the_file():
    random = np.random.default_rng(1)
    with h5py.File(io.BytesIO(), "w") as file:
        group, rows = GrowingGroup(file, {}, 5), np.zeros((0, 2))
        for count in (3, *random.integers(0, 12, 40)):
            more = random.normal(size=(count, 2))
            group.append("field", more)
            group.write_out()
            rows = np.concatenate([rows, more])
            assert np.array_equal(file["field"][()], rows)
