import pytest

from bentod.control.leases import Holder, Lease, Leases
from bentod.errors import Refused
from bentod.frames import Velocity

ANN, BEN = Holder(1, "ann"), Holder(2, "ben")


def _leases() -> Leases[int, Velocity]:
    leases: Leases[int, Velocity] = Leases()
    leases.take(0, Lease(ANN, Velocity(0.1), expires=1.0))
    return leases


def test_a_wish_dies_with_its_lease() -> None:
    leases = _leases()
    leases.expire(0.99)
    assert [key for key, _ in leases] == [0]
    leases.expire(1.0)
    assert list(leases) == []


def test_a_lease_can_be_renewed_with_another_wish() -> None:
    leases = _leases()
    leases.take(0, Lease(ANN, Velocity(0.2), expires=2.0))
    assert [lease.wish for _, lease in leases] == [Velocity(0.2)]


def test_what_one_client_holds_another_cannot_take() -> None:
    leases = _leases()
    with pytest.raises(Refused, match="'ann' holds it"):
        leases.take(0, Lease(BEN, Velocity(0.2), expires=2.0))
    leases.take(1, Lease(BEN, Velocity(0.2), expires=2.0))


def test_a_client_that_is_gone_holds_nothing() -> None:
    leases = _leases()
    leases.release(ANN.session)
    leases.take(0, Lease(BEN, Velocity(0.2), expires=2.0))
    leases.clear()
    assert list(leases) == []
