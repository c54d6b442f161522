"""What the README shows is done as a reader would, in the order in which it stands there; its figures are current."""

from __future__ import annotations

import re
from pathlib import Path

from shown import Reader, blocks

ROOT = Path(__file__).resolve().parents[2]
README = ROOT / "README.md"


def test_everything_shown_works(tmp_path, one_core, can_render):
    Reader(tmp_path, can_render).do(README)


def test_first_commands_are_the_wall_and_the_tests():
    first = next(blocks(README))
    assert first.text.splitlines() == ["scripts/run cases/verification/wall_21.toml", "scripts/test"]


def test_a_picture_comes_first():
    title, _, picture = README.read_text(encoding="utf-8").splitlines()[:3]
    assert (title, picture[:2]) == ("# dem", "![")


def test_links_lead_somewhere():
    links = re.findall(r"\]\(([\w./-]+)(?:#[\w-]+)?\)", README.read_text(encoding="utf-8"))
    assert len(links) > 20
    assert not [link for link in links if not (ROOT / link).exists()]


def test_at_most_200_lines():
    assert len(README.read_text(encoding="utf-8").splitlines()) <= 200
