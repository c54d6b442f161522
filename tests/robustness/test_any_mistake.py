"""Whatever is changed in a good case: it is read, or refused with file and line; nothing else happens."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
import tomli_w
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from dem_cli.app.api import build_model, load_case
from dem_cli.errors import DemError

ROOT = Path(__file__).resolve().parents[2]
TEXTS = [path.read_text(encoding="utf-8") for path in sorted((ROOT / "dem_cli/app/cli/templates").glob("*.toml"))]
EXTRA = """
[[interface]]
between = ["a", "b"]
joint = "dry"
[reference]
failure_load = 0.5
tolerance = 0.01
"""
EXTRA_IN_THE_PLANE = """
[[settlement]]
block = "base"
displacement = [0.0, -0.01]
"""
QUICK = settings(deadline=None, max_examples=60, suppress_health_check=list(HealthCheck))

words = st.sampled_from(["", "auto", "wall", "x", "kind", "stone", "dry", "live", "settlement", "é\n\"'"])
scalars = st.one_of(st.booleans(), st.integers(-5, 50), st.floats(), words, st.dates())
values = st.recursive(
    scalars,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(words, inner, max_size=3),
    max_leaves=5,
)


def nodes(value, path=()):
    """Every place in plain data."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in list(items):
        yield value, key, (*path, key)
        yield from nodes(item, (*path, key))


BUILT: set[str] = set()  # cases as they were read: what is typed into a remark is the same one again


def outcome(path: Path, overrides: tuple[str, ...] = ()) -> None:
    """Read the case and build it, if none like it was; what is refused is refused in our words, one line each."""
    try:
        loaded = load_case(path, overrides)
        if (read := repr(loaded.case)) not in BUILT:
            build_model(loaded)
            BUILT.add(read)
    except DemError as error:
        refused = error
    else:
        return
    assert refused.exit_code == 2
    lines = str(refused).splitlines()
    assert lines
    for line in lines:
        assert line.startswith((f"{path}:", "--set ")), line
        assert "pydantic" not in line
        assert "Input should" not in line


@pytest.mark.parametrize("text", TEXTS)
@given(data=st.data())
@QUICK
def test_any_value_or_key(tmp_path, text, data):
    tables = tomllib.loads(text + EXTRA + EXTRA_IN_THE_PLANE * ("dimension = 3" not in text))
    for _ in range(data.draw(st.integers(1, 3))):
        places = list(nodes(tables))
        holder, key, _ = places[data.draw(st.integers(0, len(places) - 1))]
        change = data.draw(st.sampled_from(["replace", "remove", "rename"]))
        if change == "replace" or isinstance(holder, list):
            holder[key] = data.draw(values)
        else:
            item = holder.pop(key)
            if change == "rename":
                holder[key[:-1] or "k"] = item
    path = tmp_path / "case.toml"
    path.write_text(tomli_w.dumps(tables), encoding="utf-8")
    outcome(path)


@pytest.mark.parametrize("text", TEXTS)
@given(data=st.data())
@QUICK
def test_any_typing_error(tmp_path, text, data):
    at = data.draw(st.integers(0, len(text) - 1))
    length = data.draw(st.integers(0, 5))
    typed = data.draw(st.text(st.sampled_from("[]{}\"'=.,#\n 1a-\\\x00"), max_size=3))
    path = tmp_path / "case.toml"
    path.write_text(text[:at] + typed + text[at + length :], encoding="utf-8")
    outcome(path)


@given(data=st.data())
@QUICK
def test_any_override(tmp_path, data):
    path = tmp_path / "case.toml"
    path.write_text(TEXTS[0], encoding="utf-8")
    keys = [".".join(map(str, place)) for _, _, place in nodes(tomllib.loads(TEXTS[0]))]
    key = data.draw(st.sampled_from(keys)) + data.draw(st.sampled_from(["", ".x", ".0", "x", ".", '."a b"']))
    value = data.draw(st.sampled_from(["1", "-1", "x", "[1, 2]", "{a = 1}", "[", "", "true", "nan", "1979-05-27"]))
    outcome(path, (f"{key}={value}",))
