"""A run of another program is another run: every source of the package counts, not those of kernels and laws alone."""

from __future__ import annotations

import pytest

from dem_cli.app.sweep.identity import PACKAGE, hash_of_sources, program


@pytest.fixture
def package(tmp_path):
    (tmp_path / "statics").mkdir()
    (tmp_path / "statics" / "equilibrium.py").write_text("TOLERANCE = 1e-5\n")
    (tmp_path / "api.py").write_text("")
    return tmp_path


def test_an_edited_solver_is_another_program(package):
    before = hash_of_sources(package)
    assert hash_of_sources(package) == before
    (package / "statics" / "equilibrium.py").write_text("TOLERANCE = 1e-4\n")
    assert hash_of_sources(package) != before


def test_a_file_that_moved_is_another_program(package):
    before = hash_of_sources(package)
    (package / "statics" / "equilibrium.py").rename(package / "equilibrium.py")
    assert hash_of_sources(package) != before


def test_compiled_files_do_not_count(package):
    before = hash_of_sources(package)
    (package / "api.pyc").write_bytes(b"compiled")
    assert hash_of_sources(package) == before


def test_the_program_has_its_sources_and_versions():
    assert hash_of_sources(PACKAGE) in program()
    assert "numba " in program()
