"""Benchmarks of structures in space: failure loads by size, and beside other programs."""
