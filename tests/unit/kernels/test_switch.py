"""The next numba stops nothing: what surprises the own way throws the switch, and numba as it comes does the work."""

from __future__ import annotations

import ast
import importlib
import os
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest
from casefiles import CASES
from parsed import nodes

import dem_cli
from dem_cli.core.kernels import jit
from dem_cli.core.kernels.compilation import callees, machine_code, private_names, shortcuts
from dem_cli.core.kernels.compilation.door import Door
from dem_cli.core.kernels.compilation.kept_code import may_be_kept
from dem_cli.core.kernels.compilation.numba_setup import set_up_numba
from dem_cli.core.kernels.compilation.plain_numba import PlainKernel
from dem_cli.core.kernels.compilation.private_names import PRIVATE_NAMES, TRIED, check_private_names
from dem_cli.core.kernels.compilation.switch import SWITCH, Surprise, Switch

FOLDER = Path(private_names.__file__).parent
PACKAGE = Path(dem_cli.__file__).parent
PUBLIC = {"numba", "numba.extending"}
OF_NAMED_TUPLES = {"_asdict", "_fields", "_replace"}
NAMES = [(module, name) for module, names in PRIVATE_NAMES.items() for name in names]


@pytest.fixture
def door(monkeypatch, tmp_path):
    """A process that has compiled nothing yet, as far as kernels know."""
    monkeypatch.delenv("DEM_STRICT_KERNELS")
    monkeypatch.setenv("DEM_CACHE_DIR", str(tmp_path))
    set_up_numba()
    monkeypatch.setattr(SWITCH, "reason", None)
    monkeypatch.setattr(SWITCH, "remarks", [])
    monkeypatch.setattr(jit, "_door", Door())
    shortcuts.leave_shortcuts()
    yield jit._door
    monkeypatch.undo()
    machine_code.take_own_way()
    set_up_numba()


def rename(module: str, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """What a next version may do to a name of the table."""
    path, kept = name.partition("(")[0].partition(": ")[::2]
    *owners, last = path.split(".")
    owner = importlib.import_module(module)
    for part in owners:
        owner = getattr(owner, part)
    if not kept:
        for one in getattr(owner, "__mro__", [owner]):
            if one is not object and last in vars(one):
                monkeypatch.delattr(one, last)
        return
    for one in getattr(owner, last).__mro__:
        for function in vars(one).values():
            code = getattr(function, "__code__", None)
            if code is not None and kept in code.co_names:
                names = tuple(f"{each}_" if each == kept else each for each in code.co_names)
                monkeypatch.setattr(function, "__code__", code.replace(co_names=names))


@pytest.fixture
def numba_as_it_comes():
    """Without what an earlier test may have put into it."""
    shortcuts.leave_shortcuts()
    yield
    machine_code.take_own_way()


@pytest.mark.usefixtures("numba_as_it_comes")
@pytest.mark.parametrize(("module", "name"), NAMES, ids=[f"{module}:{name}" for module, name in NAMES])
def test_each_name_that_is_gone_is_missed(module, name, monkeypatch):
    check_private_names()
    rename(module, name, monkeypatch)
    with pytest.raises(Surprise, match="numba"):
        check_private_names()


def stored_in_self(tree: ast.Module) -> set[str]:
    nodes = [node for node in ast.walk(tree) if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store)]
    return {node.attr for node in nodes if isinstance(node.value, ast.Name) and node.value.id == "self"}


def imported_from_numba(tree: ast.Module) -> set[str]:
    """What is no public name of it."""
    found = set()
    for node in ast.walk(tree):
        module = str(getattr(node, "module", "")) if isinstance(node, ast.ImportFrom) else ""
        if module.split(".")[0] in ("numba", "llvmlite") and module not in PUBLIC:
            found |= {f"{module}.{each.name}" for each in node.names}
    return found - {"numba.core.base", "numba.core.cgutils", "numba.core.event", "numba.core.types"}


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.py")), ids=lambda path: path.stem)
def test_all_private_names_are_asked_for(path):
    """What files import from numba and LLVM, and what begins with an underscore and is not theirs."""
    asked = [f"{module}.{name.partition('(')[0].replace(': ', '.')}" for module, name in NAMES]
    beginnings = {name[: len(name) - len(end)] for name in asked for end in ("", *endings(name))}
    tree = ast.parse(path.read_text("utf-8"))
    imported = imported_from_numba(tree)
    own = {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    used = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute) and node.attr.startswith("_")}
    private = {name for name in used if not name.endswith("__")} - own - stored_in_self(tree) - OF_NAMED_TUPLES
    assert imported - beginnings - {"llvmlite.binding"} == set()
    if imported:
        assert private - {name.rpartition(".")[2] for name in asked} == set()


