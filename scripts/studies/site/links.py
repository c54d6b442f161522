"""Whether a built site holds together: links, anchors and pictures lead somewhere, and nothing comes from the net."""

from __future__ import annotations

import re
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

NEEDED = {"script": "src", "img": "src", "link": "href", "source": "src", "iframe": "src", "video": "src"}  # to show it
ABOUT = ("canonical", "next", "prev", "index", "search", "author", "license")  # rel of links that load nothing
SCHEMES = ("http", "https", "mailto")
URL_IN_STYLE = re.compile(r"(?:url\(|@import\s+)[\"']?((?:https?:)?//[^\"')\s]+)")


class HtmlPage(HTMLParser):
    """What a page links to, what it loads, and where one can link to in it."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.anchors: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        found = {name: value or "" for name, value in attributes}
        self.anchors |= {found[name] for name in ("id", "name") if name in found}
        if tag == "a" and found.get("href"):
            self.links.append(found["href"])
        elif tag in NEEDED and found.get(NEEDED[tag]) and found.get("rel", "") not in ABOUT:
            self.loads.append(found[NEEDED[tag]])


@cache
def page_of(path: Path) -> HtmlPage:
    return HtmlPage(path.read_text(encoding="utf-8"))


def problems(site: Path) -> list[str]:
    """All that is wrong, a line each."""
    found = []
    for path in sorted(site.rglob("*.html")):
        page = page_of(path)
        name = path.relative_to(site)
        found += [f"{name}: loads {url} from elsewhere" for url in page.loads if elsewhere(url)]
        local = [url for url in page.loads if not elsewhere(url)]
        found += [f"{name}: {wrong}" for url in [*local, *page.links] if (wrong := broken(path, url))]
    for path in sorted(site.rglob("*.css")):
        for url in URL_IN_STYLE.findall(path.read_text(encoding="utf-8")):
            found.append(f"{path.relative_to(site)}: loads {url} from elsewhere")
    return found


def elsewhere(url: str) -> bool:
    return bool(urlsplit(url).netloc)


def broken(path: Path, url: str) -> str:
    """What is wrong with a link of the page at `path`; empty where nothing is. Links to other sites are only read."""
    parts = urlsplit(url)
    if parts.scheme == "data":
        return ""
    if parts.scheme or parts.netloc:
        return "" if parts.scheme in SCHEMES and (parts.netloc or parts.path) else f"what is {url}?"
    target = path if not parts.path else (path.parent / unquote(parts.path)).resolve()
    if not target.is_file():
        return f"{url} leads nowhere"
    anchor = unquote(parts.fragment)
    if anchor and target.suffix == ".html" and anchor not in page_of(target).anchors:
        return f"{url}: no such place on the page"
    return ""
