"""Limit analysis of rigid blocks: associated loads, and the path of joints that do not dilate."""
