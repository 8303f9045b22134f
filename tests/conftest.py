"""Every async test runs in virtual time, unless it is marked `real_time`."""

import asyncio
import importlib
import uuid
from collections.abc import Callable, Iterator, Mapping
from types import ModuleType

import pytest
from hypothesis import settings

from sim.clock import VirtualClock, VirtualLoop
from sim.emg import Synthetic
from tests.rig import opened_sources

settings.register_profile("long", max_examples=6000, deadline=None)
"""For `--hypothesis-profile=long`: what is drawn at random is drawn for as long as it takes."""


def pytest_asyncio_loop_factories(
    config: pytest.Config, item: pytest.Item
) -> Mapping[str, Callable[[], asyncio.AbstractEventLoop]]:
    if item.get_closest_marker("real_time"):
        return {"real": asyncio.new_event_loop}
    return {"virtual": VirtualLoop}


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The page's tests come first, so that what they share does not take from the others for long."""
    items.sort(key=lambda item: "tests/dashboard/" not in item.nodeid)


@pytest.fixture(autouse=True, scope="session")
def _recordings_go_nowhere_else(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))
        yield


@pytest.fixture(scope="session")
def pylsl(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ModuleType]:
    """The library, in a session of its own on this machine, if streams can be found here at all.

    It reads its settings once, so all tests that use it in this process share them.
    """
    settings = tmp_path_factory.mktemp("lsl") / "lsl_api.cfg"
    settings.write_text(
        f"[lab]\nSessionID = bentod-{uuid.uuid4()}\n[multicast]\nResolveScope = machine\n[log]\nlevel = -2\n"
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LSLAPICFG", str(settings))  # for the processes that are started meanwhile, too
        try:
            library = importlib.import_module("pylsl")
        except (ImportError, RuntimeError) as error:
            pytest.skip(f"pylsl cannot be loaded: {error}")
        probe = library.StreamOutlet(library.StreamInfo("probe", "Markers", 1, 0, "string", "probe"))
        if not library.resolve_byprop("source_id", "probe", 1, 5.0):
            pytest.skip("LSL finds no streams on this machine: it lets no multicast through")
        del probe
        yield library


@pytest.fixture
def clock() -> VirtualClock:
    return VirtualClock()


@pytest.fixture
def sources() -> Iterator[list[Synthetic]]:
    """The simulated wearers that a daemon opens, to be broken by hand."""
    with opened_sources() as opened:
        yield opened
