# SPDX-License-Identifier: MIT
"""An exception for each error of the library: grobo.errors.Timeout for GROBO_ERR_TIMEOUT.

Where Python has an exception of that meaning, ours is one of it too, so that `except TimeoutError`
and `except FileNotFoundError` do what they say.
"""

import typing

from grobo._lib import ffi, lib


class Error(Exception):
    """What the library refused, or could not do.

    `code` is the number of error.h, `joint` and `value` say what it is about where that is known,
    and `unit` is that of the value: for a limit the joint's name and the angle as the caller gave
    it ("rad" or "deg"), for a safety stop the joint and the value in the unit of the reason.
    `limits` are the two limits of an angle that is outside, in the same unit.

    >>> str(error(lib.GROBO_ERR_TIMEOUT, "move", joint="NECK_Y"))
    'move: no reply in time (NECK_Y)'
    >>> isinstance(error(lib.GROBO_ERR_TIMEOUT, "move"), TimeoutError)
    True
    """

    code = 0
    unit: typing.Optional[str] = None
    told: typing.Optional[str] = None  # instead of the library's words, where these say less
    limits: typing.Optional[typing.Tuple[float, float]] = None

    def __init__(
        self,
        what: str,
        joint: typing.Optional[str] = None,
        value: typing.Optional[float] = None,
        reason: typing.Optional[str] = None,
    ) -> None:
        self.what = what
        self.joint = joint
        self.value = value
        self.reason = reason
        super().__init__(what, joint, value, reason)

    def __str__(self) -> str:
        text = self.told or ffi.string(lib.grobo_error_text(self.code)).decode()
        about = [str(part) for part in (self.reason, self.joint) if part is not None]
        if self.value is not None:
            value = f"{self.value:.6g}" + (f" {self.unit}" if self.unit else "")
            if self.limits is not None:
                low, high = self.limits
                value += f" is not within {low:.4g} to {high:.4g} {self.unit}"
            about.append(value)
        return f"{self.what}: {text}" + (f" ({', '.join(about)})" if about else "")


_ALSO: typing.Dict[str, typing.Tuple[type, ...]] = {
    "ARG": (ValueError,),
    "NOMEM": (MemoryError,),
    "LIMIT": (ValueError,),
    "SPEED": (ValueError,),
    "NAN": (ValueError,),
    "TIMEOUT": (TimeoutError,),
    "NOENT": (FileNotFoundError,),
    "PERM": (PermissionError,),
    "UNPLUGGED": (ConnectionError,),
    "CLOSED": (ConnectionError,),
    "SYNTAX": (ValueError,),
    "NOTFOUND": (LookupError,),
    "EXISTS": (FileExistsError,),
    "ISDIR": (IsADirectoryError,),
}

# What would read as one word of no language.
_NAMES: typing.Dict[str, str] = {
    "NOMEM": "OutOfMemory",
    "NAN": "NotFinite",
    "NOENT": "NoSuchFile",
    "NOTFOUND": "NoSuchName",
    "PERM": "PermissionDenied",
    "ISDIR": "IsDirectory",
}

BY_CODE: typing.Dict[int, typing.Type[Error]] = {}
for _code, _symbol in ffi.typeof("grobo_error").elements.items():
    if _code < 0:
        _name = _symbol[len("GROBO_ERR_") :]
        _called = _NAMES.get(_name, _name.capitalize())
        _class = type(
            _called,
            (Error, *_ALSO.get(_name, ())),
            {"code": _code, "__module__": __name__, "__doc__": ffi.string(
                lib.grobo_error_text(_code)).decode()},
        )
        BY_CODE[_code] = _class
        globals()[_called] = _class


def error(
    code: int,
    what: str,
    joint: typing.Optional[str] = None,
    value: typing.Optional[float] = None,
    reason: typing.Optional[str] = None,
) -> Error:
    """The exception of a result below 0."""
    return BY_CODE.get(code, Error)(what, joint, value, reason)


def check(result: int, what: str) -> int:
    """The result, or its exception."""
    if result < 0:
        raise error(result, what)
    return result


def __getattr__(name: str) -> typing.Type[Error]:
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
