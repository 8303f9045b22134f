"""What only the optional extra `emg` brings is loaded when it is asked for, or its name is told."""

from bentod.errors import ConfigError
from bentod.registry import missing_package, resolve


def load(target: str, what: str) -> object:
    """The object that "module:attribute" names, without which there is no `what`.

    Raises:
        ConfigError: it cannot be loaded, e.g. because it needs a package that is not installed.
    """
    try:
        return resolve(target)
    except ConfigError as error:
        missing = missing_package(error)
        if not missing:
            raise
        raise ConfigError(
            f"{what} need the package '{missing}', which is not installed; "
            "the extra 'emg' brings it: pip install 'bentod[emg]'"
        ) from error
