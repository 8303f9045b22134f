"""One daemon, one page's server and one browser for all tests of a process; a window of its own for each."""

from collections.abc import AsyncIterator, Iterator

import pytest

from tests.dashboard.chromium import Browser, chromium
from tests.dashboard.page import Page
from tests.dashboard.rig import Lab, lab, opened


@pytest.fixture(scope="package")
def shared_lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    with lab(tmp_path_factory.mktemp("lab")) as found:
        yield found


@pytest.fixture
def site(shared_lab: Lab) -> Lab:
    """The daemon and its page, with an arm that is active and at rest."""
    shared_lab.calm()
    return shared_lab


@pytest.fixture(scope="package")
def browser_address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with chromium(tmp_path_factory.mktemp("chromium")) as address:
        yield address


@pytest.fixture(scope="package")
def webgl_address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with chromium(tmp_path_factory.mktemp("chromium"), webgl=True) as address:
        yield address


@pytest.fixture
async def browser(browser_address: str) -> AsyncIterator[Browser]:
    """Without WebGL, which costs much without a graphics card."""
    async with Browser.at(browser_address) as found:
        yield found


@pytest.fixture
async def webgl_browser(webgl_address: str) -> AsyncIterator[Browser]:
    async with Browser.at(webgl_address) as found:
        yield found


@pytest.fixture
async def page(browser: Browser, site: Lab) -> Page:
    """The page as an operator has it, of a calm arm; it must not have complained by the end of the test."""
    return await opened(await browser.page(), site.operator)


@pytest.fixture
async def looking(browser: Browser, site: Lab) -> Page:
    """The page as an observer has it."""
    return await opened(await browser.page(), site.observer)
