"""Simulation engine: a structure that advances step by step; knows no analysis."""
