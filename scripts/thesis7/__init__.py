"""Thesis chapter 7 run with dem: one module per section of docs/chapter7.md, from its runs to its part of the page."""
