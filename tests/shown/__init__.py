"""What a page of the documentation shows is done as a reader would: its cases are read, its commands run, in order.

* A toml block with a title is a whole case. One without changes the last whole case of the page: its tables replace or
  extend those there. Each must be valid; one whose first line is `# NAME.toml` is written to that file.
* A bash block is run, line by line. A line whose remark says how many minutes it takes is only parsed, one that says
  `exit 2` must end so; `dem render`, which needs graphics libraries, is only parsed.
* Every line of a text block right after a bash block must be in what its commands printed; times may differ.
"""

from __future__ import annotations

import re
import shlex
import shutil
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import click
import tomli_w
from click.testing import CliRunner

from dem_cli.cli.main import main

ROOT = Path(__file__).resolve().parents[2]
FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
NAME = re.compile(r"# ([\w./-]+\.toml)\n")
MINUTES = re.compile(r"#.*\b(min|minutes?|h|hours?)\b")
EXIT = re.compile(r"# exit (\d)$")
TIMES = re.compile(r"\d[\d.,]* (ms|s|min|h)\b")
MANY = ("sweep", "verify")  # run in one process here: starting more costs more than the runs that are shown
ELSEWHERE = ("python3 ", "pip ", "source ", "git ", "cd ", "scripts/test", "sbatch ", "dask ", "sudo ", "xdg-open ")


class Block(NamedTuple):
    language: str
    text: str
    after: str  # language of the block right before, with nothing but blank lines between; else ""


def blocks(page: Path) -> Iterator[Block]:
    """The fenced blocks of a page, in order."""
    text, end, before = page.read_text(encoding="utf-8"), 0, ""
    for found in FENCE.finditer(text):
        alone = not text[end : found.start()].strip()
        yield Block(found[1], found[2], before if alone else "")
        end, before = found.end(), found[1]


class Reader:
    """Somebody who does what a page says, in a folder of their own that has the project's cases."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.case: dict = {}
        self.printed = ""
        shutil.copytree(ROOT / "cases", folder / "cases")

    def do(self, page: Path) -> None:
        """All of a page. AssertionError on what does not work as it says; the working folder must be `folder`."""
        for block in blocks(page):
            if block.language == "toml":
                self.read_case(block.text)
            elif block.language == "bash":
                self.printed = ""
                for line in filter(None, map(str.strip, block.text.replace("\\\n", " ").splitlines())):
                    self.run(line)
            elif block.language == "text" and block.after == "bash":
                self.compare(block.text)

    def read_case(self, text: str) -> None:
        """Check a case; keep it where the text says its file."""
        found = tomllib.loads(text)
        self.case = found if "title" in found else changed(self.case, found)
        name = NAME.match(text)
        path = self.folder / (name[1] if name else "shown.toml")
        path.write_text(text if "title" in found else tomli_w.dumps(self.case), encoding="utf-8")
        if "motion" not in found or "file" not in str(found["motion"]):
            code, said = dem("check", str(path))
            assert code == 0, f"{text}\n{said}"

    def run(self, line: str) -> None:
        """One command; its output is added to what was printed."""
        if line.startswith(ELSEWHERE):
            return
        words, target, given = shlex.split(line, comments=True), None, None
        if "|" in words:  # what one command prints is the case of the other
            first, words = words[: words.index("|")], words[words.index("|") + 1 :]
            given = dem(*first[1:])[1]
        if ">" in words:
            words, target = words[: words.index(">")], words[words.index(">") + 1]
        if words[0] == "scripts/run":
            words = ["dem", "run", *words[1:], "--plot"]
        assert words[0] == "dem", f"no test knows how to run {line!r}"
        if MINUTES.search(line) or words[1] == "render":
            parse(words[1:])
            return
        one = [] if words[1] not in MANY or "-j" in words else ["-j", "1"]
        code, said = dem(*words[1:], *one, given=given)
        assert code == int(wanted[1] if (wanted := EXIT.search(line)) else 0), f"{line}\n{said}"
        if target:
            (self.folder / target).write_text(said, encoding="utf-8")
        self.printed += said

    def compare(self, text: str) -> None:
        """Every line shown must have been printed."""
        printed = {plain(line) for line in self.printed.splitlines()}
        for line in filter(str.strip, text.splitlines()):
            assert plain(line) in printed or line.strip() == "...", f"not printed: {line}\n{self.printed}"


def dem(*words: str, given: str | None = None) -> tuple[int, str]:
    """`dem WORDS` in this process, `given` its standard input: exit code and all that was printed."""
    result = CliRunner().invoke(main, list(words), input=given)
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result.exit_code, result.output


def parse(words: list[str], check: bool = True) -> None:
    """Only see that the options are there; with `check` that a case which is named is valid."""
    context = click.Context(main, info_name="dem")
    command = main.get_command(context, words[0])
    assert command is not None, words[0]
    found = command.make_context(words[0], words[1:], parent=context)
    if check and str(found.params.get("case", "")).endswith(".toml"):
        changes = [word for item in found.params.get("overrides", ()) for word in ("--set", item)]
        code, said = dem("check", found.params["case"], *changes)
        assert code == 0, said


def plain(line: str) -> str:
    """A line without its times and without blanks at the ends, which no two machines share."""
    return " ".join(TIMES.sub("… s", line).split())


def changed(old: dict, new: dict) -> dict:
    """A case with other tables: their keys replace those there, a table of another kind as a whole."""
    found = dict(old)
    for key, value in new.items():
        there = found.get(key)
        replaces = not isinstance(value, dict) or not isinstance(there, dict) or {"kind", "law"} & value.keys()
        found[key] = value if replaces else changed(there, value)
    return found
