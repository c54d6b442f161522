"""Generate structures: walls, columns, arches, vaults, bridges and buildings."""
