"""Command `scripts/study NAME [SECTION...] [--write]`: run a study, print what it found, write its page."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module

from bench.machine import one_thread

from studies.registry import STUDIES


def main(words: Sequence[str]) -> int:
    """Exit code of the study: 0 where every run came to an answer that is as it should be, 1 otherwise."""
    listed = "\n".join(f"  {name:<14} {about}" for name, (_, about) in STUDIES.items())
    parser = argparse.ArgumentParser(
        prog="scripts/study",
        description=f"Run a study: its sections, or those named; `scripts/study NAME --help` says more.\n\n{listed}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("name", choices=STUDIES, metavar="NAME", help="one of the above")
    parser.add_argument("words", nargs=argparse.REMAINDER, metavar="...", help="sections and options of the study")
    options = parser.parse_args(words)
    one_thread()  # before numerical libraries are imported
    return import_module(STUDIES[options.name][0]).STUDY.main(options.words)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
