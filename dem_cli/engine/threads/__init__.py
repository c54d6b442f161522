"""Threads inside one run."""
