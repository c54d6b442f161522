"""What the recipes of CONTRIBUTING.md ask for, written out for one example each: new files, and changed lines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple


class Recipe(NamedTuple):
    """Recipe of CONTRIBUTING.md, done for one example; its name stands for NAME or KIND in paths."""

    section: str  # its heading
    name: str  # of the example, as a case file has it
    files: Mapping[str, str]  # new ones, by their paths
    lines: Sequence[tuple[str, str, str]]  # file, a text that stands there once, and what it becomes
    commands: Sequence[tuple[str, ...]]  # as the recipe has them, in their order
    tests: Sequence[str]  # that ask of it, as pytest takes them
    left_out: Sequence[str] = ()  # files of steps that begin with "if", and that the example does not need

    @property
    def module(self) -> str:
        """The name of its files."""
        return self.name.replace("-", "_")
