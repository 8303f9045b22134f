"""The pictures of the page in the README: `make screenshots` renews them from a live simulated arm."""

import asyncio
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

from tests.dashboard.chromium import Browser, chromium
from tests.dashboard.page import Page
from tests.dashboard.rig import Lab, lab, opened

LEARNING_S = 40.0
"""Until the simulated wearer has gone round a few times, so that the arm helps."""

COLOURS = 96
"""Of the palette: a picture of a page needs no more."""


async def _picture(page: Page, folder: Path, name: str) -> None:
    file = folder / f"{name}.png"
    await page.eval("document.querySelector('.notices').replaceChildren()")
    await page.screenshot(file)
    with Image.open(file) as taken:
        small = taken.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    small.save(file, optimize=True)


async def _page(browser: Browser, site: Lab, scheme: str, size: tuple[int, int], tab: str) -> Page:
    page = await browser.page()
    await page.size(*size, mobile=size[0] < 500)
    await page.scheme(scheme)
    await opened(page, site.operator)
    await page.click(f"#tab-{tab}")
    await page.eval("scrollTo(0, 0)")
    await asyncio.sleep(4.0)  # of strip charts and paths
    return page


async def _pictures(address: str, site: Lab, folder: Path) -> None:
    async with Browser.at(address) as browser:
        page = await _page(browser, site, "dark", (1440, 900), "muscles")
        await page.until("bentod.frame.assist.engaged")
        await _picture(page, folder, "dark")
        page = await _page(browser, site, "light", (1440, 900), "task")
        await page.until("bentod.frame.assist.engaged")
        await _picture(page, folder, "light")
        page = await _page(browser, site, "light", (390, 844), "arm")
        await page.until("bentod.frame.assist.engaged")
        await _picture(page, folder, "phone")


def main(folder: Path) -> None:
    """Renew the pictures in `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as name:
        home = Path(name)
        (home / "chromium").mkdir()
        with lab(home) as site, chromium(home / "chromium", webgl=True) as address:
            asyncio.run(asyncio.sleep(LEARNING_S))
            asyncio.run(_pictures(address, site, folder))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
