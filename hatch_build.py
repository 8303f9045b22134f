"""Compile the learning kernel into the wheel where there is a C compiler; without one it is pure Python."""

import hashlib
import os
import shlex
import shutil
import subprocess
import sysconfig
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

SOURCE = "bentod/learn/kernel.c"
LIBRARY = "bentod/learn/_kernel.so"

FLAGS = ("-std=c99", "-O3", "-fPIC", "-shared", "-ffp-contract=off", "-fno-trapping-math")
"""Without fused multiply-add, because results must be those of numpy, to the bit."""


def compile_kernel(source: Path, library: Path) -> str:
    """Compile `source` with what $CC says or a compiler that is found. Returns why not; empty when done.

    The library says which source it is of, so that one from before an update is not used.
    """
    wanted = os.environ.get("CC")
    compiler = shlex.split(wanted) if wanted else next(filter(shutil.which, ("cc", "gcc", "clang")), None)
    if not compiler:
        return "no C compiler was found"
    digest = hashlib.sha256(source.read_bytes()).hexdigest()
    command = [*([compiler] if isinstance(compiler, str) else compiler), *FLAGS, f"-DSOURCE={digest}"]
    # Beside the target, then moved over it: a running daemon keeps the file that it has loaded.
    fresh = library.with_suffix(".fresh")
    try:
        built = subprocess.run(  # noqa: S603 -- the compiler of whoever builds
            [*command, str(source), "-o", str(fresh), "-lm"], capture_output=True, text=True, check=False
        )
    except OSError as error:
        return f"{command[0]} cannot be run: {error.strerror}"
    if built.returncode:
        return f"{command[0]} failed: {built.stderr.strip()[-2000:]}"
    fresh.replace(library)
    return ""


class KernelHook(BuildHookInterface[Any]):
    """What hatchling calls before it builds a wheel, an editable one too."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile; whatever goes wrong, a wheel comes out."""
        root = Path(self.root)
        self._folder = tempfile.TemporaryDirectory()
        editable = version == "editable"
        library = root / LIBRARY if editable else Path(self._folder.name, "_kernel.so")
        lack = compile_kernel(root / SOURCE, library)
        if lack:
            self.app.display_warning(f"Without the compiled learning kernel, numpy does its work: {lack}")
            return
        if not editable:
            build_data["force_include"][str(library)] = LIBRARY
        # ctypes loads it, whatever the version of Python.
        platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{platform}"

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """Clear away what was only compiled to be packed."""
        self._folder.cleanup()
