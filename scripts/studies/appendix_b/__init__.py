"""Thesis Appendix B: walls with loads on top, pushed in their plane."""
