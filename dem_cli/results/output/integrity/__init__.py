"""Integrity of results that are read back: arrays and the summary, each against one declaration of what they are."""
