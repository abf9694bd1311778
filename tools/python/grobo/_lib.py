# SPDX-License-Identifier: MIT
"""The library and what cffi knows of it."""

import ctypes
import importlib
import os
import sys
from pathlib import Path
from typing import Any

ffi: Any = importlib.import_module("grobo._abi").ffi  # generate.py makes it
NAME = {"win32": "grobo.dll", "darwin": "libgrobo.1.dylib"}.get(sys.platform, "libgrobo.so.1")


def _path() -> str:
    """$GROBO_LIBRARY, else the library of the wheel, else the system's."""
    given = os.environ.get("GROBO_LIBRARY")
    if given:
        return given
    beside = Path(__file__).with_name(NAME)
    return str(beside) if beside.exists() else NAME


def _name_guard() -> None:
    """The grctl of the wheel, which the library starts as a guard; what is named already stays."""
    beside = Path(__file__).with_name("grctl.exe" if sys.platform == "win32" else "grctl")
    if beside.exists():
        os.environ.setdefault("GRCTL_GUARD", str(beside))


_name_guard()
lib: Any = ffi.dlopen(_path())
_quick = ctypes.PyDLL(_path())


def version() -> str:
    """Version of the library."""
    text: str = ffi.string(lib.grobo_version()).decode()
    return text


def _check_version() -> None:
    wanted = lib.GROBO_VERSION_MAJOR, lib.GROBO_VERSION_MINOR
    if tuple(map(int, version().split(".")[:2])) != wanted:
        raise ImportError(
            f"grobo: the library is version {version()}, this package needs "
            f"{wanted[0]}.{wanted[1]}; install both from one place, or set GROBO_LIBRARY"
        )


_check_version()


def new(kind: str) -> Any:
    """A zeroed structure; what begins with its size has it set, also inside."""
    made = ffi.new(kind + " *")
    _set_size(made[0])
    return made


def _set_size(struct: Any) -> None:
    for at, (name, field) in enumerate(ffi.typeof(struct).fields or ()):
        if at == 0 and name == "size":
            struct.size = ffi.sizeof(struct)
        elif field.type.kind == "struct" and field.type.fields:
            _set_size(getattr(struct, name))


def quick(name: str, *args: Any) -> int:
    """Calls a function that never waits, without giving up the interpreter's lock.

    Taking it back costs 5 ms beside a thread that computes. Never for a function that waits for
    the runner's thread's turn.
    """
    words = [
        ctypes.c_void_p(int(ffi.cast("uintptr_t", arg))) if isinstance(arg, ffi.CData) else arg
        for arg in args
    ]
    result: int = getattr(_quick, name)(*words)
    return result


def has(name: str) -> bool:
    """Whether the library and its headers have a function."""
    return hasattr(_quick, name) and hasattr(lib, name)


def us(seconds: float) -> int:
    return round(seconds * 1e6)
