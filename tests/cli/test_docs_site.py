"""The documentation: no generated page is stale, the site builds without a warning, links lead somewhere, offline."""

from __future__ import annotations

import re
import shlex
import tomllib
from pathlib import Path

import pytest
from shown import blocks, parse
from studies.site import build, generated, links

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("path", generated.PAGES)
def test_generated_page_is_the_current_one(path):
    assert generated.read(ROOT / path) == generated.PAGES[path](), "run scripts/docs --write"


def test_the_site_builds_and_holds_together(tmp_path, capfd):
    site, pages = tmp_path / "site", ROOT / "docs"
    assert build.main(["-o", str(site)]) == 0, capfd.readouterr().err
    for path in pages.rglob("*.md"):
        assert (site / path.relative_to(pages)).with_suffix(".html").exists()


def test_what_is_broken_is_found(tmp_path):
    (tmp_path / "b.html").write_text('<h1 id="here">b</h1>')
    (tmp_path / "style.css").write_text("@import url('https://fonts.example.org/x.css'); p { background: url(b.png) }")
    page = (
        '<a href="b.html#here">1</a><a href="#top" id="top">2</a><a href="https://example.org/">3</a>'
        '<a href="c.html">4</a><a href="b.html#there">5</a><img src="no.png">'
        '<script src="//cdn.example.org/x.js"></script>'
    )
    (tmp_path / "a.html").write_text(page)
    found = sorted(links.problems(tmp_path))
    assert [line.split(": ")[0] for line in found] == ["a.html"] * 4 + ["style.css"]
    for word in ("c.html", "there", "no.png", "cdn", "fonts"):
        assert any(word in line for line in found), word


def test_examples_of_the_reference_are_toml():
    text = (ROOT / "docs" / "case.md").read_text(encoding="utf-8")
    found = [tomllib.loads(block) for block in re.findall(r"```toml\n(.*?)```", text, re.DOTALL)]
    assert len(found) > 40
    assert {name for table in found for name in table} >= {"materials", "joints", "structure", "analysis", "motion"}


def test_commands_of_the_gallery_are_right(monkeypatch):
    monkeypatch.chdir(ROOT)
    page = ROOT / "docs" / "gallery.md"
    lines = [line for block in blocks(page) for line in block.text.replace("\\\n", " ").splitlines()]
    assert len(lines) > 8
    for line in dict.fromkeys(lines):
        words = shlex.split(line)
        parse(words[1:], check=False)
        assert all((ROOT / word).exists() for word in words if word.startswith("cases/"))
