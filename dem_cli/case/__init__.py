"""Read, validate and write case files: tables, units, names, and errors with their line."""
