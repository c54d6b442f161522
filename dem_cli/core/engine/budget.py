"""Budget of a run: the number of solver steps that it may still take."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from dem_cli.errors import SolverError


@dataclass
class Budget:
    """Solver steps that may still be spent. `spend` raises SolverError when there are none left."""

    LASTING: ClassVar[frozenset[str]] = frozenset()
    left: int

    def spend(self, steps: int, doing: str) -> None:
        """Take steps off the budget. Raises SolverError when more are spent than there were."""
        self.left -= steps
        if self.left < 0:
            raise SolverError(f"gave up {doing}: all steps of analysis.max_steps are used up")
