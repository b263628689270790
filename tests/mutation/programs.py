"""Test programs of a build folder, linked again with other objects for some of their layers.

The build folder gives all but those layers: flags are taken from its compile_commands.json, link lines
from ninja. So neither tests nor other layers are compiled again."""

import json
import pathlib
import re
import shlex
import subprocess

SOURCE = pathlib.Path(__file__).resolve().parents[2]
LAYERS = ("control", "canopen", "supervisor")
UNKNOWN_TO_CLANG = "-fno-var-tracking"  # begins so


def sources(layer, root=SOURCE):
    return sorted((root / "src" / layer).glob("*.cpp"))


def build(folder, programs):
    """Up to date, as the release preset has them."""
    for command in (
        ["cmake", "--preset", "release"],
        ["cmake", "--build", str(folder), "--target", *programs, "--", "-j2", "--quiet"],
    ):
        subprocess.run(command, cwd=SOURCE, check=True, stdout=subprocess.DEVNULL)


def compile_flags(folder, layer):
    """Compiler and flags of a layer, without its optimisation, precompiled header, input and output, and without
    what clang does not know of the packages'."""
    for entry in json.loads((folder / "compile_commands.json").read_text()):
        if f"/tactus_{layer}.dir/" in entry["command"] and "/tests/" not in entry["command"]:
            words = iter(shlex.split(entry["command"]))
            flags = []
            for word in words:
                if word in ("-o", "-c", "-include"):
                    next(words)
                elif not re.match(rf"{UNKNOWN_TO_CLANG}|-(O\d|Winvalid-pch|Werror|W|-param|ffile-prefix-map)", word):
                    flags.append(word)
                elif word == "--param":
                    next(words)
            return flags
    raise SystemExit(f"{folder}/compile_commands.json has no layer {layer}: configure it first")


def link_command(folder, program):
    """The words of a program's link, which has to run in the build folder."""
    lines = subprocess.run(
        ["ninja", "-C", str(folder), "-t", "commands", program],
        check=True, capture_output=True, text=True).stdout.splitlines()
    steps = [step.strip() for step in lines[-1].split("&&")]
    return shlex.split(next(step for step in steps if " -o " in step))


def link(folder, program, replaced, output, compiler=None, more=()):
    """Links the program with `replaced[layer]` (words) in the place of libtactus_<layer>.a."""
    words = link_command(folder, program) if isinstance(program, str) else list(program)
    if compiler:
        words = [compiler, *(word for word in words[1:] if not word.startswith(UNKNOWN_TO_CLANG))]
    words[words.index("-o") + 1] = str(output)
    result, rest = [], dict(replaced)
    for word in words:
        layer = re.fullmatch(r"libtactus_(\w+)\.a", word)
        # An archive may be named twice, an object may not.
        result += rest.pop(layer[1], []) if layer and layer[1] in replaced else [word]
        if layer and layer[1] in replaced:
            rest[layer[1]] = []
    return subprocess.run([*result, *more], cwd=folder, capture_output=True, text=True)
