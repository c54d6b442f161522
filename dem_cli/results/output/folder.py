"""Output directory of a run: results appear in it complete or not at all.

Files are written into a hidden folder beside the final one and renamed into place. Where that cannot be
(a mount point, the current folder, an unwritable parent, `--force` among other files) the hidden folder
lies inside and only files of ours are moved. A lock, freed by the system when its owner dies, tells the
leftovers of a killed run from a run that goes on; another one beside the folder refuses a second run into it.
"""

from __future__ import annotations

import errno
import json
import os
import re
import secrets
import shutil
import time
from contextlib import suppress
from pathlib import Path
from types import TracebackType

from dem_cli.errors import DemError, OutputError, UsageError
from dem_cli.results.output.resume.leftovers import in_use

SUMMARY = "summary.json"
OWN_NAMES = frozenset(
    (
        SUMMARY,
        "results.h5",
        "blocks.vtkhdf",
        "contacts.vtkhdf",
        "joints.vtkhdf",
        "links.vtkhdf",
        "joints.csv",
        "joints.png",
        "case.toml",
        "capacity.png",
        "collapse.png",
        "energy.png",
        "history.csv",
        "histories.png",
        "collapse.gif",
        "calibration.csv",
        "fragility.csv",
        "fragility.png",
        "repeats.csv",
        "calibration.png",
        "calibrated.toml",
        "records",
        "spectra.png",
        "motion.png",
        "modes.png",
        "safety.png",
        "plot.png",
        "render.png",
        "render.gif",
        "render.mp4",
        "report.html",
        "pvd",
    )
)
OWN_KEYS = frozenset(("title", "kind", "version", "status"))  # what every summary.json of ours has
INTERRUPTED_SUFFIX = ".interrupted"  # suffix of the sibling that keeps a partial result beside a complete one
JOURNAL = ".dem-runs"  # suffix of the hidden file that keeps finished runs for --resume
CHECKPOINTS = ".dem-stages"  # suffix of the hidden folder that keeps the stages of one run for --resume
CLAIM = ".dem-lock"  # suffix of the hidden file that a run holds while it is to write there
_LOCK = ".lock"
_NEW, _OLD = "dem-new", "dem-old"
_REASONS = {
    errno.ENOSPC: "no space left on the device",
    errno.EDQUOT: "the disk quota is used up",
    errno.EFBIG: "the file size limit is reached",
    errno.EACCES: "permission denied",
    errno.EPERM: "permission denied",
    errno.EROFS: "the file system is read-only",
    errno.ENAMETOOLONG: "the name is too long",
    errno.ENOTDIR: "a part of the path is a file",
    errno.EEXIST: "a part of the path is a file",
}


def write_error(error: Exception, path: Path) -> DemError:
    """Convert a failed write to one clear error; HDF5 hides the reason in its text."""
    number = getattr(error, "errno", None)
    hidden = re.search(r"errno = (\d+)", str(error))
    if number is None and hidden:
        number = int(hidden.group(1))
    if number in (errno.ENOTDIR, errno.EEXIST):
        return UsageError(f"cannot write results to {path}: {_REASONS[number]}")
    reason = _REASONS.get(number or 0) or getattr(error, "strerror", None) or str(error).splitlines()[0]
    return OutputError(f"cannot write results to {path}: {reason}")


def _own_summary(folder: Path) -> dict[str, object] | None:
    try:
        summary = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    return summary if isinstance(summary, dict) and summary.keys() >= OWN_KEYS else None


def require_folder(folder: Path) -> None:
    """Raise UsageError where there is no folder of this name, with the command that makes one."""
    if folder.is_dir():
        return
    if not folder.exists():
        raise UsageError(f"{folder}: no such folder; `dem run CASE.toml` makes results/CASE")
    if folder.suffix == ".toml":
        made = f"`dem run {folder}` makes {Path('results') / folder.stem}"
        raise UsageError(f"{folder}: a case, not a folder of results; {made}")
    raise UsageError(f"{folder}: a file, not a folder of results; give the folder that it is in")


