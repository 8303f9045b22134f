"""What only an optional extra brings is loaded when it is asked for, or its name is told."""

from bentod.errors import BentodError, ConfigError
from bentod.registry import missing_package, resolve


class MissingExtra(BentodError):
    """Something must be installed.

    Examples: an export to Parquet without pyarrow, a figure without matplotlib.
    """

    code = "extra"


def load_extra(target: str, extra: str = "analysis") -> object:
    """The object that "module:attribute" names. `extra`: what brings its packages; empty if nothing of ours.

    Raises:
        MissingExtra: it needs a package that is not installed.
    """
    try:
        return resolve(target)
    except ConfigError as error:
        missing = missing_package(error)
        if not missing:
            raise
        told = f"the extra '{extra}' brings it: pip install 'bentod[{extra}]'"
        raise MissingExtra(
            f"this needs the package '{missing}', which is not installed; "
            + (told if extra else f"pip install '{missing}'")
        ) from error
