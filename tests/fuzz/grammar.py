"""Input for the socket: calls that are right, almost right or wrong, and bytes that were such calls once."""

import math
import random as randoms
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias, cast

import msgpack

from bentod.frames import Value

Call: TypeAlias = tuple[str, Value]
"""A method and its parameters."""

Table: TypeAlias = dict[str, Value]

ODD: tuple[Value, ...] = (
    None, True, False, 0, -1, 1, 0.0, -0.0, 2**63, 2**64 - 1, -(2**63), 1e308, -1e308, 5e-324, math.inf,
    -math.inf, math.nan, "", "x" * 129, "x" * 5000, "\0", "\n", "\ud7ff", "\U0010ffff", b"", b"\xff" * 40,
    [], {}, [[]], [{}], [None] * 70, {"": None}, {"x" * 200: {}}, [[[[[[[[[1]]]]]]]]],
)  # fmt: skip
"""Values that are wrong nearly everywhere, or only just right."""

TORN: tuple[bytes, ...] = (
    b"\xc1", b"\xc7\x00\x01", b"\xd4\x01\x00", b"\xd8\x05" + b"\0" * 16, b"\xc9\xff\xff\xff\xff\x01",
    b"\xdd\xff\xff\xff\xff", b"\xdc\xff\xff", b"\xdf\xff\xff\xff\xff", b"\xdb\xff\xff\xff\xff",
    b"\xc6\xff\xff\xff\xff",
    b"\xa1\xff", b"\xd9\x02\xc3\x28", b"\x82\xa1a\x01\xa1a\x02", b"\x81\x01\x02", b"\x81\x90\x01",
    b"\xcb\x7f\xf8\0\0\0\0\0\0", b"\xca\x7f\x80\0\0", b"\x91" * 200, b"\x81\xa1a" * 100, b"\xc4\x01",
    b"\x93\x00",
)  # fmt: skip
"""Bytes that are no value, a strange one, or the beginning of one that promises too much."""


@dataclass(frozen=True, slots=True)
class Grammar:
    """What the daemon says of its methods, and the names that mean something to this arm."""

    methods: Sequence[Table]  # as `list_methods` describes them
    names: Sequence[str]  # joints, groups, sites, faults

    def call(self, random: randoms.Random, name: str = "", wild: float = 0.4) -> Call:
        """A call of a method (any, without `name`); `wild`: how likely something in it is wrong, 0..1."""
        method = next((m for m in self.methods if m["name"] == name), None) or random.choice(self.methods)
        params = cast("list[Table]", method["parameters"])
        given = {
            str(param["name"]): self._odd(random, param)
            if random.random() < wild / 2
            else self._right(random, param)
            for param in params
            if param["required"] or random.random() < 0.6
        }
        if random.random() < wild / 2:
            return self._misshapen(random, str(method["name"]), given)
        if random.random() < 0.3 and len(given) == len(params):
            return str(method["name"]), list(given.values())
        return str(method["name"]), cast("Value", given)

    def stream(self, random: randoms.Random) -> bytes:
        """Some messages in a row, most of them damaged in one place or another."""
        parts = [self._message(random) for _ in range(random.randint(1, 6))]
        whole = b"".join(parts)
        return damaged(whole, random) if random.random() < 0.7 else whole

    def _message(self, random: randoms.Random) -> bytes:
        method, params = self.call(random, wild=0.6)
        id_: Value = random.choice([0, 1, 7, 2**32 - 1, random.getrandbits(32), 2**32, -1, None, "1", 1.0])
        request: Value = [0, id_, method, params]
        others: list[Value] = [[2, method, params], [1, id_, None, params], [0, id_, method], [3], [], {}]
        shape = random.choice([request] * 6 + others)
        return cast("bytes", msgpack.packb(shape))

    def _misshapen(self, random: randoms.Random, method: str, given: Table) -> Call:
        choices: list[Call] = [
            (method, random.choice(ODD)),
            (method, [given]),
            (method, [*given.values(), *random.choices(ODD, k=2)]),
            (method, given | {"unknown": random.choice(ODD)}),
            (method, dict(list(given.items())[1:])),
            (method + random.choice(["", "s", "\0", "x" * 300]), given),
        ]
        return random.choice(choices)

    def _right(self, random: randoms.Random, param: Table) -> Value:
        kinds = str(param["type"])
        if "nil" in kinds and random.random() < 0.2:
            return None
        if "list of" in kinds and random.random() < 0.5:
            return [self._one(random, param) for _ in range(random.randint(1, 3))]
        return self._one(random, param)

    def _one(self, random: randoms.Random, param: Table) -> Value:
        kind = str(param["type"]).replace("list of ", "").split(",")[0].split(" ")[0]
        return _KINDS[kind](self, random, param)

    def number(self, random: randoms.Random, param: Table) -> Value:
        low, high = bounds(param)
        return random.choice([low, high, random.uniform(low, high), (low + high) / 2, math.floor(high)])

    def text(self, random: randoms.Random, param: Table) -> Value:
        choices = cast("list[str]", param.get("choices")) or [*self.names, "me"]
        return random.choice(choices)

    def flag(self, random: randoms.Random, param: Table) -> Value:
        return random.random() < 0.5

    def anything(self, random: randoms.Random, param: Table) -> Value:
        return random.choice([*ODD, *self.names])

    def _odd(self, random: randoms.Random, param: Table) -> Value:
        low, high = bounds(param)
        beyond = [math.nextafter(low, -math.inf), math.nextafter(high, math.inf), 10 * high + 1]
        return random.choice(
            [random.choice(ODD), random.choice(beyond), [random.choice(ODD), self._one(random, param)]]
        )


_KINDS: dict[str, Callable[[Grammar, randoms.Random, Table], Value]] = {
    "number": Grammar.number,
    "integer": Grammar.number,
    "text": Grammar.text,
    "flag": Grammar.flag,
    "any": Grammar.anything,
}


def bounds(param: Table) -> tuple[float, float]:
    """Least and greatest value of a parameter, as far as it has such."""
    low, high = param.get("minimum", -1e3), param.get("maximum", 1e3)
    return cast("float", low), cast("float", high)


def damaged(whole: bytes, random: randoms.Random) -> bytes:
    """`whole` with something cut off, flipped, doubled or put in."""
    at, until = sorted(random.choices(range(len(whole) + 1), k=2))
    return random.choice(
        [
            whole[:at],
            whole[at:],
            whole[:at] + random.choice(TORN) + whole[at:],
            whole[:at] + random.choice(TORN) + whole[until:],
            whole[:at] + bytes([random.getrandbits(8)]) + whole[at + 1 :],
            whole[:until] + whole[at:],
            whole[:at] + random.randbytes(random.randint(1, 40)) + whole[at:],
        ]
    )


def pieces(whole: bytes, random: randoms.Random, most: int = 8) -> list[bytes]:
    """`whole` cut into at most `most` pieces, anywhere."""
    cuts = sorted(random.choices(range(len(whole) + 1), k=random.randint(0, most - 1)))
    return [whole[start:end] for start, end in zip([0, *cuts], [*cuts, len(whole)], strict=True)]