def is_ours(folder: Path) -> bool:
    """Test whether `folder` contains the results of a run, by its summary.json."""
    return _own_summary(folder) is not None


def is_complete(folder: Path) -> bool:
    """Test whether `folder` contains results of a run that was not interrupted."""
    summary = _own_summary(folder)
    return summary is not None and summary["status"] != "interrupted"


def foreign_names(folder: Path) -> list[str]:
    """List the files in `folder` that `dem` did not write; its own leftovers are not counted."""
    ours = re.compile(rf"\..*(({_NEW}|{_OLD})-|({'|'.join(map(re.escape, (JOURNAL, CHECKPOINTS, CLAIM)))})$)")
    names = sorted(path.name for path in folder.iterdir() if not ours.match(path.name))
    names = [name for name in names if not (name.endswith(INTERRUPTED_SUFFIX) and is_ours(folder / name))]
    return [name for name in names if name not in OWN_NAMES] if is_ours(folder) else names


class OutputFolder:
    """Output folder of a run: write to `path`; `commit()` gives it the final name, leaving the block discards it."""

    def __init__(self, final: Path | str, *, force: bool = False, recover: bool = True):
        self.name = str(final)
        self.final = Path(final).resolve()
        self.force, self.recover = force, recover  # recover: look for what killed runs left there
        self._made: list[Path] = []
        self._lock: int | None = None
        self._claim: int | None = None
        if self.final.exists() and not self.final.is_dir():
            raise UsageError(f"output folder {self.name}: a file of that name exists")
        try:
            self._open()
        except BaseException as error:
            self.discard()
            if not isinstance(error, OSError):
                raise
            raise write_error(error, Path(self.name)) from None

    def _open(self) -> None:
        self._make_parents()
        if self.recover:
            self._claim_file = self._claim_place()
            self._claim = claimed(self._claim_file)
            if self._claim is None:
                raise in_use(Path(self.name))
            self._recover(self.final.parent)
            if self.final.is_dir():
                self._recover(self.final)
        self._refuse_foreign()
        self.inside = self._must_be_inside()
        base = self.final if self.inside else self.final.parent
        self.path = base / self._hidden(_NEW)
        self.path.mkdir()
        self._lock = _lock(self.path / _LOCK)

    def _claim_place(self) -> Path:
        """Choose the place of the lock: beside the folder, or inside where its parent is not writable."""
        alone = self.final.is_dir() and (os.path.ismount(self.final) or not os.access(self.final.parent, os.W_OK))
        return (self.final if alone else self.final.parent) / f".{self.final.name}{CLAIM}"

    def _hidden(self, kind: str) -> str:
        return f".{self.final.name}.{kind}-{secrets.token_hex(4)}"

    def _refuse_foreign(self) -> None:
        self.foreign = foreign_names(self.final) if self.final.is_dir() else []
        if self.foreign and not self.force:
            shown = ", ".join(self.foreign[:3]) + (", ..." if len(self.foreign) > 3 else "")
            raise UsageError(
                f"output folder {self.name}: holds files that dem did not write ({shown}); "
                "choose another with -o, or keep them beside the results with --force"
            )

    def _must_be_inside(self) -> bool:
        if not self.final.is_dir():
            return False
        cwd = Path.cwd()
        in_use = self.final == cwd or self.final in cwd.parents or os.path.ismount(self.final)
        return bool(self.foreign) or in_use or not os.access(self.final.parent, os.W_OK)

    def _make_parents(self) -> None:
        missing = [p for p in (self.final.parent, *self.final.parent.parents) if not p.exists()]
        for folder in reversed(missing):
            folder.mkdir(exist_ok=True)
            self._made.append(folder)

    def _recover(self, base: Path) -> None:
        """Remove the leftovers of killed runs; restores earlier results that one had put aside."""
        if not base.is_dir():
            return
        stem = f".{self.final.name}."
        for name in sorted(path.name for path in base.iterdir()):
            if name.startswith(f"{stem}{_NEW}-") and abandoned(base / name):
                shutil.rmtree(base / name, ignore_errors=True)
            elif name.startswith(f"{stem}{_OLD}-") and base != self.final:
                if self.final.exists():
                    shutil.rmtree(base / name, ignore_errors=True)
                else:
                    (base / name).rename(self.final)

    def commit(self, name: str | None = None) -> Path:
        """Move the folder to its final name, or to the sibling `name`; earlier results are removed only now."""
        try:
            self._unlock()
            if name is not None and name != self.final.name:
                return self._commit_beside(name)
            if self.inside:
                self._move_files(self.final)
            else:
                _replace_folder(self.path, self.final, self.final.parent / self._hidden(_OLD))
        except OSError as error:
            raise write_error(error, Path(self.name)) from None
        return self.final

    def _commit_beside(self, name: str) -> Path:
        base = self.final if self.inside else self.final.parent
        target = base / name
        if target.exists() and foreign_names(target):
            raise OutputError(f"cannot write results to {target}: it holds files that dem did not write")
        _replace_folder(self.path, target, base / self._hidden(_OLD))
        return target

    def _move_files(self, target: Path) -> None:
        """Replace files in a folder that stays: the old summary is removed first, the new one added last."""
        (target / SUMMARY).unlink(missing_ok=True)
        for name in sorted(OWN_NAMES - {SUMMARY}):
            if (self.path / name).exists():
                _remove(target / name)
                (self.path / name).rename(target / name)
            elif not self.foreign:
                _remove(target / name)
        (self.path / SUMMARY).rename(target / SUMMARY)

    def discard(self) -> None:
        """Remove what was written and the parents that were made for it; harmless after `commit`."""
        self._unlock()
        if hasattr(self, "path"):
            shutil.rmtree(self.path, ignore_errors=True)
        if self._claim is not None:
            self._claim_file.unlink(missing_ok=True)
            os.close(self._claim)
            self._claim = None
        for folder in reversed(self._made):
            try:
                folder.rmdir()
            except OSError:
                break

    def _unlock(self) -> None:
        if self._lock is not None:
            os.close(self._lock)
            (self.path / _LOCK).unlink(missing_ok=True)
            self._lock = None

    def __enter__(self) -> OutputFolder:
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.discard()


