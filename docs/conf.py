"""Sphinx: the pages of docs/ as a site. `scripts/docs` builds and checks it."""

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


def setup(app):
    app.connect("html-page-context", _without_contents, priority=900)  # after furo's own
