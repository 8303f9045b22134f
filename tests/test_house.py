"""The rules of CONTRIBUTING.md that a machine can hold."""

import ast
import re
import shutil
import statistics
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

from bentod import registry

ROOT = Path(__file__).parents[1]
PACKAGES = ("bentod", "drivers", "sim")

FILE_LINES = 300
MEDIAN_FILE_LINES = 150  # of files that hold more than a docstring
FUNCTION_LINES = 40  # of the body: from its first statement, the docstring included, to its last
MEDIAN_FUNCTION_LINES = 7
NESTING = 3  # if, for, while, with, try and match inside one another
TICK_LINES = 40  # with its signature: one screen

Function = ast.FunctionDef | ast.AsyncFunctionDef
BLOCKS = (ast.If, ast.For, ast.AsyncFor, ast.While, ast.With, ast.AsyncWith, ast.Try, ast.TryStar, ast.Match)

# Written in pieces, so that this file does not break its own rules.
UNFINISHED = re.compile(r"\b(TO" r"DO|FIX" r"ME|XX" r"X)\b")
REGISTRY = re.compile(
    r"py"
    r"pi\.(org|io)|python"
    r"hosted\.|npm"
    r"js\.|deb"
    r"ian\.org|--(extra-)?index"
    r"-url|--find"
    r"-links"
)
MACHINE = re.compile(r"(?<![\w.$}])/(home|root|Users|work|opt|mnt)/[\w.]|\b[A-Z]:\\Users")


@dataclass(frozen=True, slots=True)
class Source:
    """One file of the three packages."""

    name: str
    lines: list[str]
    tree: ast.Module
    nodes: tuple[ast.AST, ...]

    def functions(self) -> Iterator[Function]:
        return (node for node in self.nodes if isinstance(node, Function))


