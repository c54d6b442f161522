"""Check for OpenGL libraries by ctypes before rendering: without them VTK ends the process.

To be called in a process that may die: a broken driver can take it along.
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator

from dem_cli.errors import UsageError

_CHOICE = "VTK_DEFAULT_OPENGL_WINDOW"  # environment variable that VTK reads (9.4 and later)
_OSMESA = ("libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so")
_DEVICE, _MOST_DEVICES = 0x313F, 16  # EGL_PLATFORM_DEVICE_EXT
MISSING = (
    "rendering needs graphics libraries, which this machine lacks; on Debian or Ubuntu:\n"
    "apt-get install libegl1 libgl1-mesa-dri   (or libosmesa6)\n"
    "`dem plot` draws its pictures without them"
)


def choose_window() -> None:
    """Configure VTK to draw without a display. Raises UsageError where it cannot; other systems need no choice."""
    if not sys.platform.startswith("linux") or os.environ.get(_CHOICE):
        return
    if egl_works():
        os.environ[_CHOICE] = "vtkEGLRenderWindow"
    elif any(loaded(name) for name in _OSMESA):
        os.environ[_CHOICE] = "vtkOSOpenGLRenderWindow"
    elif not display_works():
        raise UsageError(MISSING)


def loaded(name: str) -> ctypes.CDLL | None:
    """Load a shared library; None where it is missing."""
    try:
        return ctypes.CDLL(name)
    except OSError:
        return None


def egl_works() -> bool:
    """Test whether EGL opens a display as VTK needs it: of a device, a graphics card or Mesa in software, or the
    default.

    None of these needs an X server.
    """
    egl = loaded("libEGL.so.1")
    if egl is None:
        return False
    egl.eglGetProcAddress.restype = ctypes.c_void_p
    egl.eglGetDisplay.restype = ctypes.c_void_p
    egl.eglGetDisplay.argtypes = [ctypes.c_void_p]
    egl.eglInitialize.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p]
    return any(display and egl.eglInitialize(display, None, None) for display in _displays(egl))


def _displays(egl: ctypes.CDLL) -> Iterator[int | None]:
    """Yield the EGL displays of every device, then the default one."""
    query, display_of = (egl.eglGetProcAddress(name) for name in (b"eglQueryDevicesEXT", b"eglGetPlatformDisplayEXT"))
    if query and display_of:
        devices, count = (ctypes.c_void_p * _MOST_DEVICES)(), ctypes.c_int(0)
        pointer, number = ctypes.c_void_p, ctypes.c_int
        ask = ctypes.CFUNCTYPE(ctypes.c_uint, number, pointer, pointer)(query)
        if ask(_MOST_DEVICES, devices, ctypes.byref(count)):
            get = ctypes.CFUNCTYPE(pointer, ctypes.c_uint, pointer, pointer)(display_of)
            yield from (get(_DEVICE, devices[i], None) for i in range(count.value))
    yield egl.eglGetDisplay(None)


def display_works() -> bool:
    """Test whether there is an X server with OpenGL."""
    x = loaded("libX11.so.6") if os.environ.get("DISPLAY") and loaded("libGL.so.1") else None
    if x is None:
        return False
    x.XOpenDisplay.restype = ctypes.c_void_p
    x.XOpenDisplay.argtypes = [ctypes.c_char_p]
    return bool(x.XOpenDisplay(None))
