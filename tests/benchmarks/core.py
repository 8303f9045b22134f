"""The numbers of the whole: what a tick costs, how soon it obeys, how late it is, how fast it learns."""

from collections.abc import Iterator

from tests.benchmarks import cost, lateness, learning, reaction
from tests.benchmarks.harness import Row, main


def rows() -> Iterator[Row]:
    """About four minutes, on a machine that should have nothing else to do."""
    for part in (lateness, reaction, cost, learning):  # a host may slow down those who have just been busy
        yield from part.rows()


if __name__ == "__main__":
    main("core", rows())
