"""Message about lack of memory: the work, its numbers of blocks and contact points, and the remedy."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from types import FrameType, TracebackType
from typing import Any, NamedTuple

FEWER_BLOCKS = "fewer, larger blocks need less"


class MemoryUser(NamedTuple):
    """Part of the program that takes much memory."""

    rooms: tuple[str, ...]  # packages of dem_cli
    makes: str
    remedy: str


USERS = (
    MemoryUser(("structures", "assembly", "imports", "model"), "the blocks", FEWER_BLOCKS),
    MemoryUser(("contact",), "the joints between blocks", f"{FEWER_BLOCKS}, and so do fewer joints.NAME.points"),
    MemoryUser(("limit",), "limit analysis", f"{FEWER_BLOCKS}, and so does a run without analysis.limit"),
    MemoryUser(("motion",), "the ground motion", "a shorter record, or one with longer steps, needs less"),
    MemoryUser(("output", "pipeline"), "the frames and tables of the results", "a smaller output.frames needs less"),
    MemoryUser(("post", "render", "report"), "a picture or page", "fewer frames or a smaller picture need less"),
    MemoryUser(
        ("engine", "kernels", "statics", "dynamics", "analyses", "ensembles"), "the contact points that are stepped",
        f"{FEWER_BLOCKS}, and so do fewer joints.NAME.points, or fewer runs side by side (-j)",
    ),
)  # fmt: skip
COUNTS: dict[str, Callable[[Any], dict[str, int]]] = {  # class, which need not be imported for that -> its sizes
    "dem_cli.core.model.model.Model": lambda model: {"blocks": model.n_blocks},
    "dem_cli.core.kernels.records.Contacts": lambda contacts: {"contact points": len(contacts.gaps)},
    "dem_cli.results.output.reader.Frames": lambda frames: {"frames": len(frames)},
}
ANYTHING = MemoryUser((), "what was asked for", "fewer blocks or frames need less")


def lack_of_memory(error: MemoryError) -> str:
    """Describe the use of the memory, its size, the system's message and the remedy, in one line."""
    frames = list(_frames(error.__traceback__))
    modules = [frame.f_globals.get("__name__", "").split(".") for frame in frames]
    users = [user for names in modules for user in USERS if not set(user.rooms).isdisjoint(names[1:3])]
    user = users[-1] if users else ANYTHING
    counts = ", ".join(f"{count:,} {what}" for what, count in _counts(frames).items())
    said = str(error) or "no more could be had"
    return f"not enough memory for {user.makes}{f' ({counts})' if counts else ''}: {said}; {user.remedy}"


def _frames(trace: TracebackType | None) -> Iterator[FrameType]:
    while trace is not None:
        yield trace.tb_frame
        trace = trace.tb_next


def _counts(frames: list[FrameType]) -> dict[str, int]:
    """Collect the sizes of the work by name: the last one of each kind in the failed functions."""
    found: dict[str, int] = {}
    for value in (value for frame in frames for value in frame.f_locals.values()):
        if count := COUNTS.get(f"{type(value).__module__}.{type(value).__name__}"):
            found |= count(value)
    return found
