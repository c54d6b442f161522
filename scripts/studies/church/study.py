"""Study of thesis Appendix A: its sections, and the case files that are written from its geometry."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from studies.church import cases, displacement, models, sensitivity, walls
from studies.study import SectionedStudy


class ChurchStudy(SectionedStudy):
    """Writes the case files besides."""

    def arguments(self, parser: argparse.ArgumentParser) -> None:
        parser.add_argument("--cases", action="store_true", help="run nothing: write the case files")

    def main(self, words: Sequence[str] | None = None) -> int:
        if words is not None and list(words) == ["--cases"]:
            cases.write()
            return 0
        return super().main(words)


STUDY = ChurchStudy("church", "Thesis Appendix A, the slice of a church", (walls, models, displacement, sensitivity))
