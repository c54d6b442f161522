"""The scripts on machines that lack something: one clear message, exit code 2, nothing made; which tests they run."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zlib
from collections.abc import Sequence
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TOOLS = ("bash", "env", "dirname", "basename", "cat", "cksum", "tail", "rm", "grep")


@pytest.fixture
def project(tmp_path):
    """A copy of the scripts beside a bin/ that holds only the tools they use."""
    shutil.copytree(ROOT / "scripts", tmp_path / "scripts", ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "constraints.txt"):
        shutil.copy(ROOT / name, tmp_path)
    (tmp_path / "bin").mkdir()
    for tool in TOOLS:
        (tmp_path / "bin" / tool).symlink_to(shutil.which(tool))
    return tmp_path


def fake_python(project: Path, name: str, *, new_enough: bool) -> None:
    """An interpreter that answers the questions of scripts/environment.sh and has no venv."""
    script = project / "bin" / name
    answer = 0 if new_enough else 1
    script.write_text(
        "#!/usr/bin/env bash\n"
        'case "$*" in\n'
        f"  *version_info*) exit {answer} ;;\n"
        "  *pip*) exit 1 ;;\n"
        '  --version) echo "Python 3.9.2" ;;\n'
        "esac\n"
    )
    script.chmod(0o755)


def made_environment(project: Path) -> Path:
    """An environment in which every installation succeeds."""
    venv = project / ".venv"
    (venv / "bin").mkdir(parents=True)
    for name in ("python", "dem"):
        (venv / "bin" / name).write_text("#!/usr/bin/env bash\n")
        (venv / "bin" / name).chmod(0o755)
    return venv


def run(
    project: Path, script: str = "run", home: bool = True, words: Sequence[str] = ("case.toml",)
) -> subprocess.CompletedProcess:
    environment = {"PATH": str(project / "bin")} | ({"HOME": str(project)} if home else {})
    command = [str(project / "scripts" / script), *words]
    return subprocess.run(command, env=environment, cwd=project, capture_output=True, text=True)


@pytest.mark.parametrize("script", ["run", "test"])
def test_python_too_old(project, script):
    fake_python(project, "python3", new_enough=False)
    done = run(project, script)
    assert done.returncode == 2
    assert done.stderr == (
        f"{script}: needs Python 3.11 or newer with venv, found: Python 3.9.2 "
        "(set DEM_PYTHON to use a certain interpreter)\n"
    )
    assert not (project / ".venv").exists()


def test_no_venv_module(project):
    fake_python(project, "python3.11", new_enough=True)
    done = run(project)
    assert done.returncode == 2
    assert done.stderr == "run: python3.11 has no venv module; on Debian or Ubuntu install python3-venv\n"
    assert not (project / ".venv").exists()


def test_no_python_at_all(project):
    done = run(project)
    assert done.returncode == 2
    assert "needs Python 3.11 or newer" in done.stderr


def test_no_home(project):
    venv = made_environment(project)
    done = run(project, home=False)
    assert done.returncode == 0, done.stderr
    assert (venv / ".installed-plot").exists()
    assert not (venv / ".installing").exists()


def test_interrupted_installation_is_begun_anew(project):
    (made_environment(project) / ".installing").touch()
    done = run(project)  # no python here makes another environment
    assert done.returncode == 2
    assert "needs Python 3.11 or newer" in done.stderr


def test_documentation_finds_what_it_reads(project):
    """In a fresh clone `scripts/docs` said: No module named 'reference'."""
    (made_environment(project) / "bin" / "python").write_text(f'#!/usr/bin/env bash\nexec "{sys.executable}" "$@"\n')
    for name in ("tests", "docs", "dem_cli", "README.md"):
        (project / name).symlink_to(ROOT / name)
    done = subprocess.run(
        [str(project / "scripts" / "docs"), "--help"],
        env={"PATH": str(project / "bin"), "HOME": str(project)}, cwd="/", capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "--write" in done.stdout


@pytest.mark.parametrize(
    ("words", "given"),
    [
        (["tests/laws"], ["-m", "not slow", "tests/laws"]),
        (["--all"], []),
        (["--all", "-k", "a b"], ["-k", "a b"]),
        (["--quarter", "1", "-x"], ["-m", "not slow or quarter_1", "-x"]),
        (["-k", "--all"], ["-m", "not slow", "-k", "--all"]),  # an option of pytest's
        (["tests/test_a.py::test_slow"], ["tests/test_a.py::test_slow"]),  # whoever names a test wants it
        (["-x", "a.py::b[1 2]", "c"], ["-x", "a.py::b[1 2]", "c"]),
    ],
)
def test_slow_tests_are_run_with_all(project, words, given):
    (project / "bin" / "mktemp").symlink_to(shutil.which("mktemp"))
    says = '#!/usr/bin/env bash\n[ "$2" != pytest ] || printf "%s\\n" "$@"\n'
    (made_environment(project) / "bin" / "python").write_text(says)
    done = run(project, "test", words=words)
    assert done.returncode == 0, done.stderr
    said = done.stdout.splitlines()
    assert said[:2] == ["-m", "pytest"]
    assert said[said.index("5") + 1 :] == given


def test_slow_tests_are_in_quarters():
    """Each in one of four, of about the same size; all parameters of a test are in one."""
    names = {
        line.split("[")[0] for line in (ROOT / "tests" / "slow_tests.txt").read_text().splitlines() if line[0] != "#"
    }
    sizes = [sum(zlib.crc32(name.encode(), 172) % 4 == k for name in names) for k in range(4)]
    assert sum(sizes) == len(names)
    assert max(sizes) < 1.3 * min(sizes)


@pytest.mark.parametrize("words", [[], ["--all"], ["-k", "a b"]])
def test_continuous_integration_runs_everyday_tests_and_a_quarter_of_the_slow_ones(tmp_path, words):
    """Which quarter hangs on the commit alone."""
    here = tmp_path / "checkout"
    (here / ".ci").mkdir(parents=True), (here / "scripts").mkdir()
    shutil.copy(ROOT / ".ci" / "run", here / ".ci" / "run")
    (here / "scripts" / "test").write_text('#!/usr/bin/env bash\nprintf "%s\\n" "$@"\n')
    (here / "scripts" / "test").chmod(0o755)
    tools = here / "bin"
    tools.mkdir()
    (tools / "git").write_text("#!/usr/bin/env bash\necho 000000bcafe\n")
    for name in ("python3", "dpkg", "chromium", "chromedriver"):
        (tools / name).write_text("#!/usr/bin/env bash\n")
    for tool in tools.iterdir():
        tool.chmod(0o755)
    path = f"{tools}:{os.environ['PATH']}"
    done = subprocess.run([here / ".ci" / "run", *words], env={"PATH": path}, capture_output=True, text=True)
    assert done.stdout.splitlines() == (["--all"] if words == ["--all"] else ["--quarter", "3", *words]), done.stderr


@pytest.mark.parametrize("script", ["scripts/run", "scripts/test", "scripts/study", "scripts/docs", ".ci/run"])
def test_executable(script):
    assert os.access(ROOT / script, os.X_OK)


def test_constraints_are_pins_without_addresses():
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    pins = [line for line in lines if not line.startswith("#")]
    assert all(line.count("==") == 1 and "/" not in line for line in pins)
