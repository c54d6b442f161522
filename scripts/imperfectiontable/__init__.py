"""The 21-block wall with one block too low: docs/imperfections.md and its picture."""
