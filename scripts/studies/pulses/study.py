"""Study of pulses: a column, an arch on buttresses and an arch of voussoirs under pulses of the base."""

from __future__ import annotations

from studies.pulses import buttresses, column, earthquakes, pictures, tables, voussoirs
from studies.study import StudyRunner

STUDY = StudyRunner(
    "pulses",
    "Published pulse tests of a column, an arch on buttresses and an arch of voussoirs",
    {
        "column_static": column.static,
        "rigid": column.rigid,
        "column": column.main_domain,
        "others": column.others,
        "fine": column.fine,
        "vault": voussoirs.study,
        "stiff_static": lambda: column.static(voussoirs.CASE, kn=1e12, ks=1e12),
        "free": voussoirs.free,
        "edges": voussoirs.edges,
        "steps": voussoirs.steps,
        "buttresses": buttresses.study,
        "spread": earthquakes.study,
    },
    tables.values,
    {
        "column": ("", pictures.draw_domain),
        "arch": ("vault", pictures.draw_histories),
        "points": ("vault", pictures.draw_points),
    },
    machine=True,
)
