"""All joint laws by name. A new law is one file and one line here."""

from dem_cli.laws.coulomb import COULOMB
from dem_cli.laws.law import Law
from dem_cli.laws.mohr_coulomb import MOHR_COULOMB

LAWS: dict[str, Law] = {law.name: law for law in (COULOMB, MOHR_COULOMB)}
