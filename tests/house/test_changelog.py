"""changelog.d: fragments are well formed, and a release in a scratch copy writes the right text."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
LOG = "# Changelog\n\nWords.\n\n## 0.2.0 - 2020-01-01\n\n### Fixed\n\n- Old.\n"


def changelog(root: Path, *words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(root / "scripts" / "changelog"), *words]
    return subprocess.run(command, capture_output=True, text=True)


@pytest.fixture
def copy(tmp_path):
    for folder in ("scripts", "dem_cli", "changelog.d"):
        (tmp_path / folder).mkdir()
    shutil.copy(ROOT / "scripts" / "changelog", tmp_path / "scripts")
    (tmp_path / "CHANGELOG.md").write_text(LOG)
    (tmp_path / "dem_cli" / "version.py").write_text('A = 1\n__version__ = "0.2.0"\n')
    (tmp_path / "CITATION.cff").write_text('cff-version: 1.2.0\nversion: 0.2.0\ndate-released: "2020-01-01"\n')
    (tmp_path / "changelog.d" / "b-c.fixed.md").write_text("- Mended,\n  on two lines.\n")
    (tmp_path / "changelog.d" / "z.added.md").write_text("- New.\n- Newer.\n")
    (tmp_path / "changelog.d" / "a.fixed.md").write_text("- First.\n")
    return tmp_path


SECTION = "### Added\n\n- New.\n- Newer.\n\n### Fixed\n\n- First.\n- Mended,\n  on two lines.\n"


def test_fragments_of_the_project_are_well_formed():
    done = changelog(ROOT)
    assert (done.returncode, done.stderr) == (0, "")


def test_what_is_unreleased_is_printed(copy):
    assert changelog(copy).stdout == f"## Unreleased\n\n{SECTION}"
    assert (copy / "CHANGELOG.md").read_text() == LOG


def test_a_release_joins_fragments_and_sets_the_version(copy):
    done = changelog(copy, "--release", "0.10.0", "--date", "2020-02-03")
    assert (done.returncode, done.stderr) == (0, "")
    head, older = LOG.split("## 0.2.0")
    assert (copy / "CHANGELOG.md").read_text() == f"{head}## 0.10.0 - 2020-02-03\n\n{SECTION}\n## 0.2.0{older}"
    assert (copy / "dem_cli" / "version.py").read_text() == 'A = 1\n__version__ = "0.10.0"\n'
    cited = 'cff-version: 1.2.0\nversion: 0.10.0\ndate-released: "2020-02-03"\n'
    assert (copy / "CITATION.cff").read_text() == cited
    assert list((copy / "changelog.d").iterdir()) == []
    assert "no fragments" in changelog(copy, "--release", "0.11.0").stderr


@pytest.mark.parametrize("version", ["0.2.0", "0.1.9", "1.0", "v1.0.0"])
def test_a_version_that_is_not_higher_is_refused(copy, version):
    done = changelog(copy, "--release", version)
    assert done.returncode == 2
    assert done.stderr.startswith(f"error: --release {version}: a version is ")
    assert (copy / "CHANGELOG.md").read_text() == LOG


@pytest.mark.parametrize(
    ("name", "text", "place"),
    [("a.mended.md", "- A.\n", "a.mended.md: "), ("a.added.md", "A.\n", "a.added.md:1: "),
     ("a.added.md", "", "a.added.md:1: "),
     ("a.added.md", "- A\ngoes on.\n", "a.added.md:2: "), ("A_b.added.md", "- A.\n", "A_b.added.md: ")],
)  # fmt: skip
def test_a_malformed_fragment_is_named(copy, name, text, place):
    (copy / "changelog.d" / name).write_text(text)
    done = changelog(copy)
    assert done.returncode == 2
    assert done.stderr.startswith(f"error: changelog.d/{place}")
