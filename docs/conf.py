"""Sphinx: the pages of docs/ as a site. `scripts/docs` builds and checks it."""

from pathlib import Path

project = "dem"
html_title = "dem"
html_short_title = "dem"
copyright = "the authors of dem, MIT licence"
extensions = ["myst_parser"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["_static"]
smartquotes = False  # "auto" is a value, quotes and all
highlight_language = "text"  # of blocks that do not say theirs
myst_heading_anchors = 4
myst_links_external_new_tab = False
html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["dem.css"]
html_show_sourcelink = False
html_copy_source = False
html_show_copyright = False
html_show_sphinx = False
html_theme_options = {
    "navigation_with_keys": True,
    "light_css_variables": {"color-brand-primary": "#8a4b1f", "color-brand-content": "#8a4b1f"},
    "dark_css_variables": {"color-brand-primary": "#e0a878", "color-brand-content": "#e0a878"},
}

WIDE = ("verification", "loads", "pulses", "appendix_b")  # pages of wide tables: no table of contents beside them


def _without_contents(app, page, template, context, tree):
    if page in WIDE:
        context["furo_hide_toc"] = True


ROOT_PAGES = ("contributing", "changelog")  # pages whose text stands at the root, where hosts look for it


def _from_the_root(app, name, source):
    if name in ROOT_PAGES:
        text = (Path(app.srcdir).parent / f"{name.upper()}.md").read_text(encoding="utf-8")
        source[0] = text.replace("](docs/", "](")
    for page in ROOT_PAGES:
        for link in (f"]({page.upper()}.md", f"](../{page.upper()}.md"):
            source[0] = source[0].replace(link, f"]({page}.md")


def setup(app):
    app.connect("source-read", _from_the_root)
    app.connect("html-page-context", _without_contents, priority=900)  # after furo's own
