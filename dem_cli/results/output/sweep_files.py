"""File names in the folder of a sweep: `dem sweep` writes them, plots and reports read them."""

CSV, SQLITE, FACTS, RUNS = "sweep.csv", "sweep.sqlite", "sweep.json", "runs"
IDENTITY_COLUMNS = ("run", "status", "reason")  # columns that tell runs apart, beside the swept keys
