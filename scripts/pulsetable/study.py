"""All parts of docs/pulses.md."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pulsetable import buttresses, column, spread, vault

Say = Callable[[str], None]
PARTS: dict[str, Callable[[Say], Any]] = {
    "column_static": lambda say: column.static(),
    "rigid": column.rigid,
    "column": column.main_domain,
    "others": column.others,
    "fine": column.fine,
    "vault": vault.study,
    "stiff_static": lambda say: column.static(vault.CASE, kn=1e12, ks=1e12),
    "free": vault.free,
    "edges": vault.edges,
    "steps": vault.steps,
    "buttresses": buttresses.study,
    "spread": spread.study,
}
