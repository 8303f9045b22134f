"""How the live view looks: bold, dim and red beside words that say the same, and no line too wide."""

import re

BOLD, DIM, RED, OFF = "\x1b[1m", "\x1b[2m", "\x1b[31;1m", "\x1b[0m"

_COLOUR = re.compile(r"(\x1b\[[0-9;]*m)")


def cut(line: str, width: int) -> str:
    """`line` with no more than `width` visible columns; colours take none."""
    kept, columns = [], 0
    for part in _COLOUR.split(line):
        shown = part if _COLOUR.fullmatch(part) else part[: width - columns]
        columns += 0 if _COLOUR.fullmatch(part) else len(shown)
        kept.append(shown)
    return "".join(kept)
