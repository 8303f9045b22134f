"""Programs by the names of those that play sound, and nothing else on the path but a shell's own."""

from pathlib import Path

import pytest


class Programs:
    """A folder of them. Each notes its name and its words in `calls` as it begins."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self._folder = folder
        (folder / "bin").mkdir()
        for name in ("sh", "cat", "sleep"):
            found = next(p for p in (Path("/bin", name), Path("/usr/bin", name)) if p.exists())
            (folder / "bin" / name).symlink_to(found)
        self.path = str(folder / "bin")
        monkeypatch.setenv("PATH", self.path)

    def add(self, name: str, command: str) -> None:
        """One that does `command`; `$out` is a file of its own."""
        program = self._folder / "bin" / name
        out = self.out(name)
        program.write_text(f'#!/bin/sh\nout={out}\necho "{name} $*" >> {self._folder / "calls"}\n{command}\n')
        program.chmod(0o755)

    def out(self, name: str) -> Path:
        """What it wrote to `$out`."""
        return self._folder / f"{name}.out"

    def heard(self, name: str) -> bytes:
        """The same, as far as it has come."""
        return self.out(name).read_bytes() if self.out(name).exists() else b""

    def calls(self) -> list[str]:
        """Everything that was run."""
        file = self._folder / "calls"
        return file.read_text().splitlines() if file.exists() else []


def alive(pid: int) -> bool:
    """Whether a process is there and is no zombie."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False