def endings(name: str) -> list[str]:
    parts = name.split(".")
    return ["." + ".".join(parts[k:]) for k in range(1, len(parts))]


def test_one_folder_knows_numba():
    for path in PACKAGE.rglob("*.py"):
        names = set()
        for node in nodes(path):
            if isinstance(node, ast.Import):
                names |= {each.name for each in node.names}
            elif isinstance(node, ast.ImportFrom):
                names.add(str(node.module))
        of_numba = {name for name in names if name.split(".")[0] in ("numba", "llvmlite")}
        assert path.parent == FOLDER or not of_numba, path
        if path.name in ("plain_numba.py", "door.py", "function_copies.py", "switch.py"):
            assert of_numba <= PUBLIC, path


def tiny(shift=0.1):
    """A kernel with what it calls, declared anew: one of each kind."""

    def scaled(x, factor):
        return factor * x

    def shifted(x):
        return x + shift

    def third(x):
        raise NotImplementedError

    jit.inline(scaled)
    jit.always_inline(shifted)
    jit.overload(third)(lambda x: lambda x: x / 3.0)

    @jit.kernel
    def fill(array, factor):
        for i in range(array.size):
            array[i] = third(shifted(scaled(array[i], factor)))
        return array[0]

    return fill


def check_tiny(fill, shift=0.1) -> None:
    array = np.arange(4.0)
    assert fill(array, 0.7) == array[0]
    assert list(array) == [(0.7 * i + shift) / 3.0 for i in range(4)]
    assert fill.bound()(array, 0.7) == array[0]


@pytest.mark.parametrize("how", ["name", "signature", "version", "answer", "by hand", "nothing"])
def test_a_surprise_throws_the_switch(how, door, monkeypatch):
    fill = tiny()
    with monkeypatch.context() as patched:
        if how == "name":
            rename("numba.core.codegen", "JITCodeLibrary._get_compiled_object(self)", patched)
        elif how == "signature":
            patched.setattr(numba.core.caching.FunctionCache, "_index_key", lambda self, key: key)
        elif how == "version":
            patched.setattr(numba, "__version__", "0.99.0")
        elif how == "answer":
            patched.setattr(machine_code, "compiled", lambda function: lambda *given: True)
        elif how == "by hand":
            patched.setenv("DEM_PLAIN_NUMBA", "1")
        fill._made()
    said = {"name": "has no JITCodeLibrary._get_compiled_object", "signature": "has no FunctionCache._index_key",
            "version": f"numba 0.99.0; {TRIED}x is what", "answer": "another answer than Python",
            "by hand": "DEM_PLAIN_NUMBA is set"}  # fmt: skip
    check_tiny(fill)
    if how == "nothing":
        assert door.way is machine_code
        assert SWITCH.said() == []
    else:
        assert isinstance(fill._made(), PlainKernel)
        assert len(SWITCH.said()) == 1
        assert said[how] in SWITCH.said()[0]
        assert not jit.threads_may_share()


def test_the_guide_shows_what_a_run_says(monkeypatch):
    monkeypatch.setenv("DEM_PLAIN_NUMBA", "1")
    switch, guide = Switch(), (PACKAGE.parent / "docs" / "guide" / "install.md").read_text(encoding="utf-8")
    assert not switch.own_way()
    assert f"in a line `compilation`:\n`{switch.said()[0]}`." in guide
    assert f"tried with, {TRIED.rstrip('.')}." in guide
    assert "`DEM_PLAIN_NUMBA=1`" in guide


@pytest.mark.parametrize("after", [0, 1])
def test_a_surprise_while_it_compiles_is_one_as_well(after, door, monkeypatch):
    """After numba was told of the functions: the other way takes copies of them. Kernels of before go it too."""
    was, left = callees.CalleePass.run_pass, [after * 100]
    before, fill = tiny(), tiny(0.2)

    def run_pass(self, state):
        left[0] -= 1
        if left[0] < 0:
            raise AttributeError("no such thing")
        return was(self, state)

    if after:
        check_tiny(before)
        assert door.way is machine_code
    monkeypatch.setattr(callees.CalleePass, "run_pass", run_pass)
    left[0] = 0
    for each, shift in ((fill, 0.2), (before, 0.1), (tiny(0.3), 0.3)):
        check_tiny(each, shift)
        assert isinstance(each._made(), PlainKernel)
    assert SWITCH.reason == "AttributeError: no such thing"


def test_a_cache_that_fails_costs_no_answer(door, monkeypatch):
    monkeypatch.setattr(machine_code, "keep_compiled", lambda *given: {}[given])
    fill = tiny()
    check_tiny(fill)
    assert str(SWITCH.reason).startswith("KeyError")
    later = tiny()
    check_tiny(later)
    assert isinstance(later._made(), PlainKernel)