def _replace_folder(new: Path, final: Path, aside: Path) -> None:
    """Replace a folder by two renames; after a kill between them the next run restores the old results."""
    had_old = final.exists()
    if had_old:
        final.rename(aside)
    try:
        new.rename(final)
    except OSError:
        if had_old:
            aside.rename(final)
        raise
    if had_old:
        shutil.rmtree(aside, ignore_errors=True)


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _lock(path: Path) -> int:
    handle = os.open(path, os.O_CREAT | os.O_RDWR, 0o644)
    _try_flock(handle)
    return handle


def _try_flock(handle: int) -> bool:
    """Take a file lock without waiting; where there are no locks nothing ever counts as abandoned."""
    try:
        import fcntl

        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (ImportError, OSError):
        return False
    return True


def claimed(path: Path) -> int | None:
    """Create and lock a lock file; None where another run has it. Its owner removes it at last."""
    while True:
        file = os.open(path, os.O_CREAT | os.O_RDWR, 0o644)
        if not locked(file):
            os.close(file)
            return None
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(file), path.stat()):
                return file
        os.close(file)  # its last owner removed it meanwhile


def abandoned(folder: Path) -> bool:
    """Test whether no process writes to this hidden folder any more."""
    try:
        handle = os.open(folder / _LOCK, os.O_RDWR)
    except FileNotFoundError:  # just made, or just about to be renamed, unless it is old
        return time.time() - folder.stat().st_mtime > 60.0
    except OSError:
        return False
    free = _try_flock(handle)
    os.close(handle)
    return free


def locked(file: int, shared: bool = False) -> bool:
    """Take a file lock, which the system frees when its owner dies; False where another process has it.

    shared: others who share it may have it as well.
    """
    try:
        import fcntl
    except ImportError:  # no locks here: nobody is known to have it
        return True
    try:
        fcntl.flock(file, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # a file system without locks
        return True
    return True
