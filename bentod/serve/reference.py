"""The API reference as a Markdown table, made from the methods themselves; docs/api.md holds a copy of it."""

import sys
from collections.abc import Mapping
from pathlib import Path

from bentod.frames import Value
from bentod.inbox import Inbox
from bentod.serve.methods import arm_methods
from bentod.serve.room import About, Room
from bentod.serve.spec import Method

BEGIN = "<!-- reference: made by `make reference` -->"
END = "<!-- end of reference -->"


def table(methods: Mapping[str, Method]) -> str:
    """One row a method, in the table's order."""
    rows = [_row(method.describe()) for method in methods.values()]
    return "\n".join(["| method | role | parameters | what it does |", "|---|---|---|---|", *rows])


def current() -> str:
    """The table of the methods that this version offers."""
    nobody = About(arm="", driver="", rate_hz=30.0, joints=(), groups={}, emg="", lease_max=1.0)
    return table(arm_methods(Room(Inbox(), nobody)))


def renewed(page: str) -> str:
    """`page` with its copy of the table brought up to date. Raises ValueError: it has no place for one."""
    before, after = page.index(BEGIN) + len(BEGIN), page.index(END)
    return f"{page[:before]}\n\n{current()}\n\n{page[after:]}"


def _row(method: Mapping[str, Value]) -> str:
    params = method["parameters"]
    cells = [_param(param) for param in params if isinstance(param, dict)] if isinstance(params, list) else []
    return f"| `{method['name']!s}` | {method['role']!s} | {'<br>'.join(cells) or '–'} | {method['doc']!s} |"


def _param(param: Mapping[str, Value]) -> str:
    kind = str(param["type"])
    bounds = ""
    if "minimum" in param or "maximum" in param:
        bounds = f" {param.get('minimum', '−∞')!s} … {param.get('maximum', '∞')!s}"
    if "choices" in param:
        choices = param["choices"]
        kind = " \\| ".join(f"`{choice!s}`" for choice in choices) if isinstance(choices, list) else kind
    unit = f" {param['unit']!s}" if param.get("unit") else ""
    default = "" if param["required"] else f" = {_literal(param['default'])}"
    doc = f": {param['doc']!s}" if param.get("doc") else ""
    return f"`{param['name']!s}`{default} ({kind}{bounds}{unit}){doc}"


def _literal(value: Value) -> str:
    if value is None:
        return "nil"
    return str(value).lower() if isinstance(value, bool) else str(value)


if __name__ == "__main__":
    readme = Path(sys.argv[1])
    readme.write_text(renewed(readme.read_text(encoding="utf-8")), encoding="utf-8")
