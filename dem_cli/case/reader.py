"""Read a case file from TOML to a validated case, reporting every mistake at once with line and column."""

from __future__ import annotations

import copy
import difflib
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import Any

import tomli
from pydantic import ValidationError

from dem_cli.case import cross_references, dimensions, retired_keys
from dem_cli.case.messages import foremost, problems_from
from dem_cli.case.overrides import Override, apply, parse
from dem_cli.case.plausibility import doubts
from dem_cli.case.scanner import KeyPositions, impossible_values, parsed
from dem_cli.case.schema import Case
from dem_cli.errors import CaseError, CaseProblem, KeyPath, UsageError, dotted
from dem_cli.input_limits import CASE_BYTES, UnreadableInput, read_bounded

# The class of case files for the tables of one; of None, with all that there is: for what to say of mistakes.
ModelOf = Callable[[dict[str, Any] | None], type[Case]]
SYNTAX = {  # how messages of the parser begin -> the same in plain words
    "Illegal character '\\n'": "the line ends within a string or a comment",
    "Cannot overwrite a value": "this key is given twice",
    "Unterminated string": "a string is not closed",
    "Unclosed array": "a list is not closed: ']' or ',' is missing",
    "Expected '=' after a key": "'=' is missing after a key",
    "Expected newline or end of document": "more follows the value (numbers have no unit and a decimal point, 0.6)",
    "Invalid value": "a value is missing or not written as TOML (text stands in quotes)",
}


class CaseSource:
    """Source text of a case, which locates problems by line and column."""

    def __init__(self, path: Path, text: str, overrides: Sequence[Override] = ()):
        self.path = path
        self.text = text
        self.overrides = tuple(overrides)
        self.old_keys: list[CaseProblem] = []  # doubts about keys that are retired and still read

    @property
    def name(self) -> str:
        """Name of the results, and of a case without a title."""
        return self.path.stem.strip("<>")

    @cached_property
    def places(self) -> KeyPositions:
        """Positions of every key and value in the text."""
        return KeyPositions(self.text)

    def locate(self, path: KeyPath, key: bool = False) -> tuple[int, int]:
        """Return line and column, from 1, of the value at a key path, or of its key."""
        return self.places.locate(self.as_written(path), key)

    def as_written(self, path: KeyPath) -> KeyPath:
        """Convert a key path to the file's form, without the index of a single table: motion.0.file -> motion.file."""
        one = path[1:2] == (0,) and path[0] in cross_references.ONE_OR_MORE
        alone = one and path[:2] not in self.places.values
        return path[:1] + path[2:] if alone else path

    def asked(self, override: Override) -> str:
        """Return the origin of an overridden value as the beginning of a message."""
        if not override.place:
            return f"{override.origin} "
        line, column = self.locate(override.place)
        return f"{self.path}:{line}:{column}: {dotted(override.place[:1])}: "

    @contextmanager
    def located(self) -> Iterator[None]:
        """Add the place in the file to case errors raised inside this context."""
        try:
            yield
        except CaseError as error:
            raise CaseError(foremost(error.problems), self.render) from None

    def render(self, problem: CaseProblem) -> str:
        """Format a problem as `case.toml:8:1: joints.dry.frcition: unknown key, did you mean 'friction'?`"""
        path = self.as_written(problem.path)
        for override in self.overrides:
            if path and override.path == path[: len(override.path)]:
                return f"{self.asked(override)}{dotted(path)}: {problem.message}"
        for override in self.overrides:  # a table that only an override made, or a key that is missing in it
            if any(
                table and table not in self.places.values and override.path[: len(table)] == table
                for table in (path, path[:-1])
            ):
                return f"{self.asked(override)}{override.text}: {dotted(path)}: {problem.message}"
        line, column = self.locate(path, problem.at_key)
        where = f"{self.path}:{line}:{column}: "
        return where + (f"{dotted(path)}: " if path else "") + problem.message


class LoadedCase(CaseSource):
    """Valid case with its source text and its warnings, one line each."""

    def __init__(self, case: Case, source: CaseSource):
        super().__init__(source.path, source.text, source.overrides)
        self.case = case
        self.warnings = [self.render(doubt) for doubt in (*source.old_keys, *doubts(case))]

    def __repr__(self) -> str:
        return f"<case {self.case.title or self.name!r} of {self.path}>"


