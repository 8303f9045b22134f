"""Where the links of a URDF are: forward kinematics straight from its definition, slow and obvious."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

BENTO = Path(__file__).parents[2] / "bentod" / "dashboard" / "page" / "models" / "bento.urdf"

Matrix = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Joint:
    """One joint: m, rad, rad/s. `origin` (4 x 4) leads from the child's frame at angle 0 to the parent's."""

    name: str
    parent: str
    child: str
    origin: Matrix
    axis: Matrix  # shape (3,), of length 1; zeros where nothing turns
    lower: float
    upper: float
    velocity: float


def read_joints(path: Path) -> tuple[Joint, ...]:
    """Every joint of a URDF, parents before children."""
    found = [_joint(node) for node in ElementTree.parse(path).getroot().findall("joint")]  # noqa: S314 -- our own
    known = {joint.parent for joint in found} - {joint.child for joint in found}
    ordered: list[Joint] = []
    while len(ordered) < len(found):
        ready = [joint for joint in found if joint.parent in known and joint not in ordered]
        assert ready, "joints that hang on nothing"
        ordered += ready
        known |= {joint.child for joint in ready}
    return tuple(ordered)


def pose(joints: tuple[Joint, ...], angles: Mapping[str, float]) -> dict[str, Matrix]:
    """The matrix (4 x 4, to the root's frame) of each link by name. `angles`: rad, 0 where absent."""
    root = next(j.parent for j in joints if j.parent not in {other.child for other in joints})
    links: dict[str, Matrix] = {root: np.eye(4)}
    for joint in joints:
        turn = rotation(joint.axis, angles.get(joint.name, 0.0))
        links[joint.child] = links[joint.parent] @ joint.origin @ turn
    return links


def rotation(axis: Matrix, angle: float) -> Matrix:
    """Rodrigues: R = I + sin θ K + (1 − cos θ) K², as a 4 x 4 matrix."""
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turned = np.eye(4)
    turned[:3, :3] = np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * (k @ k)
    return turned


def _joint(node: ElementTree.Element) -> Joint:
    limit = _child(node, "limit")
    axis = _numbers(_child(node, "axis"), "xyz", "0 0 0")
    return Joint(
        name=node.attrib["name"],
        parent=_child(node, "parent")["link"],
        child=_child(node, "child")["link"],
        origin=_origin(_child(node, "origin")),
        axis=axis / (np.linalg.norm(axis) or 1.0),
        lower=float(limit.get("lower", "0")),
        upper=float(limit.get("upper", "0")),
        velocity=float(limit.get("velocity", "0")),
    )


def _origin(place: Mapping[str, str]) -> Matrix:
    """URDF: roll about x, then pitch about y, then yaw about z, all of them fixed axes."""
    roll, pitch, yaw = _numbers(place, "rpy", "0 0 0")
    x, y, z = np.eye(3)
    matrix: Matrix = rotation(z, yaw) @ rotation(y, pitch) @ rotation(x, roll)
    matrix[:3, 3] = _numbers(place, "xyz", "0 0 0")
    return matrix


def _child(node: ElementTree.Element, tag: str) -> Mapping[str, str]:
    found = node.find(tag)
    return {} if found is None else found.attrib


def _numbers(attributes: Mapping[str, str], key: str, missing: str) -> Matrix:
    return np.array([float(part) for part in attributes.get(key, missing).split()])
