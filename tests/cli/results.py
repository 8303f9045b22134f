"""How a command that was run in process ended."""

from click.testing import Result


def refused(result: Result) -> str:
    """The one sentence that a command ends with."""
    assert result.exit_code == 1, result.output
    assert isinstance(result.exception, SystemExit)
    (line,) = result.stderr.splitlines()
    assert line.startswith("bentod: ")
    return line
