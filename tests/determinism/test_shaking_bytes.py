"""Time histories in two processes: the same bytes, also of what remembers and draws."""

from __future__ import annotations

import subprocess
import sys

DAMPINGS = [{"none": True}, {"contact_fraction": 1.0}, {"maxwell": [{"ratio": 0.05, "frequency": 5.0}], "mass": 0.5}]
PROGRAM = """
import hashlib, engine
from engine import block, rectangle, tables
blocks = [block("base", rectangle(-3, -1, 3, 0), fixed=True)]
blocks += [block(f"b{{i}}", rectangle(-0.25, 0.3 * i, 0.25, 0.3 * i + 0.3)) for i in range(5)]
case = tables(
    *blocks, joints={{"j": {{"friction": 0.5, "kn": 1e9}}}},
    motion={{"kind": "pulse", "shape": "sine", "amplitude": 6.0, "frequency": 1.5}},
    analysis={{"kind": "time-history", "duration": 0.8}}, monitor=[{{"block": "b4", "component": "x"}}],
    output={{"frames": 5, "rate": 1000.0}},
)
for damping in {dampings}:
    summary, records = engine.solve(case | {{"damping": damping}})
    found = hashlib.sha256(records.history.monitors.tobytes())
    for frame in records.frames:
        found.update(frame.positions.tobytes() + frame.velocities.tobytes() + frame.contacts.normal_force.tobytes())
    print(found.hexdigest(), summary["largest_displacement"].hex())
"""


def test_two_processes():
    program = PROGRAM.format(dampings=DAMPINGS)
    first, second = (
        subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
        for _ in range(2)
    )
    assert first == second
    digests = [line.split()[0] for line in first.splitlines()]
    assert [len(digest) for digest in digests] == [64] * len(DAMPINGS)
    assert len(set(digests)) == len(DAMPINGS)
