"""Failure loads and motions worked out without anything of dem_cli: what the solver is judged by."""
