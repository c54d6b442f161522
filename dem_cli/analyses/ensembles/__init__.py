"""Many runs: variants of a structure, records, capacities and their distribution."""
