"""File names in the folder of a sweep, shared by `dem sweep`, plots and reports."""

CSV, SQLITE, FACTS, RUNS = "sweep.csv", "sweep.sqlite", "sweep.json", "runs"
IDENTITY_COLUMNS = ("run", "status", "reason")  # columns that tell runs apart, beside the swept keys
