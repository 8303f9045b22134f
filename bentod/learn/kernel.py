"""What carries out the steps of groups of GVFs: numpy, or the same compiled, equal to the bit."""

from typing import Literal, Protocol, TypeAlias

from bentod.errors import ConfigError
from bentod.learn.lazy import Lazy, Step
from bentod.learn.lazy_compiled import CompiledKernel, missing
from bentod.learn.lazy_numpy import NumpyKernel

Wanted: TypeAlias = Literal["auto", "numpy", "compiled"]


class Steps(Protocol):
    """The steps of one group."""

    def step(self, step: Step) -> bool:
        """Learn from arriving in `Lazy.rows` with `Lazy.cumulants`, then predict: `Lazy.v`.

        False when the rows do not ascend within the features; then nothing has changed.
        """
        ...

    def fold(self, start: int, stop: int, kept: float) -> None:
        """Rows `start` up to `stop` pay what they owe since s was `kept`."""
        ...


class Kernel(Protocol):
    """A way to carry out steps. They work on `Lazy` in place: any can go on where another was."""

    @property
    def name(self) -> str:
        """For the report at the start, e.g. "compiled (gcc 12.2)"."""
        ...

    def bind(self, lazy: Lazy) -> Steps:
        """What carries out the steps of the group with this state."""
        ...


def choose(wanted: Wanted = "auto") -> Kernel:
    """The kernel that the config wants; "auto" is the compiled one where there is one.

    Raises:
        ConfigError: "compiled" is wanted, and this installation has none.
    """
    if wanted == "numpy":
        return NumpyKernel()
    lack = missing()
    if not lack:
        return CompiledKernel()
    if wanted == "auto":
        return NumpyKernel()
    raise ConfigError(
        f'learn.kernel = "compiled": {lack}. It is built when bentod is installed where there is a C '
        'compiler (on Debian: apt install gcc; then install bentod again). "auto" and "numpy" do without.',
        "learn.kernel",
    )
