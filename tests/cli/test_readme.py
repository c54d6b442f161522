"""Every command that the README shows is run, in the order in which it stands there."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = [block.strip().splitlines() for block in re.findall(r"```bash\n(.*?)```", README, re.DOTALL)]
CASES = re.findall(r"```toml\n(.*?)```", README, re.DOTALL)
DEM = f"{shlex.quote(sys.executable)} -m dem_cli"


def as_run(command: str) -> str | None:
    """What stands for a shown command in a test: the same `dem`, without installing it again."""
    if command == "scripts/test":
        return None  # this is it
    if command.startswith("scripts/run "):
        return f"{DEM} run {command.removeprefix('scripts/run ')} --plot"
    assert command.startswith("dem "), f"no test knows how to run {command!r}"
    return DEM + command.removeprefix("dem")


@pytest.mark.slow
@pytest.mark.parametrize("commands", BLOCKS, ids=lambda commands: commands[0])
def test_commands(commands, tmp_path):
    shutil.copytree(ROOT / "cases", tmp_path / "cases")
    for command in commands:
        if line := as_run(command):
            done = subprocess.run(line, shell=True, cwd=tmp_path, capture_output=True, text=True)
            assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"


@pytest.mark.parametrize("text", CASES, ids=["column", "shaken column", "wall"])
def test_shown_case_is_valid(text, tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(text, encoding="utf-8")
    done = subprocess.run([sys.executable, "-m", "dem_cli", "check", path], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_first_command_is_the_wall():
    assert BLOCKS[0] == ["scripts/run cases/verification/wall_21.toml", "scripts/test"]
