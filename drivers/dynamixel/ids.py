"""Servo ids as a person types them."""

import click

LAST = 252
"""The greatest id of a servo; 253 is reserved and 254 is everybody."""


def parse_ids(ctx: click.Context, param: click.Parameter, text: str) -> tuple[int, ...]:
    """Ids and ranges of them, such as "1-5,9"; each once, ascending. The callback of an option."""
    found: set[int] = set()
    for part in text.split(","):
        first, _, last = part.strip().partition("-")
        last = last or first
        if not (first.isdecimal() and last.isdecimal() and int(first) <= int(last) <= LAST):
            raise click.BadParameter(
                f"'{part}' is not an ID or a range of IDs between 0 and {LAST}.", ctx, param
            )
        found.update(range(int(first), int(last) + 1))
    return tuple(sorted(found))
