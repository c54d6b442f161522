"""Mortar joints in three dimensions: strength of plates in bending out of plane, at any angle to the bed joints."""
