"""What the folder of a sweep holds, by name: `dem sweep` writes it, plots and reports read it."""

CSV, SQLITE, FACTS, RUNS = "sweep.csv", "sweep.sqlite", "sweep.json", "runs"
FIRST = ("run", "status", "reason")  # columns that tell runs apart, beside the swept keys
