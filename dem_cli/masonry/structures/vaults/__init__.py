"""Generate vaults: barrel, groin, cloister and dome."""
