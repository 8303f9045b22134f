"""What only the optional extra `emg` brings is loaded when it is asked for, or its name is told."""

from bentod.errors import ConfigError
from bentod.registry import resolve


def load(target: str, what: str) -> object:
    """The object that "module:attribute" names, without which there is no `what`.

    Raises:
        ConfigError: it cannot be loaded, e.g. because it needs a package that is not installed.
    """
    try:
        return resolve(target)
    except ConfigError as error:
        missing = error.__cause__
        if not isinstance(missing, ModuleNotFoundError) or (missing.name or "").startswith("bentod"):
            raise
        raise ConfigError(
            f"{what} need the package '{missing.name}', which is not installed; "
            "the extra 'emg' brings it: pip install 'bentod[emg]'"
        ) from error
