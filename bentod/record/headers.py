"""The header of a part: metadata and attachments at the very start of a file, in words that tools show."""

from collections.abc import Mapping

from bentod.errors import RecordingError
from bentod.record.codec import SCHEMAS
from bentod.record.container import Container
from bentod.record.descriptors import descriptor_set
from bentod.record.plain import joint_from_json, joint_to_json
from bentod.record.session import SCHEMA, Header

SESSION, JOINTS, VERSIONS = "bentod.session", "bentod.joints", "bentod.versions"
"""Names of the metadata; the first is the last to be written, so that where it is, all are."""

CONFIG, URDF, LEARNED = "config.toml", "robot.urdf", "learned.npz"
"""Names of the attachments."""


def write_header(container: Container, header: Header, time: int) -> None:
    """Everything that stands before the first message; `time`: ns since the epoch, of the part's start."""
    notes = {"session": header.session, "schema": str(header.schema)}
    data = descriptor_set(header.joints)
    container.describe(
        dict.fromkeys(SCHEMAS.values(), data), [(topic, name, notes) for topic, name in SCHEMAS.items()]
    )
    if header.config:
        container.attachment(CONFIG, "application/toml", _bytes(header.config), time)
    if header.urdf:
        container.attachment(URDF, "application/xml", _bytes(header.urdf), time)
    if header.learned and header.part == 1:
        container.attachment(LEARNED, "application/zip", header.learned, time)
    container.metadata(VERSIONS, header.versions)
    container.metadata(JOINTS, {joint.name: joint_to_json(joint) for joint in header.joints})
    container.metadata(
        SESSION,
        {
            "session": header.session,
            "schema": str(header.schema),
            "part": str(header.part),
            "arm": header.arm,
            "rate_hz": repr(header.rate_hz),
            "started": repr(header.started),
            "started_wall": repr(header.started_wall),
            "config_name": header.config_name,
            "note": header.note,
        },
    )


def read_header(
    where: str, metadata: Mapping[str, Mapping[str, str]], attachments: Mapping[str, bytes]
) -> Header:
    """The header again; `where` names the file in errors.

    Raises:
        RecordingError: it is of a newer version, or its start is lost.
    """
    session = metadata.get(SESSION)
    if session is None:
        raise RecordingError(f"{where} is not a recording of bentod, or it ends within its header.")
    check_version(where, session.get("schema", ""))
    joints = metadata.get(JOINTS, {})
    return Header(
        session=session["session"],
        schema=int(session["schema"]),
        started=float(session["started"]),
        started_wall=float(session["started_wall"]),
        arm=session["arm"],
        rate_hz=float(session["rate_hz"]),
        joints=tuple(joint_from_json(name, text) for name, text in joints.items()),
        config=_text(attachments.get(CONFIG, b"")),
        config_name=session["config_name"],
        versions=dict(metadata.get(VERSIONS, {})),
        part=int(session["part"]),
        urdf=_text(attachments.get(URDF, b"")),
        learned=attachments.get(LEARNED, b""),
        note=session.get("note", ""),
    )


def _bytes(text: str) -> bytes:
    return text.encode("utf-8", "backslashreplace")


def _text(content: bytes) -> str:
    return content.decode("utf-8", "replace")


def check_version(where: str, schema: str) -> None:
    """Raises RecordingError if this is not a version that we know."""
    if not schema.isdecimal() or int(schema) < 1:
        raise RecordingError(
            f"{where} says that it has version '{schema}' of the schema, which is no number."
        )
    if int(schema) > SCHEMA:
        raise RecordingError(
            f"{where} has version {schema} of the schema; this bentod reads versions up to {SCHEMA}. "
            "Read it with the bentod that wrote it, or a later one."
        )
