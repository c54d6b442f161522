"""Thesis Appendix A: a slice of a church, pushed out of the plane of its walls."""
