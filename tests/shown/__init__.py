"""What a page of the documentation shows is done as a reader would, as it is printed: cases are written, commands run.

* A toml block whose first line is `# NAME.toml` is that file, and a whole case. One without a name is a piece of the
  last such file: put there, in place of what it replaces, it makes a valid case; the file stays as it was.
* A bash block is run, line by line, in a folder that has the project's cases. A line with the remark `# exit 2` must
  end so. `NOT_RUN` names what cannot be run here, line by line and why; what of it is a command of dem is parsed.
* Every line of a text block must be in what the last bash block printed; times may differ.
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

from dem_cli.app.cli.main import main

ROOT = Path(__file__).resolve().parents[2]
FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
NAME = re.compile(r"# ([\w./-]+\.toml)\n")
EXIT = re.compile(r"# exit (\d)$")
TIMES = re.compile(r"\d[\d.,]* (ms|s|min|h)\b")
INSTALLS, A_CLUSTER, A_SHELL, LONG = "installs", "a cluster", "of an interactive shell", "takes minutes"
NOT_RUN = {  # everything else is run
    "scripts/test": LONG,
    "python3 -m venv .venv": INSTALLS,
    "source .venv/bin/activate": INSTALLS,
    "pip install --constraint constraints.txt .": INSTALLS,
    'eval "$(_DEM_COMPLETE=bash_source dem)"': A_SHELL,
    "dask scheduler --host 127.0.0.1 --port 8786": A_CLUSTER,
    "dask worker tcp://127.0.0.1:8786 --nworkers 16 --nthreads 1": A_CLUSTER,
    "dem sweep wall.toml --scheduler tcp://127.0.0.1:8786": A_CLUSTER,
    'openssl req -x509 -newkey rsa:2048 -nodes -keyout key.pem -out cert.pem -days 30 -subj "/CN=dask"': A_CLUSTER,
    "chmod 600 key.pem": A_CLUSTER,
    'tls="--tls-ca-file cert.pem --tls-cert cert.pem --tls-key key.pem"': A_CLUSTER,
    "dask scheduler --protocol tls --port 8786 $tls": A_CLUSTER,
    "dask worker tls://head:8786 --nworkers 16 --nthreads 1 $tls": A_CLUSTER,
    "export DASK_DISTRIBUTED__COMM__TLS__CA_FILE=cert.pem": A_CLUSTER,
    "export DASK_DISTRIBUTED__COMM__TLS__CLIENT__CERT=cert.pem": A_CLUSTER,
    "export DASK_DISTRIBUTED__COMM__TLS__CLIENT__KEY=key.pem": A_CLUSTER,
    "dem sweep wall.toml --scheduler tls://head:8786": A_CLUSTER,
    "sbatch --array=1-8 --wrap 'dem sweep wall.toml -o sweep --shard $SLURM_ARRAY_TASK_ID/8'": A_CLUSTER,
    "dem verify --write docs/verification.md": LONG,
}
RUN_SCRIPT = 'exec "$venv/bin/dem" run "$@" --plot'  # what scripts/run does, once everything is installed


class Block(NamedTuple):
    language: str
    text: str


def blocks(page: Path) -> Iterator[Block]:
    """The fenced blocks of a page, in order."""
    for found in FENCE.finditer(page.read_text(encoding="utf-8")):
        yield Block(found[1], found[2])


class Reader:
    """Somebody who does what a page says, in a folder of their own that has the project's cases."""

    def __init__(self, folder: Path, can_render: bool = True):
        self.folder, self.can_render = folder, can_render
        self.case: dict = {}
        self.printed = ""
        self.left_out: list[str] = []  # lines of NOT_RUN that were met
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
            elif block.language == "text":
                self.compare(block.text)

    def read_case(self, text: str) -> None:
        """Write a file as it is printed, or put a piece into the last one; either must be a valid case."""
        found, name = tomllib.loads(text), NAME.match(text)
        if name:
            assert "title" in found, f"{name[1]} is not a whole case:\n{text}"
            self.case, path = found, self.folder / name[1]
            path.write_text(text, encoding="utf-8")
        else:
            assert self.case, f"a piece of no file:\n{text}"
            path = self.folder / "shown.toml"
            path.write_text(tomli_w.dumps(pasted(self.case, found)), encoding="utf-8")
        code, said = dem("check", str(path))
        assert code == 0, f"{text}\n{said}"

    def run(self, line: str) -> None:
        """One command; its output is added to what was printed."""
        words, target, given = shlex.split(line, comments=True), None, None
        if line.partition("  #")[0].rstrip() in NOT_RUN:
            self.left_out.append(line.partition("  #")[0].rstrip())
            parse(words[1:]) if words[0] == "dem" else None
            return
        if "|" in words:  # what one command prints is the case of the other
            first, words = words[: words.index("|")], words[words.index("|") + 1 :]
            given = dem(*first[1:])[1]
        if ">" in words:
            words, target = words[: words.index(">")], words[words.index(">") + 1]
        if words[0] == "scripts/run":
            assert RUN_SCRIPT in (ROOT / "scripts" / "run").read_text(encoding="utf-8").splitlines()
            words = ["dem", "run", *words[1:], "--plot"]
        assert words[0] == "dem", f"no test knows how to run {line!r}"
        if words[1] == "render" and not self.can_render:
            return parse(words[1:])
        code, said = dem(*words[1:], given=given)
        assert code == int(wanted[1] if (wanted := EXIT.search(line)) else 0), f"{line}\n{said}"
        assert "no pictures" not in said, f"{line}\n{said}"
        if target:
            (self.folder / target).write_text(said, encoding="utf-8")
        self.printed += said

    def compare(self, text: str) -> None:
        """Every line shown must have been printed."""
        printed = {plain(line) for line in self.printed.splitlines()}
        for line in filter(str.strip, text.splitlines()):
            assert plain(line) in printed, f"not printed: {line}\n{self.printed}"


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


def pasted(old: dict, new: dict) -> dict:
    """A case into which tables are pasted: each replaces the one of its name, as [joints.dry] that of the other."""
    found = dict(old)
    for key, value in new.items():
        named = key in ("joints", "materials") and key in found
        found[key] = {**found[key], **value} if named else value
    return found