@cache
def sources() -> tuple[Source, ...]:
    return tuple(_source(path) for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py")))


def _source(path: Path) -> Source:
    text = path.read_text(encoding="utf-8")
    tree = ast.parse(text)
    return Source(str(path.relative_to(ROOT)), text.splitlines(), tree, tuple(ast.walk(tree)))


@cache
def tracked_texts() -> tuple[tuple[str, list[str]], ...]:
    git = shutil.which("git")
    if git is None or not (ROOT / ".git").exists():
        pytest.skip("not a git checkout")
    command = [git, "-C", str(ROOT), "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, capture_output=True, text=True, check=True, timeout=30)
    paths = [ROOT / name for name in listed.stdout.split("\0") if name]
    return tuple((str(path.relative_to(ROOT)), lines) for path in paths if (lines := _text(path)))


def _text(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8").splitlines()
    except (UnicodeDecodeError, FileNotFoundError, IsADirectoryError):  # a recording; just removed; a link
        return []


def body_lines(function: Function) -> int:
    return (function.end_lineno or 0) - function.body[0].lineno + 1


def nesting(node: ast.AST, depth: int = 0) -> int:
    """How deep blocks stand in one another below `node`; a function inside counts for itself."""
    return max((_depth(child, node, depth) for child in ast.iter_child_nodes(node)), default=depth)


def _depth(child: ast.AST, parent: ast.AST, depth: int) -> int:
    if isinstance(child, Function | ast.ClassDef | ast.Lambda):
        return depth
    return nesting(child, depth + (isinstance(child, BLOCKS) and not _is_elif(child, parent)))


def _is_elif(child: ast.AST, parent: ast.AST) -> bool:
    # The parser writes elif as the only statement of an else, in the column of its if.
    return (
        isinstance(child, ast.If)
        and isinstance(parent, ast.If)
        and parent.orelse == [child]
        and child.col_offset == parent.col_offset
    )


def too_big(found: Callable[[Function], int], bound: int, what: str) -> list[str]:
    return [
        f"{source.name}:{function.lineno}: {function.name}() has {what} {found(function)}, bound {bound}"
        for source in sources()
        for function in source.functions()
        if found(function) > bound
    ]


def matches(pattern: re.Pattern[str], texts: Iterator[tuple[str, list[str]]], bound: str) -> list[str]:
    return [
        f"{name}:{number}: '{match[0]}', {bound}"
        for name, lines in texts
        for number, line in enumerate(lines, 1)
        if (match := pattern.search(line))
    ]


def report(broken: list[str]) -> None:
    assert not broken, "\n" + "\n".join(broken)


def test_no_file_holds_two_ideas() -> None:
    report(
        [
            f"{source.name}:1: the file has lines {len(source.lines)}, bound {FILE_LINES}"
            for source in sources()
            if len(source.lines) > FILE_LINES
        ]
    )


def test_files_are_short_as_a_rule() -> None:
    lines = [len(source.lines) for source in sources() if not source.name.endswith("__init__.py")]
    assert statistics.median(lines) <= MEDIAN_FILE_LINES


def test_no_function_is_long() -> None:
    report(too_big(body_lines, FUNCTION_LINES, "body lines"))


def test_functions_are_short_as_a_rule() -> None:
    lines = [body_lines(function) for source in sources() for function in source.functions()]
    assert statistics.median(lines) <= MEDIAN_FUNCTION_LINES


def test_no_block_stands_too_deep() -> None:
    report(too_big(nesting, NESTING, "nesting"))


def test_the_tick_fits_on_one_screen() -> None:
    report(
        [
            f"{source.name}:{function.lineno}: {function.name}() has lines {lines}, bound {TICK_LINES}"
            for source in sources()
            for function in source.functions()
            if function.name == "tick"
            if (lines := (function.end_lineno or 0) - function.lineno + 1) > TICK_LINES
        ]
    )


def test_packages_open_with_a_docstring_and_nothing_else() -> None:
    report(
        [
            f"{source.name}:1: holds {len(source.tree.body)} statements, bound: a docstring only"
            for source in sources()
            if source.name.endswith("__init__.py")
            if len(source.tree.body) != 1 or not ast.get_docstring(source.tree)
        ]
    )


def test_every_module_says_in_one_sentence_what_it_is_for() -> None:
    report(
        [
            f"{source.name}:1: the docstring begins '{first}', bound: one sentence, with its full stop"
            for source in sources()
            if not (first := (ast.get_docstring(source.tree) or "").partition("\n")[0]).endswith(".")
        ]
    )


def test_imports_stand_at_the_top() -> None:
    report(
        [
            f"{source.name}:{node.lineno}: import inside {function.name}(), bound: none but in the registry"
            for source in sources()
            if source.name != "bentod/registry.py"
            for function in source.functions()
            for node in ast.walk(function)
            if isinstance(node, ast.Import | ast.ImportFrom)
        ]
    )


def test_imports_are_absolute() -> None:
    report(
        [
            f"{source.name}:{node.lineno}: import with {node.level} dots, bound 0"
            for source in sources()
            for node in source.nodes
            if isinstance(node, ast.ImportFrom) and node.level
        ]
    )


def test_nothing_prints() -> None:
    report(
        [
            f"{source.name}:{node.lineno}: {node.func.id}(), bound: log it, or click.echo in a command"
            for source in sources()
            for node in source.nodes
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
            if node.func.id in {"print", "input", "breakpoint"}
        ]
    )


def test_nothing_is_left_for_later() -> None:
    report(matches(UNFINISHED, iter(tracked_texts()), "bound: none, open an issue"))


def test_no_file_names_a_package_registry() -> None:
    report(matches(REGISTRY, iter(tracked_texts()), "bound: none, whoever installs chooses the index"))


def test_no_file_names_a_place_on_one_machine() -> None:
    report(matches(MACHINE, iter(tracked_texts()), "bound: none, paths are relative or come from the config"))


@pytest.mark.parametrize("purpose", sorted(registry.TARGETS))
def test_every_name_in_the_registry_can_be_loaded(purpose: str) -> None:
    assert registry.resolve(registry.TARGETS[purpose])


@pytest.mark.parametrize(
    ("body", "depth"),
    [
        ("pass", 0),
        ("if a: pass\nelif b: pass\nelif c: pass", 1),
        ("if a: pass\nelse:\n if b: pass", 2),
        ("for a in b:\n with c:\n  try: pass\n  except d:\n   if e: pass", 4),
        ("def inner():\n if a:\n  if b: pass", 0),
        ("async with a:\n match b:\n  case 1:\n   while c: pass", 3),
    ],
)
def test_the_house_counts_nesting_as_a_reader_does(body: str, depth: int) -> None:
    assert nesting(ast.parse(body)) == depth


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("cd /{}/someone", True),
        ('"/{}/someone/.cache"', True),
        ("bentod/{}/x", False),
        ("${{HOME}}/{}/x", False),
        ("#!/usr/bin/env bash", False),
        ("/etc/bentod/bentod.toml", False),
    ],
)
def test_the_house_knows_a_path_of_one_machine(line: str, told: bool) -> None:
    assert bool(MACHINE.search(line.format("home"))) is told
