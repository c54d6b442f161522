"""Write GIF and MP4 movies."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from dem_cli.errors import MissingExtra
from dem_cli.results.post import style
from dem_cli.results.post.playback import milliseconds, ticks

_FIRST, _LAST = 0.6, 1.4  # s: how long the first and the last picture stay
_COLOURS, _PAPER = 256, 242


def check(kind: str) -> None:
    """Raise UsageError where the software for a format is not installed."""
    if kind == "mp4" and find_spec("imageio_ffmpeg") is None:
        raise MissingExtra("MP4 needs imageio-ffmpeg", "movie", " (--movie gif works without)")


def write(pages: Sequence[np.ndarray], path: Path, stays: Sequence[float]) -> None:
    """Write a movie of pictures (height, width, 3) of bytes, of equal size, with the duration of each [s].

    The format is that of the file's name.
    """
    part = unfinished(path)
    {".gif": _write_gif, ".mp4": _write_mp4}[path.suffix](pages, part, list(stays))
    part.replace(path)


def unfinished(path: Path) -> Path:
    """Return the temporary name of a file, of the same kind."""
    return path.with_name(f".part-{path.name}")


def _write_gif(pages: Sequence[np.ndarray], path: Path, stays: list[float]) -> None:
    from PIL import Image

    palette = _palette(pages)
    images = [Image.fromarray(page).quantize(palette=palette, dither=Image.Dither.NONE) for page in pages]
    times = milliseconds(stays)
    times[0], times[-1] = max(times[0], round(1000 * _FIRST)), max(times[-1], round(1000 * _LAST))
    with path.open("wb") as file:
        images[0].save(
            file, "GIF", save_all=True, append_images=images[1:], duration=times, loop=0, optimize=True, disposal=1
        )


def _palette(pages: Sequence[np.ndarray]) -> Any:
    """Choose one palette for all pictures: legend colours, others from the first, the middle and the last."""
    from matplotlib.colors import to_rgb
    from PIL import Image

    some = [pages[0], pages[len(pages) // 2], pages[-1]]
    meant = np.rint([255.0 * np.array(to_rgb(ink)) for ink in (*style.STATE_COLOURS.values(), style.THRUST)])
    count = _COLOURS - len(meant)
    found = Image.fromarray(np.concatenate(some)).quantize(count, Image.Quantize.MEDIANCUT)
    colours = np.array(found.getpalette(), dtype=np.uint8)[: 3 * count].reshape(-1, 3)
    colours[colours.min(axis=1) > _PAPER] = 255  # Pillow takes what is near as well, and paper is white
    colours = np.concatenate([colours, meant.astype(np.uint8)])
    palette = Image.new("P", (1, 1))
    palette.putpalette(colours.ravel().tolist())
    return palette


def _write_mp4(pages: Sequence[np.ndarray], path: Path, stays: list[float]) -> None:
    import imageio_ffmpeg

    height, width = pages[0].shape[:2]
    fps, shown = ticks(stays)
    film = imageio_ffmpeg.write_frames(
        str(path), (width, height), fps=fps, codec="libx264", quality=7, macro_block_size=2, ffmpeg_log_level="error"
    )
    film.send(None)
    for page in [pages[0]] * round(fps * _FIRST) + [pages[i] for i in shown] + [pages[-1]] * round(fps * _LAST):
        film.send(np.ascontiguousarray(page))
    film.close()
