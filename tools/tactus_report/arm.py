"""What an arm is like, by the files that its log holds."""

import dataclasses
import re

import numpy as np

from . import kinematics


@dataclasses.dataclass
class Cover:
    link: str
    length_m: float
    radius_m: float


@dataclasses.dataclass
class Obstacle:
    start: np.ndarray  # of its axis, base frame, m; the same as `end`: a ball
    end: np.ndarray
    radius_m: float


def read_arm(log):
    """Chain, covers and obstacles of a tactus.LogFile; None where its files do not say them plainly."""
    urdf, tip = urdf_of(log), tip_of(log)
    if not urdf or not tip:
        return None
    links = log.modules
    try:
        chain = kinematics.read_chain(urdf, tip)
        covers = [read_cover(log.parameters, i, len(links), link) for i, link in enumerate(links)]
        obstacles = read_obstacles(log.parameters)
    except (ValueError, LookupError, AttributeError):  # one that is damaged
        return None
    is_whole = chain.moving() == log.joints and chain.links().issuperset(links) and None not in covers
    return (chain, covers, obstacles) if is_whole else None


def urdf_of(log):
    """Its text; None without exactly one."""
    found = [text for path, text in log.sources.items() if path.endswith(".urdf")]
    return found[0] if len(found) == 1 else None


def tip_of(log):
    """The URDF link that is the tool, by robot.yaml or --set; None where neither says it plainly."""
    if "robot.tip" in log.overrides:
        return log.overrides["robot.tip"]
    for text in log.sources.values():
        found = re.search(r"^tip:\s*[\"']?([^\s\"'#]+)", text, re.MULTILINE)
        if found and re.search(r"^urdf:", text, re.MULTILINE):
            return found.group(1)
    return None


def read_cover(parameters, index, count, link):
    key = f"tactile_modules/{index}" if f"tactile_modules/{index}/length_m" in parameters else "tactile_module"
    if count > 1 and key == "tactile_module" or f"{key}/length_m" not in parameters:
        return None
    return Cover(link, parameters[f"{key}/length_m"], parameters[f"{key}/cover_radius_m"])


def read_obstacles(parameters):
    """Lines, posts and spheres; planes have no ends to be drawn."""
    found = []
    while any(name.startswith(f"simulation/obstacles/{len(found)}/") for name in parameters):
        found.append(read_obstacle(parameters, f"simulation/obstacles/{len(found)}"))
    return [obstacle for obstacle in found if obstacle]


def read_obstacle(parameters, key):
    def vector(name):
        return np.array([parameters[f"{key}/{name}/{axis}"] for axis in range(3)])

    if f"{key}/x_m" in parameters:
        foot = np.array([parameters[f"{key}/x_m"], parameters[f"{key}/y_m"], 0.0])
        return Obstacle(foot, foot + [0.0, 0.0, 1.5], 0.0)
    if f"{key}/post/radius_m" in parameters:
        axis, foot = vector("post/axis"), vector("post/foot_m")
        top = foot + parameters[f"{key}/post/height_m"] * axis / np.linalg.norm(axis)
        return Obstacle(foot, top, parameters[f"{key}/post/radius_m"])
    if f"{key}/line/point_m/0" in parameters:
        axis, point = vector("line/direction"), vector("line/point_m")
        return Obstacle(point - axis / np.linalg.norm(axis), point + axis / np.linalg.norm(axis), 0.0)
    if f"{key}/sphere/radius_m" in parameters:
        return Obstacle(vector("sphere/center_m"), vector("sphere/center_m"),
                        parameters[f"{key}/sphere/radius_m"])
    return None
