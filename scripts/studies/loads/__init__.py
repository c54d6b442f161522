"""Failure loads of all pushover cases by limit analysis and by DEM."""
