"""The scanner finds every key and value of any TOML text, where they really stand."""

from __future__ import annotations

import tomli
import tomli_w
from hypothesis import given, settings
from hypothesis import strategies as st

from dem_cli.case.scanner import KeyPositions

TEXT = '''\
title = "a # b"   # comment = 1
a.b . "c d" = [1, [2, """x ] " y""", {k=3, 'z.y'.w = 4}], # c ]
  5,]
d = 1979-05-27 07:32:00
[t."q.r"]
x='\\'
[[s]]
k = 1
[[s]]
  [s.sub]
  y = { a = 1, b = [
   [1, 2], [3]]}
  [[s.arr]]
  z = """a\\""" b"""
  [[s.arr]]
  z = \'\'\'one
two\'\'\'
'''


def paths(value, path=()):
    """All key paths of plain data."""
    yield path
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in items:
        yield from paths(item, (*path, key))


def test_every_path_is_found_and_no_other():
    places = KeyPositions(TEXT)
    assert set(places.values) == set(places.keys) == set(paths(tomli.loads(TEXT))) - {()}


def test_places():
    places = KeyPositions(TEXT)
    assert places.locate(("title",)) == (1, 9)
    assert places.locate(("title",), key=True) == (1, 1)
    assert places.locate(("a", "b", "c d", 1, 2, "z.y", "w")) == (2, 54)
    assert places.locate(("a", "b", "c d", 2)) == (3, 3)
    assert places.locate(("t", "q.r")) == (5, 1)
    assert places.locate(("s", 1, "sub", "y", "b", 1, 0)) == (12, 13)
    assert places.locate(("s", 1, "arr", 1, "z")) == (16, 7)


def test_what_is_missing_is_where_its_table_begins():
    places = KeyPositions(TEXT)
    assert places.locate(("s", 0, "missing")) == (7, 1)
    assert places.locate(("s", 1, "sub", "y", "missing")) == (11, 3)
    assert places.locate(("missing",)) == (1, 1)
    assert places.locate(()) == (1, 1)


scalars = st.one_of(
    st.integers(-(2**62), 2**62),
    st.floats(allow_nan=False),
    st.booleans(),
    st.text(st.characters(exclude_categories=("Cs",)), max_size=12),
    st.datetimes(),
)
keys = st.text(st.characters(exclude_categories=("Cs",)), max_size=6) | st.sampled_from(["a", "b-c", "1", "x.y"])
values = st.recursive(
    scalars,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(keys, inner, max_size=3),
    max_leaves=12,
)


@given(st.dictionaries(keys, values, max_size=5), st.booleans())
@settings(deadline=None)
def test_any_text_that_tomli_w_writes(data, multiline):
    text = tomli_w.dumps(data, multiline_strings=multiline)
    places = KeyPositions(text)
    for path in paths(tomli.loads(text)):
        assert path == () or path in places.values, path
    lines = text.replace("\r\n", "\n").split("\n")
    for path in places.values:
        line, column = places.locate(path, key=True)
        if isinstance(path[-1], str) and path[-1].isascii() and path[-1].isalnum():
            assert path[-1] in lines[line - 1][column - 1 :]
