"""Versions of dem with which generated pages were measured: docs/data/measured.json, and one sentence made of it.

A page keeps its numbers until its command runs again, whatever the versions in between.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from dem_cli.version import __version__
from studies import storage

NAME = "measured"  # of the file: study -> section -> version


def note(study: str, sections: Iterable[str]) -> None:
    """Sections of a study were measured, now and with this program."""
    table = storage.read(NAME)
    kept = table.get(study, {}) | {section: __version__ for section in sections if section != "machine"}
    storage.write(NAME, dict(sorted((table | {study: kept}).items())))


def sentence(study: str) -> str:
    """With which version, where sections have several with which each of them; empty where nothing is noted."""
    versions: dict[str, str] = storage.read(NAME).get(study, {})
    if not versions:
        return ""
    most = Counter(versions.values()).most_common(1)[0][0]
    others: dict[str, list[str]] = {}
    for section, version in versions.items():
        if version != most:
            others.setdefault(version, []).append(section)
    named = [
        f"{version} ({', '.join(f'`{name}`' for name in others[version])})" for version in sorted(others, key=numbers)
    ]
    which = f"dem {most}" if not named else f"dem {', '.join(named)}, and all else with {most}"
    return f"Measured with {which}, and not since: a page keeps its numbers until its command runs again."


def numbers(version: str) -> tuple[int, ...]:
    """A version in the order of versions."""
    return tuple(map(int, version.split(".")))


def stamped(study: str, page: str) -> str:
    """The page with that sentence below its title."""
    title, _, rest = page.partition("\n\n")
    said = sentence(study)
    return f"{title}\n\n{said}\n\n{rest.lstrip(chr(10))}" if said else page
