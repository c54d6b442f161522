"""Calibrate the joint profile that comes closest to a test."""
