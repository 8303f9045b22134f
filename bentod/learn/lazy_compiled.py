"""One step of `bentod.learn.lazy`, by kernel.c, if that was compiled when the package was built."""

import ctypes
import hashlib
from functools import cache
from pathlib import Path

import numpy as np

from bentod.learn.lazy import REACH, Lazy, Step

SOURCE = Path(__file__).with_name("kernel.c")
LIBRARY = Path(__file__).with_name("_kernel.so")

_WHOLE, _NUMBER = ctypes.c_ssize_t, ctypes.c_double
_POINTERS = ("c", "stale", "active", "rows", "before", "share", "cumulants", "d", "d_old", "v", "v_old")
_MORE_POINTERS = ("delta", "peak", "base", "initial", "resets")


class _Layout(ctypes.Structure):
    """`Lazy` of kernel.c."""

    _fields_ = (
        *((name, _WHOLE) for name in ("features", "gvfs", "stride")),
        ("weights", ctypes.c_void_p),
        *((name, ctypes.c_void_p) for name in _POINTERS + _MORE_POINTERS),
        *((name, _NUMBER) for name in ("alpha", "negligible", "reach")),
        ("online", _WHOLE),
    )


@cache
def _library() -> ctypes.CDLL:
    """Raises OSError: it cannot be loaded. The interpreter runs on while it works."""
    return ctypes.CDLL(str(LIBRARY))


@cache
def missing() -> str:
    """Why there is no compiled kernel, as a clause; empty when there is one.

    One that was compiled from another source may have another layout of its arguments, and is not used.
    """
    try:
        built_from = _library().kernel_source
        built_from.restype = ctypes.c_char_p
        found = bytes(built_from() or b"").decode()
    except (OSError, AttributeError):
        return "no compiled kernel was built, or it is for another system"
    if found != hashlib.sha256(SOURCE.read_bytes()).hexdigest():
        return "the compiled kernel is older than its source"
    return ""


class CompiledKernel:
    """To be made only when `missing` says nothing."""

    def __init__(self) -> None:
        compiler = _library().kernel_compiler
        compiler.restype = ctypes.c_char_p
        self._name = f"compiled ({bytes(compiler()).decode()})"

    @property
    def name(self) -> str:
        """As in `Kernel`."""
        return self._name

    def bind(self, lazy: Lazy) -> "CompiledSteps":
        """As in `Kernel`."""
        return CompiledSteps(lazy)


class CompiledSteps:
    """The steps of one group."""

    def __init__(self, lazy: Lazy) -> None:
        self._arrays = lazy, np.zeros(len(lazy.c))  # for as long as the layout points to them
        self._layout = _layout(*self._arrays)
        self._reference = ctypes.byref(self._layout)
        kind = lazy.weights.dtype.name
        # By subscript, not as an attribute, a function is no other group's: its argument types are set here.
        self._step = _library()[f"step_{kind}"]
        self._step.restype = ctypes.c_int
        self._step.argtypes = (ctypes.c_void_p, _WHOLE, _WHOLE, *[_NUMBER] * 5, *[_WHOLE] * 3)
        self._fold = _library()[f"fold_{kind}"]
        self._fold.restype = None
        self._fold.argtypes = (ctypes.c_void_p, _WHOLE, _WHOLE, _NUMBER)

    def step(self, step: Step) -> bool:
        """As in `Steps`."""
        return not self._step(self._reference, *step)

    def fold(self, start: int, stop: int, kept: float) -> None:
        """As in `Steps`."""
        self._fold(self._reference, start, stop, kept)


def _layout(lazy: Lazy, share: np.ndarray[tuple[int], np.dtype[np.float64]]) -> _Layout:
    layout = _Layout(*lazy.weights.shape, lazy.weights.strides[0] // lazy.weights.itemsize)
    layout.weights = lazy.weights.ctypes.data
    for name in _POINTERS + _MORE_POINTERS:
        array = share if name == "share" else getattr(lazy, name)
        setattr(layout, name, array.ctypes.data)
    layout.alpha, layout.negligible, layout.reach = lazy.alpha, lazy.negligible, REACH
    layout.online = lazy.online
    return layout
