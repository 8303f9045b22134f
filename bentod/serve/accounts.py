"""What all clients of a server share, and what those of one user share: time, patience and the log."""

from collections import OrderedDict
from collections.abc import Callable

from bentod.bucket import Bucket, Hush
from bentod.gate import Gate

MOST_USERS = 1024
"""That are remembered; whoever was heard of longest ago is forgotten first."""

BURST = 0.25
"""s of requests at their full rate that may come at once."""

COMPLAINTS = 10.0
"""s from one line in the log about the same thing and the same user to the next."""


class Account:
    """What one user, or one address, has used, whatever the number of its connections."""

    def __init__(self, requests_per_s: float, now: Callable[[], float]) -> None:
        self.turns = Bucket(requests_per_s, max(1.0, BURST * requests_per_s), now)
        self.last_resort = False
        """Whether one of its connections, beyond those that it may have, is there to stop the arm."""


class Shared:
    """Of one server. `hush` is for whatever clients can bring about in the log."""

    def __init__(self, gate: Gate, requests_per_s: float, now: Callable[[], float]) -> None:
        self.gate = gate
        self.hush = Hush(COMPLAINTS, now)
        self.halts = 0
        """How often somebody has stopped, paused or released: what waited meanwhile is void."""
        self._requests_per_s = requests_per_s
        self._now = now
        self._accounts: OrderedDict[str, Account] = OrderedDict()

    def account(self, user: str) -> Account:
        """That of `user`; it outlives connections, so that nobody starts anew by connecting anew."""
        account = self._accounts.pop(user, None) or Account(self._requests_per_s, self._now)
        self._accounts[user] = account
        if len(self._accounts) > MOST_USERS:
            self._accounts.popitem(last=False)
        return account
