#!/usr/bin/env python3
"""Writes the fuzzer's seeds (a scene with all its files in one text) and its dictionary.

usage: make_seeds.py CONFIG_DIR SEED_DIR DICTIONARY
"""
import pathlib
import re
import sys


def files_of(path):
    """The file and everything it names, each once, the file first."""
    text = path.read_text()
    found = [path]
    for name in re.findall(r"^(?:extends|robot|urdf): *(\S+)", text, re.MULTILINE):
        found += files_of((path.parent / name).resolve())
    return list(dict.fromkeys(found))


def hardware_seed(config):
    """A scene on the robot with all keys of the hardware, and one trouble of each shape."""
    scene = config / "scenes/scenario1_multi_space.yaml"
    robot = config / "robots/crops9/robot_with_lines.yaml"
    time = "from_s: 1, until_s: 2"
    troubles = [
        f"{{kind: delay, {time}, interface: can3, id: 0x101, delay_s: 0.01}}",
        f"{{kind: power_cut, {time}, interface: can0}}",
        f"{{kind: drive_fault, {time}, interface: can2, id: 3}}",
        f"{{kind: emergency_stop, {time}}}",
    ]
    files = [file for file in files_of(scene) if file.name != "robot.yaml"] + [robot]
    return (
        "".join(f"=== {file.relative_to(config)}\n{file.read_text()}" for file in files)
        + "=== --set robot\n../robots/crops9/robot_with_lines.yaml\n"
        + f"=== --set simulation.troubles\n[{', '.join(troubles)}]\n"
    )


def main():
    config, seeds, dictionary = map(pathlib.Path, sys.argv[1:])
    config = config.resolve()
    seeds.mkdir(parents=True, exist_ok=True)
    words = set()
    for scene in sorted(config.glob("scenes/**/*.yaml")):
        text = "".join(
            f"=== {file.relative_to(config)}\n{file.read_text()}" for file in files_of(scene)
        )
        (seeds / scene.with_suffix(".txt").name).write_text(text)
        words |= set(re.findall(r"[A-Za-z_]\w{2,}:?", text))
    text = hardware_seed(config)
    (seeds / "hardware.txt").write_text(text)
    words |= set(re.findall(r"[A-Za-z_]\w{2,}:?", text))
    words |= {"=== ", "--set ", "null", "[]", "{}", "[0].", "nan", "1e308", "-1", "&a ", "*a", "!t "}
    dictionary.write_text("".join(f'"{word}"\n' for word in sorted(words)))


main()
