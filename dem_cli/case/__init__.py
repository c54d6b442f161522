"""Case files: tables, units, names, and errors with their line."""
