"""A Dask cluster that does the work of a sweep. Needs distributed."""

from collections.abc import Iterator, Sequence

from distributed import Client, as_completed

from bentod.errors import BentodError
from bentod.replay.sweep import Outcome, Point, Told, Work

PATIENCE = 10.0
"""s for the scheduler to answer."""


class NoCluster(BentodError):
    """The cluster must be started, or looked for elsewhere.

    Examples: nobody answers at the address, the scheduler has no workers.
    """

    code = "cluster"


def run(scheduler: str, work: Work, tried: Sequence[Point], told: Told) -> list[Outcome]:
    """What comes of all combinations, in their order; `told` hears of each as soon as it is there.

    Each worker of the scheduler at that address needs this bentod, and the recording at the same path. One
    that dies costs nobody else anything: Dask tries a few times again, and then its combination has failed.
    joblib's own way to Dask is not used, because it waits for ever for a combination whose workers died.

    Raises:
        NoCluster: there is nobody who could do it.
    """
    try:
        client = Client(scheduler, timeout=PATIENCE)
    except (OSError, TimeoutError, ValueError) as error:
        raise NoCluster(f"no Dask scheduler answers at {scheduler}: {error}") from error
    found: dict[int, Outcome] = {}
    with client:
        if not client.nthreads():
            raise NoCluster(f"the Dask scheduler at {scheduler} has no workers")
        for outcome in _outcomes(client, work, tried):
            found[outcome.point.place] = outcome
            told(outcome)
    return [found[point.place] for point in tried]


def _outcomes(client: Client, work: Work, tried: Sequence[Point]) -> Iterator[Outcome]:
    waiting = {client.submit(work, point, pure=False): point for point in tried}
    for future in as_completed(list(waiting)):
        error = future.exception()
        if error is None:
            outcome: Outcome = future.result()
            yield outcome
        else:
            why = f"{type(error).__name__}: {str(error).strip().partition(chr(10))[0]}"
            yield Outcome(waiting[future], failed=f"its process died: {why}")
