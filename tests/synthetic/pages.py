"""Made-up results for `dem report`: a wall that is pushed, one with hostile texts in it, a sweep."""

from __future__ import annotations

import json
from pathlib import Path

from dem_cli.results.output.provenance import provenance
from dem_cli.results.output.store import ResultWriter
from synthetic import history_rows, wall_frames, wall_model, wall_summary

HOSTILE = "<script>document.title='hacked'</script>"
HOSTILE_ID = "</script><img src=x onerror=document.title='hacked'>"
CASE = "title = 'wall' # </pre><script>document.title='hacked'</script>\n"


def wall(folder: Path, **changes: object) -> Path:
    """Twelve frames: gravity, loading, collapse by 20 mm; `changes` go into the model."""
    folder.mkdir()
    model = wall_model()._replace(**changes)
    frames = wall_frames(model)
    writer = ResultWriter(folder, model, CASE, provenance(), ["top displacement"])
    for row in history_rows(frames):
        writer.row(row)
    for frame in frames:
        writer.frame(frame)
    extra = {"reference": {"value": 0.64, "tolerance": 0.001, "passed": True}, "largest_overlap": 1e-9}
    writer.close({**wall_summary(), **extra, "warnings": ["a <b>bold</b> warning"]})
    return folder


def evil(folder: Path) -> Path:
    """The same with hostile title and block."""
    ids = list(wall_model().block_ids)
    ids[3] = HOSTILE_ID
    wall(folder, block_ids=tuple(ids))
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    (folder / "summary.json").write_text(json.dumps({**summary, "title": HOSTILE}), encoding="utf-8")
    return folder


def sweep(folder: Path) -> Path:
    """Four frictions and two bonds; the last run failed."""
    lines = ["run,joints.dry.friction,structure.0.bond,status,reason,failure_load,failure_mode,blocks"]
    for i, friction in enumerate((0.3, 0.5, 0.7, 1.0)):
        for k, bond in enumerate(("running", "stack")):
            load = min(friction, 0.7 - 0.2 * k)
            answer = f"ok,,{load},{'sliding' if load == friction else 'rocking'}"
            last = (i, k) == (3, 1)
            lines.append(f"a{2 * i + k},{friction},{bond},{'failed,<i>too thin</i>,,' if last else answer},{20 + k}")
    (folder / "runs" / "a0").mkdir(parents=True)
    (folder / "runs" / "a0" / "summary.json").write_text("{}", encoding="utf-8")
    (folder / "sweep.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    facts = {"kind": "sweep", "version": "0.1.0", "title": HOSTILE, "keys": ["joints.dry.friction", "structure.0.bond"]}
    (folder / "sweep.json").write_text(json.dumps(facts), encoding="utf-8")
    (folder / "case.toml").write_text(CASE, encoding="utf-8")
    return folder
