"""Integrity checks of results that are read back: arrays and summary against one declaration."""
