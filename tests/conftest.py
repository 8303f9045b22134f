"""Every async test runs in virtual time, unless it is marked `real_time`."""

import asyncio
from collections.abc import Callable, Iterator, Mapping

import pytest
from hypothesis import settings

from sim.clock import VirtualClock, VirtualLoop

settings.register_profile("long", max_examples=6000, deadline=None)
"""For `--hypothesis-profile=long`: what is drawn at random is drawn for as long as it takes."""


def pytest_asyncio_loop_factories(
    config: pytest.Config, item: pytest.Item
) -> Mapping[str, Callable[[], asyncio.AbstractEventLoop]]:
    if item.get_closest_marker("real_time"):
        return {"real": asyncio.new_event_loop}
    return {"virtual": VirtualLoop}


@pytest.fixture(autouse=True, scope="session")
def _recordings_go_nowhere_else(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))
        yield


@pytest.fixture
def clock() -> VirtualClock:
    return VirtualClock()
