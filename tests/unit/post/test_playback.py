"""Movies: time histories run as fast as they did, whatever their frames."""

from __future__ import annotations

import numpy as np
import pytest
from synthetic import wall_frames, wall_model, wall_summary
from synthetic.shaking import write_shaking

from dem_cli.results.output.reader import read
from dem_cli.results.output.store import ResultWriter
from dem_cli.results.post import playback
from dem_cli.results.report.view import MOST_BYTES, view


@pytest.mark.parametrize("seed", range(5))
def test_what_is_too_close_is_left_out_but_for_the_farthest(seed):
    rng = np.random.default_rng(seed)
    times = np.concatenate([[0.0], np.cumsum(rng.uniform(0.002, 0.05, 200))]).tolist()
    for farthest in (0, 7, 100, 200):
        shown = playback._apart(times, farthest)
        assert {0, farthest, 200} <= set(shown)
        gaps = np.diff([times[i] for i in shown])
        assert (gaps > 0.0).all()
        assert (gaps < playback.SHORTEST - 1e-12).sum() <= 3  # beside the three that must be there
        assert gaps.max() < 0.05 + playback.SHORTEST


def test_others_have_no_time(tmp_path):
    writer = ResultWriter(tmp_path, wall_model(), "", {})
    for frame in wall_frames(wall_model(), 6):
        writer.frame(frame)
    writer.close(wall_summary())
    assert playback.playback(read(tmp_path)).stays == [playback.EACH] * 6


def test_a_time_history_takes_as_long_as_it_took(tmp_path):
    movie = playback.playback(read(write_shaking(tmp_path, 30)))
    assert len(movie.frames) == 30
    assert sum(movie.stays[:-1]) == pytest.approx(5.0)
    assert sum(playback.milliseconds(movie.stays[:-1])) == pytest.approx(5000, abs=10)
    rate, shown = playback.ticks(movie.stays)
    assert rate == 12.5
    assert len(shown) / rate == pytest.approx(5.08, abs=0.08)
    assert sorted(set(shown)) == list(range(30))
    assert playback.playback(read(tmp_path), 0.1).stays == [0.1] * 30  # as asked for


def test_the_page_shows_all_frames_of_a_time_history(tmp_path):
    """The player has what it needs to show every swing: 50 frames of 300 blocks, 400 of 22."""
    scene = view(read(write_shaking(tmp_path, 400)))
    assert len(scene["frames"]) == 400
    assert scene["left_out"] == 0
    assert MOST_BYTES >= 50 * (24 * 300 + 50 * 1200)