def test_a_fault_of_a_kernel_is_its_own(door):
    @jit.kernel
    def fails(array):
        if array[0] > 0.0:
            raise ZeroDivisionError
        array[0] = 1.0

    for _ in range(2):
        array = np.zeros(1)
        fails(array)
        with pytest.raises((ZeroDivisionError, RuntimeError)):
            fails(array)
        assert SWITCH.reason is None


def test_an_error_where_kernels_are_changed(monkeypatch):
    monkeypatch.setenv("DEM_STRICT_KERNELS", "1")
    with pytest.raises(Surprise, match="KeyError: 'x'"):
        Switch().throw(KeyError("x"))
    with pytest.raises(Surprise, match="never kept"):
        Switch().remark("never kept", fault=True)
    monkeypatch.delenv("DEM_STRICT_KERNELS")
    switch = Switch()
    switch.remark("never kept", fault=True)
    assert switch.said() == ["never kept"]


@pytest.mark.skipif(not may_be_kept(), reason="code is kept on Linux and x86-64 alone")
def test_what_cannot_be_kept_is_said(door, monkeypatch):
    @jit.kernel
    def pair(x):
        return x, x

    assert pair(1.0) == (1.0, 1.0)
    assert [said.rpartition(": ")[2] for said in SWITCH.said()] == ["it returns UniTuple(float64 x 2)"]
    assert SWITCH.own_way()
    pair.py_func.__module__ = "dem_cli.core.kernels.pair"  # a kernel of the package
    monkeypatch.setenv("DEM_STRICT_KERNELS", "1")
    with pytest.raises(Surprise, match="it returns UniTuple"):
        jit.kernel(pair.py_func)(2)


BUILT_IN = """
import numpy as np
from dem_cli.core.kernels.jit import kernel
from dem_cli.core.kernels.tiles.lanes import lowest_bit
from dem_cli.core.kernels.tiles.team import N_TEAM, join, new_team, wait
from dem_cli.core.kernels.vec import in_a_row, shaped_as

@kernel
def all_of_them(rows, team, bits, out):
    flat = in_a_row(rows)
    out[0] = flat[-1]
    shaped_as(flat, rows)[0, 1] = 7.0
    number, members = join(team)
    out[1], out[2] = wait(team, members, 0), number
    for i in range(bits.size):
        out[3 + i] = lowest_bit(bits[i])

given = [(np.arange(6.0).reshape(2, 3), new_team(), np.array([1, 12, -8, 1 << 62]), np.zeros(7)) for _ in range(2)]
all_of_them(*given[0])
all_of_them.py_func(*given[1])
assert [each.tobytes() for each in given[0]] == [each.tobytes() for each in given[1]], given
assert list(given[0][3]) == [5.0, 1.0, 0.0, 0.0, 2.0, 3.0, 62.0]
print(type(all_of_them._made()).__name__)
"""


def test_what_numba_has_no_code_for_is_done_in_its_own():
    environment = os.environ | {"DEM_PLAIN_NUMBA": "1"}
    done = subprocess.run([sys.executable, "-c", BUILT_IN], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["PlainKernel"]


NEXT_VERSION = """
import numba
from numba.core import caching
{patch}
"""
PATCHES = {
    "a next version": "numba.__version__ = '0.99.0'",
    "a renamed attribute": """
caching.Cache._fetch = caching.Cache._load_overload
caching.Cache.load_overload = lambda self, sig, context: self._fetch(sig, context)
del caching.Cache._load_overload
""",
}


def test_a_first_run_with_a_next_numba_answers(tmp_path):
    """The last digits as well. A fresh cache; the second of them finds what the first one kept by numba's own means."""
    case, less = CASES / "verification" / "sliding_block.toml", ["--set", "output.frames=0"]
    command = [sys.executable, "-m", "dem_cli", "run", str(case), "--json", *less]
    answers = []
    for name, patch in {"as it is": "", **PATCHES}.items():
        environment = os.environ.copy()
        if patch:
            folder = tmp_path / name
            folder.mkdir()
            (folder / "sitecustomize.py").write_text(NEXT_VERSION.format(patch=patch), encoding="utf-8")
            environment |= {"PYTHONPATH": f"{folder}{os.pathsep}{environment['PYTHONPATH']}"}
            environment |= {"DEM_CACHE_DIR": str(tmp_path / "cache"), "DEM_STRICT_KERNELS": ""}
        words = [*command, "-o", str(tmp_path / f"results of {name}")]
        done = subprocess.run(words, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        answers.append(done.stdout)
    timed = ("_seconds", '"created"', "versions", "numba")
    assert (
        len({tuple(line for line in each.splitlines() if not any(word in line for word in timed)) for each in answers})
        == 1
    )
