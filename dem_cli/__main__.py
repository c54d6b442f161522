"""`python -m dem_cli` is the same as the `dem` command."""

from dem_cli.app.cli.main import main

if __name__ == "__main__":
    main()
