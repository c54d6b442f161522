"""Solvers: blocks, joints, loads and motion as arrays; without case files, without results on disk."""
