"""Threads inside one run of a large structure."""
