"""The search that coverage guides: `python -m tests.fuzz.guided framing|daemon CORPUS [OPTION …]`."""

import importlib
import sys
from collections.abc import Callable
from pathlib import Path
from random import Random

import atheris

with atheris.instrument_imports(include=["bentod", "msgpack"]):
    targets = importlib.import_module("tests.fuzz.targets")
    grammar = importlib.import_module("tests.fuzz.grammar")


class Search:
    """One target, and how its input is varied."""

    def __init__(self, name: str, corpus: Path) -> None:
        self._fortress = targets.Fortress()
        self._grammar = self._fortress.grammar
        self._corpus = corpus
        self.run: Callable[[bytes], None] = targets.framing if name == "framing" else self._take
        for number, seed in enumerate(targets.seeds(self._grammar)):
            (corpus / f"seed-{number:03}").write_bytes(seed if name == "daemon" else seed[1:])

    def vary(self, data: bytes, most: int, seed: int) -> bytes:
        """Ways of libFuzzer, damage that knows the format, or another message behind the others."""
        random = Random(seed)
        way = random.random()
        if way < 0.4 or not data:
            return bytes(atheris.Mutate(data, most))
        varied = grammar.damaged(data, random) if way < 0.7 else data + self._grammar.stream(random)
        return bytes(varied[:most])

    def _take(self, data: bytes) -> None:
        try:
            self._fortress.take(data)
        except Exception:
            for number, sent in enumerate(self._fortress.history):
                (self._corpus.with_name("history") / f"{number:04}").write_bytes(sent)
            raise


def main() -> None:
    """Search until an option of libFuzzer's ends it; a finding ends it with exit code 77."""
    name, corpus, *options = sys.argv[1:]
    search = Search(name, Path(corpus))
    atheris.Setup([sys.argv[0], corpus, *options], search.run, custom_mutator=search.vary)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
