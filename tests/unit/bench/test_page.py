"""docs/benchmarks.md is what its JSON says."""

from __future__ import annotations

from pathlib import Path

import pytest
from bench import page, registry
from bench.record import GroupResult, group_table, read, record, records_of

DOCS = Path(__file__).resolve().parents[3] / "docs"
MACHINE = {"cores": 2, "processor": "some", "system": "Linux", "load": 0.5, "dem": "1", "python": "3.11"}


def test_the_page_is_made_from_its_json():
    groups = read(DOCS / "data" / "benchmarks.json")
    assert (DOCS / "benchmarks.md").read_text(encoding="utf-8") == page.render(groups)


def test_the_page_shows_every_group_and_picture():
    groups = read(DOCS / "data" / "benchmarks.json")
    text = (DOCS / "benchmarks.md").read_text(encoding="utf-8")
    assert list(groups) == list(registry.GROUPS)
    for name, title in registry.GROUPS.items():
        assert f"\n## {title}\n" in text
        for suffix in registry.module(name).PICTURES:
            assert (DOCS / f"benchmarks_{suffix}.png").exists()


def test_pictures_can_be_drawn_again(tmp_path):
    pytest.importorskip("matplotlib")
    groups = read(DOCS / "data" / "benchmarks.json")
    for name in registry.GROUPS:
        for suffix, draw in registry.module(name).PICTURES.items():
            draw(records_of(groups[name]), tmp_path / f"{suffix}.png")
            assert (tmp_path / f"{suffix}.png").stat().st_size > 10_000


def kernels(blocks: int) -> GroupResult:
    return GroupResult([record(f"wall {blocks}", "geometry", "fixed", [7.0], "ns", blocks=blocks, points=4 * blocks)])


def test_groups_measured_elsewhere_say_so(tmp_path):
    page.write(tmp_path, {"kernels": group_table(kernels(21), MACHINE)})
    assert "\nMachine: 2 cores, some, Linux, dem 1, python 3.11.\n" in (tmp_path / "benchmarks.md").read_text("utf-8")
    start_up = GroupResult([record("T21", "command", "dem", [1.0], best_wall=1.0, median_wall=1.0)])
    page.write(tmp_path, {"startup": group_table(start_up, MACHINE | {"cores": 64})})
    text = (tmp_path / "benchmarks.md").read_text("utf-8")
    assert "* kernels: 2 cores" in text
    assert "* startup: 64 cores" in text
    assert list(read(tmp_path / "data" / "benchmarks.json")) == ["kernels", "startup"]


def test_measuring_again_replaces_a_group(tmp_path):
    for blocks in (21, 231):
        page.write(tmp_path, {"kernels": group_table(kernels(blocks), MACHINE)})
    assert "| 231 |" in (tmp_path / "benchmarks.md").read_text("utf-8")
    assert "| 21 | 84 |" not in (tmp_path / "benchmarks.md").read_text("utf-8")
