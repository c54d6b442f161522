"""Version of dem; what a version promises stands in docs/versions.md."""

__version__ = "0.3.0"
