"""Bounds of failure loads of joints that do not dilate (thesis chapter 3), beside what DEM reaches."""
