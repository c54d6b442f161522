"""Vaults: barrel, groin and dome."""
