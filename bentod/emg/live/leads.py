"""Channels that are recognised but have no site: how their leads are judged."""

from collections.abc import Collection

from bentod.emg.classify.model import Model
from bentod.emg.contact import Wired
from bentod.emg.recognition import REST


def unwatched(model: Model | None, channels: Collection[int], watched: Collection[int]) -> list[Wired]:
    """What is to be judged of those of `channels` that no site watches.

    Nobody told how loud these are, but training did, of all channels together: one that alone is louder than
    all of them were at rest is heard, and one that alone is as loud as all ever were is at its greatest.
    """
    if model is None:
        return []
    known = model.ranges
    loud = max(found.greatest for found in known.values())
    quiet = known[REST].greatest if REST in known else loud
    return [Wired(f"channel {one}", one, quiet, loud) for one in channels if one not in watched]
