"""Ensembles of runs: perturbed structures, records, collapse capacities and their distribution."""
