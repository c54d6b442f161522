"""The documentation as a site: docs/*.md by Sphinx, with every link, picture and anchor checked; works from a disk.

docs/case.md (from the declarations of the keys), docs/commands.md (from the commands), docs/results.md (from the layout
of the files), docs/gallery.md (from docs/gallery/gallery.toml), docs/seeds.md (from the data of other pages),
docs/blind.md (from cases/blind) and the table of README.md (from docs/data/verification.json) are generated:
`--write` renews them, and without it a stale one is an error.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from studies.places import ROOT
from studies.site.generated import PAGES, stale
from studies.site.links import problems


def main(words: Sequence[str] | None = None) -> int:
    """0 where the site is built and nothing in it is stale, missing or broken."""
    parser = argparse.ArgumentParser(prog="scripts/docs", description=__doc__.split("\n")[0])
    parser.add_argument("--write", action="store_true", help="renew the generated pages first")
    parser.add_argument("-o", "--output", default=str(ROOT / "build" / "docs"), help="default: build/docs")
    options = parser.parse_args(words)

    if options.write:
        for path, text in PAGES.items():
            (ROOT / path).write_text(text(), encoding="utf-8")
    found = [f"{path}: stale; run scripts/docs --write" for path in stale()]
    site = Path(options.output)
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html"]
    built = subprocess.run([*command, "-d", str(site) + ".doctrees", str(ROOT / "docs"), str(site)], check=False)
    if built.returncode == 0:
        found += problems(site)
        print(f"{site / 'index.html'}: {len(list(site.rglob('*.html')))} pages")
    print("\n".join(found), file=sys.stderr, end="\n" if found else "")
    return 1 if found or built.returncode else 0


if __name__ == "__main__":
    sys.exit(main())
