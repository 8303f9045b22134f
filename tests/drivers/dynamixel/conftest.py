"""A line for every test of the driver."""

import pytest

from tests.drivers.dynamixel.wire import Wire


@pytest.fixture
def wire() -> Wire:
    return Wire()
