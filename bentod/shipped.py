"""Where the files are that come with bentod."""

import sys
import sysconfig
from pathlib import Path


def folders() -> list[Path]:
    """Folders that may hold the shipped configs: beside the checkout, and where the wheel puts them."""
    shared = Path("share", "bentod", "config")
    roots = [Path(sysconfig.get_path("data")), Path(sys.prefix)]
    return [Path(__file__).parents[1] / "config", *(root / shared for root in roots)]
