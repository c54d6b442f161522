"""Assemble the blocks, joints and loads of a case to the arrays of a model, and check them."""
