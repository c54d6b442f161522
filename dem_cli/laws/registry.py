"""All joint laws by name. A new law is one file and one line here."""

from dem_cli.laws.barton import BARTON
from dem_cli.laws.coulomb import COULOMB
from dem_cli.laws.crushing import CRUSHING
from dem_cli.laws.degrading import SLIP_DEGRADING
from dem_cli.laws.elastic import ELASTIC
from dem_cli.laws.fracture import FRACTURE
from dem_cli.laws.law import Law
from dem_cli.laws.mohr_coulomb import MOHR_COULOMB
from dem_cli.laws.rate import RATE_DEPENDENT

LAWS: dict[str, Law] = {
    law.name: law
    for law in (COULOMB, MOHR_COULOMB, BARTON, SLIP_DEGRADING, RATE_DEPENDENT, CRUSHING, FRACTURE, ELASTIC)
}
