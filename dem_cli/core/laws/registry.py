"""Registry of all joint laws by name, each loaded when it is named. A new law is one file and one line here."""

from __future__ import annotations

from dem_cli.core.laws.law import Law
from dem_cli.registration import Registered

LAWS: Registered[Law] = Registered(
    {
        "coulomb": ("dem_cli.core.laws.coulomb", "COULOMB"),
        "mohr-coulomb": ("dem_cli.core.laws.mohr_coulomb", "MOHR_COULOMB"),
        "barton": ("dem_cli.core.laws.barton", "BARTON"),
        "slip-degrading": ("dem_cli.core.laws.degrading", "SLIP_DEGRADING"),
        "rate-dependent": ("dem_cli.core.laws.rate", "RATE_DEPENDENT"),
        "crushing": ("dem_cli.core.laws.crushing", "CRUSHING"),
        "fracture": ("dem_cli.core.laws.fracture", "FRACTURE"),
        "elastic": ("dem_cli.core.laws.elastic", "ELASTIC"),
    }
)
