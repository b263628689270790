"""The layers of the tree as targets of mutation: objects, programs and the tests that judge them."""

import concurrent.futures
import functools
import hashlib
import re
import subprocess

import places
from programs import LAYERS, SOURCE, compile_flags, link, link_command, sources
from trials import Stage, Target

BUILD = SOURCE / "build" / "release"
# After a layer's own tests: whole runs in virtual time.
OTHERS = {"control": ("sim", "supervisor"), "canopen": ("supervisor", "plant"), "supervisor": ()}
LONG_S = 1.0
CAMPAIGN = Stage("campaign", "tactus_campaign", ("--runs", "40"))


def tests_of(layer):
    return Stage(layer, f"tactus_{layer}_tests", has_tests=True)


def shorter_tests_of(layer):
    return Stage(f"{layer}'s shorter ones", f"tactus_{layer}_tests", has_tests=True, most_s=LONG_S)


PROGRAMS = sorted({tests_of(layer).program for layer in (*LAYERS, *sum(OTHERS.values(), ()))} | {CAMPAIGN.program})


@functools.cache
def suites(file):
    """Of the test files whose names share most words with the source's, so the likeliest to kill."""
    _, layer, name = file.split("/")
    words = set(name.removesuffix(".cpp").split("_"))
    found = set()
    for path in sorted((SOURCE / "tests" / layer).glob("*_test.cpp")):
        own = path.stem.removesuffix("_test").split("_")
        near = len(words & set(own)) / len(words | set(own))
        if near >= 0.34:
            found |= set(re.findall(r"^(?:TEST|TEST_F|TEST_P)\((\w+),", path.read_text(), re.M))
    return found


def stages(layer, own):
    return [tests_of(layer)] if own else [tests_of(layer), *map(shorter_tests_of, OTHERS[layer]), CAMPAIGN]


def precompiled(folder, flags):
    """Eigen's headers, which are most of a compilation."""
    header = folder / "precompiled.h"
    if not header.with_suffix(".h.gch").exists():
        header.write_text("#include <Eigen/Geometry>\n#include <string>\n#include <vector>\n")
        subprocess.run([*flags, "-x", "c++-header", str(header), "-o", f"{header}.gch"], check=True)
    return ["-include", str(header)]


def compiled(folder, files, flags, jobs):
    """An object for each unchanged source, compiled again where anything of the layers has changed."""
    text = hashlib.sha256()
    for path in sorted((SOURCE / "include").rglob("*.h")):
        text.update(path.read_bytes())
    headers = text.hexdigest()
    objects, missing = {}, []
    for file in files:
        version = hashlib.sha256((SOURCE / file).read_bytes() + headers.encode()).hexdigest()[:16]
        objects[file] = folder / "objects" / f"{file.replace('/', '_')}.{version}.o"
        if not objects[file].exists():
            missing.append(file)

    def one(file):
        part = objects[file].with_suffix(".part")
        subprocess.run([*flags[file], "-c", str(SOURCE / file), "-o", str(part)], check=True)
        part.rename(objects[file])

    (folder / "objects").mkdir(parents=True, exist_ok=True)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        list(pool.map(one, missing))
    return objects


def layer_target(folder, layers, jobs, own):
    every = [str(path.relative_to(SOURCE)) for layer in layers for path in sources(layer)]
    base = {layer: [*compile_flags(BUILD, layer), "-O1", "-w"] for layer in layers}
    folder.mkdir(parents=True, exist_ok=True)
    header = precompiled(folder, base[layers[0]])
    flags = {file: [*base[file.split("/")[1]], *header] for file in every}
    read = folder / "precompiled.ast"
    if not read.exists():
        places.precompile(folder / "precompiled.h", base[layers[0]][1:], read)
    clang_flags = {file: [*base[file.split("/")[1]][1:], "-include-pch", str(read)] for file in every}
    objects = compiled(folder, every, flags, jobs)
    lines = {program: link_command(BUILD, program) for program in PROGRAMS}

    def linked(program, replaced, output):
        changed = {file.split("/")[1] for file in replaced}
        words = {layer: [str(replaced.get(file, objects[file])) for file in every if file.split("/")[1] == layer]
                 for layer in changed}
        return link(BUILD, lines[program], words, output)

    return Target(SOURCE, every, flags, clang_flags, linked,
                  lambda file: stages(file.split("/")[1], own), suites)
