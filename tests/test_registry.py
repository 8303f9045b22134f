import sys
from pathlib import Path

import pytest

from bentod import registry
from bentod.errors import ConfigError


@pytest.mark.parametrize("target", sorted(set(registry.TARGETS.values())))
def test_every_target_can_be_loaded(target: str) -> None:
    assert registry.resolve(target)


def test_a_target_that_is_not_there_is_an_error_with_its_name() -> None:
    with pytest.raises(ConfigError, match=r"sim\.joints:nothing cannot be loaded"):
        registry.resolve("sim.joints:nothing")


def test_a_source_whose_library_is_not_installed_names_the_extra_that_brings_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "pylsl", None)
    monkeypatch.delitem(sys.modules, "drivers.emg.lsl", raising=False)
    with pytest.raises(ConfigError, match=r"drivers\.emg\.lsl:open_emg .*; pip install 'bentod\[lsl\]'"):
        registry.open_emg("lsl")


def test_a_stranger_called_drivers_is_refused_before_it_is_imported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "drivers").mkdir()
    (tmp_path / "drivers" / "__init__.py").write_text("raise SystemExit('a stranger ran')")
    for name in [name for name in sys.modules if name.partition(".")[0] == "drivers"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(ConfigError, match="is not bentod's own"):
        registry.open_joints("dynamixel")