def read_case(
    path: str | Path, model_of: ModelOf, overrides: Sequence[str | Override] = (), text: str | None = None
) -> LoadedCase:
    """Read and validate a case file, with overrides (texts are KEY=VALUE). Raises CaseError or UsageError.

    text: what the file held when it was read, where that was before.
    """
    path = Path(path)
    changes = [parse(change) if isinstance(change, str) else change for change in overrides]
    text = read_text(path) if text is None else text
    data = parse_toml(path, text)
    resolved, found = [], []
    for change in changes:
        change, problem = apply(data, change, Case.model_fields)
        resolved.append(change)
        found += [problem] if problem else []
    source = CaseSource(path, text, resolved)
    if found:
        raise CaseError(found, source.render)
    return LoadedCase(validated(data, model_of, source), source)


def validate(data: dict[str, Any], model: type[Case], source: CaseSource) -> Case:
    """Validate plain data against one class of cases. Raises CaseError with every mistake."""
    return validated(data, lambda tables: model, source)


def validated(data: dict[str, Any], model_of: ModelOf, source: CaseSource) -> Case:
    """Validate plain data against a class that depends on it. Raises CaseError with every mistake in file order."""
    found = list(impossible_values(data))
    if found:
        raise CaseError(found, source.render)
    data = copy.deepcopy(data)
    source.old_keys, found = retired_keys.rename(data, {override.path for override in source.overrides})
    cross_references.complete(data, source.name)
    # folder: where relative paths start
    context = {"folder": source.path.parent, "dimension": dimensions.dimension_of(data)}
    case = None
    try:
        case = _valid(data, model_of, context)
    except ValidationError as error:
        found += problems_from(error, model_of(None), data)
    found += [*cross_references.problems(data), *dimensions.problems(data)]
    if case is None or found:
        found.sort(key=lambda problem: source.locate(problem.path, problem.at_key))
        raise CaseError(found, source.render)
    return case


def _valid(data: dict[str, Any], model_of: ModelOf, context: dict[str, Any]) -> Case:
    """Validate with the narrow class of cases first; raises ValidationError of the complete class."""
    try:
        return model_of(data).model_validate(data, context=context)
    except ValidationError:
        return model_of(None).model_validate(data, context=context)


def parse_toml(path: Path, text: str) -> dict[str, Any]:
    """Parse TOML to plain data; a syntax error gives file, line and column."""
    if not text.strip():
        message = f"{path}: the file is empty; `dem new wall` prints a case to start from"
        raise CaseError([CaseProblem((), message)])
    try:
        return parsed(text)
    except tomli.TOMLDecodeError as error:
        message = f"{path}:{error.lineno}:{error.colno}: not valid TOML: {syntax_message(error.msg)}"
        raise CaseError([CaseProblem((), message)]) from None


def syntax_message(message: str) -> str:
    """Rewrite an error message of the TOML parser in plain words."""
    for start, words in SYNTAX.items():
        if message.startswith(start):
            return words
    message = re.sub(r"\((?:'[^']*',? ?)+\)", lambda keys: ".".join(re.findall("'([^']*)'", keys[0])), message)
    return message[:1].lower() + message[1:]


def read_text(path: Path) -> str:
    """Read the text of a UTF-8 file, with or without byte order mark."""
    try:
        raw = read_bounded(path, CASE_BYTES, pipes=True)
    except FileNotFoundError:
        raise UsageError(f"{path}: no such file{near_file(path)}") from None
    except UnreadableInput as error:
        raise UsageError(f"{path}: {error}; a case is a TOML file") from None
    except OSError as error:
        raise UsageError(f"{path}: cannot be read ({error.strerror or error})") from None
    return decoded(path, raw)


def decoded(path: Path, raw: bytes) -> str:
    """Decode the bytes of a UTF-8 file. Raises CaseError where they are no such text."""
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        byte = raw[error.start]
        raise CaseError([CaseProblem((), f"{path}:{line}: not UTF-8 text (byte 0x{byte:02x})")]) from None


def near_file(path: Path) -> str:
    """Suggest a TOML file of nearly the same name in the same folder, for a message."""
    if not path.parent.is_dir():
        return f" (there is no folder '{path.parent}')"
    files = {file.stem: file for file in sorted(path.parent.glob("*.toml")) if file.is_file()}
    close = difflib.get_close_matches(path.stem, files, 1)  # what all names end in makes none alike
    return f", did you mean '{files[close[0]]}'?" if close else ""
