"""Where the links of a serial arm are, by the text of its URDF."""

import dataclasses
import xml.etree.ElementTree

import numpy as np

MOVING = ("revolute", "continuous", "prismatic")


@dataclasses.dataclass
class Joint:
    name: str
    kind: str
    parent: str  # link
    child: str  # link
    pose: np.ndarray  # 4 x 4, in the parent link
    axis: np.ndarray  # in the joint's frame


@dataclasses.dataclass
class Chain:
    joints: list  # from the base to the tip, fixed ones too
    attached: list  # fixed joints of links beside that way, parents first

    def moving(self):
        return [joint.name for joint in self.joints if joint.kind in MOVING]

    def links(self):
        return {self.joints[0].parent, *(joint.child for joint in self.joints + self.attached)}

    def poses(self, q):
        """Of each child link, 4 x 4 in the base frame, for a value of each moving joint, m or rad."""
        poses, values = {self.joints[0].parent: np.eye(4)}, iter(q)
        for joint in self.joints + self.attached:
            pose = poses[joint.parent] @ joint.pose
            if joint.kind in MOVING:
                pose = pose @ moved(joint, next(values))
            poses[joint.child] = pose
        return poses

    def way(self, q):
        """The places of the joints and of the tip, base frame, m."""
        poses = self.poses(q)
        return np.array([poses[joint.child][:3, 3] for joint in self.joints])


def read_chain(urdf, tip):
    """From the URDF's root to the link `tip`; ValueError where there is no such way."""
    try:
        root = xml.etree.ElementTree.fromstring(urdf.encode("utf-8", "surrogateescape"))
    except xml.etree.ElementTree.ParseError as error:
        raise ValueError(f"the URDF is no XML: {error}") from error
    by_child = {element.find("child").get("link"): element for element in root.findall("joint")}
    joints, link = [], tip
    while link in by_child:
        element = by_child.pop(link)
        joints.insert(0, read_joint(element))
        link = element.find("parent").get("link")
    if not joints:
        raise ValueError(f"the URDF has no way to the link {tip}")
    return Chain(joints, attached_links([read_joint(e) for e in by_child.values()], joints))


def attached_links(others, joints):
    """Of the other joints those that are fixed to the way, or to what is fixed to it."""
    links = {joints[0].parent, *(joint.child for joint in joints)}
    attached = []
    while found := [joint for joint in others
                    if joint.kind == "fixed" and joint.parent in links and joint.child not in links]:
        attached += found
        links.update(joint.child for joint in found)
    return attached


def read_joint(element):
    origin, axis = element.find("origin"), element.find("axis")
    pose = np.eye(4)
    if origin is not None:
        pose[:3, :3] = rotation_of(numbers(origin.get("rpy", "0 0 0")))
        pose[:3, 3] = numbers(origin.get("xyz", "0 0 0"))
    direction = numbers(axis.get("xyz")) if axis is not None else np.array([1.0, 0.0, 0.0])
    return Joint(element.get("name"), element.get("type"), element.find("parent").get("link"),
                 element.find("child").get("link"), pose, direction / np.linalg.norm(direction))


def numbers(text):
    return np.array([float(word) for word in text.split()])


def rotation_of(rpy):
    """Of fixed axes: first about x, then y, then z."""
    return about([0, 0, 1], rpy[2]) @ about([0, 1, 0], rpy[1]) @ about([1, 0, 0], rpy[0])


def about(axis, angle):
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def moved(joint, value):
    pose = np.eye(4)
    if joint.kind == "prismatic":
        pose[:3, 3] = value * joint.axis
    else:
        pose[:3, :3] = about(joint.axis, value)
    return pose
