"""Bytes from a terminal as keys, in whatever pieces they come. No input or output."""

import re

SEQUENCES = {
    b"A": "up",
    b"B": "down",
    b"C": "right",
    b"D": "left",
    b"Z": "back tab",
}
"""Final bytes of the control sequences that mean something here (ECMA-48, 5.4; xterm's application mode)."""

PLAIN = {b" ": "space", b"\t": "tab", b"\r": "enter", b"\n": "enter"}

_ESCAPE = b"\x1b"
_SEQUENCE = re.compile(rb"\x1b(?:\[[0-?]*[ -/]*([@-~])|O([@-~]))")
_UNFINISHED = re.compile(rb"\x1b(?:\[[0-?]*[ -/]*|O)?")
_PASTE = b"\x1b[200~"
_END_OF_PASTE = b"\x1b[201~"

_MOST = 64
"""Bytes that an unfinished sequence may have; more is no key."""


class Keys:
    """Letters are themselves, all others have names: "escape", "left", "tab" … What is pasted is no key."""

    def __init__(self) -> None:
        self._rest = b""
        self._pasting = False

    @property
    def waiting(self) -> bool:
        """Whether what came last may be the Escape key, or the beginning of another."""
        return bool(self._rest) and not self._pasting

    def feed(self, data: bytes) -> list[str]:
        """Take in bytes; returns the keys that are complete."""
        self._rest += data
        found: list[str] = []
        while self._rest and (self._skip_paste() if self._pasting else self._take(found)):
            continue
        return found

    def flush(self) -> list[str]:
        """Nothing more has come: what could be Escape was Escape."""
        begun, self._rest = self.waiting, b"" if not self._pasting else self._rest
        return ["escape"] if begun else []

    def _take(self, found: list[str]) -> bool:
        """Take one key off the front; False: more bytes are needed to know it."""
        rest = self._rest
        if sequence := _SEQUENCE.match(rest):
            self._rest = rest[sequence.end() :]
            self._pasting = sequence.group() == _PASTE
            name = SEQUENCES.get(sequence.group(1) or sequence.group(2), "")
            found += [name] if name else []
            return True
        if _UNFINISHED.fullmatch(rest) and len(rest) < _MOST:
            return False
        first, self._rest = rest[:1], rest[1:]
        name = "escape" if first == _ESCAPE else PLAIN.get(first, _letter(first))
        found += [name] if name else []
        return True

    def _skip_paste(self) -> bool:
        _, end, after = self._rest.partition(_END_OF_PASTE)
        self._pasting = not end
        self._rest = after if end else self._rest[1 - len(_END_OF_PASTE) :]
        return not self._pasting


def _letter(byte: bytes) -> str:
    """A printable character of ASCII; empty for all else."""
    return byte.decode("ascii") if b"!" <= byte <= b"~" else ""
