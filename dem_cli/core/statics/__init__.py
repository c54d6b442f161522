"""Statics: equilibrium, failure and its proof, failure load, post-peak path."""
