"""dem: how much earthquake can a dry-stone wall, arch or column take?"""

__version__ = "0.1.0"
__all__ = ["__version__"]
