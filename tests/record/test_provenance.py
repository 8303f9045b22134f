"""What a recording says of where it comes from."""

import subprocess
from pathlib import Path

import pytest

from bentod.config_tables import Record
from bentod.errors import ConfigError
from bentod.record.disk import Budget
from bentod.record.provenance import folder, limits, new_header, versions
from bentod.record.scribe import Limits
from sim.clock import VirtualClock
from tests.rig import sim_config


def with_urdf(path: Path | None) -> Record:
    return Record(urdf=path)


async def test_a_header_holds_the_config_the_robot_and_the_versions(
    tmp_path: Path, clock: VirtualClock
) -> None:
    (tmp_path / "arm.urdf").write_text("<robot/>")
    config = sim_config().model_copy(update={"record": with_urdf(tmp_path / "arm.urdf")})
    header = new_header(config, "text", "sim.toml", clock)
    assert header.joints == tuple(joint.spec() for joint in config.joints)
    assert (header.config, header.config_name, header.urdf) == ("text", "sim.toml", "<robot/>")
    assert (header.started, header.started_wall) == (clock.now(), clock.wall())
    assert {"bentod", "python", "system"} <= set(header.versions)
    assert header.session != new_header(config, "", "", clock).session


async def test_a_robot_s_description_that_is_not_there_is_a_mistake_in_the_config(
    tmp_path: Path, clock: VirtualClock
) -> None:
    config = sim_config().model_copy(update={"record": with_urdf(tmp_path / "none.urdf")})
    with pytest.raises(ConfigError, match=r"record\.urdf = '.*none\.urdf' cannot be read"):
        new_header(config, "", "", clock)


def test_a_checkout_tells_its_commit_and_whether_it_was_changed(tmp_path: Path) -> None:
    assert "commit" not in versions(tmp_path)
    who = ["-c", "user.name=x", "-c", "user.email=x"]
    (tmp_path / "file").write_text("1")
    for command in (["init", "-q"], ["add", "file"], [*who, "commit", "-qm", "1"]):
        subprocess.run(["git", "-C", str(tmp_path), *command], check=True)
    found = versions(tmp_path)
    assert (len(found["commit"]), found["dirty"]) == (40, "no")
    (tmp_path / "file").write_text("2")
    assert versions(tmp_path)["dirty"] == "yes"


def test_the_config_says_where_recordings_go_and_what_they_may_use() -> None:
    table = Record(folder=Path("/data"), max_gb=3, min_free_gb=1, max_file_mb=10, max_file_min=2)
    assert folder(table, {}) == Path("/data")
    assert folder(Record(), {"STATE_DIRECTORY": "/s"}) == Path("/s/recordings")
    assert limits(table) == Limits(10e6, 120.0, Budget(3e9, 1e9))
