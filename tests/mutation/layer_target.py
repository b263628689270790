"""The layers of the tree as targets of mutation: objects, programs and the tests that judge them."""

import concurrent.futures
import hashlib
import json
import re
import shutil
import subprocess

import places
from mutate import Stage, Target
from programs import LAYERS, SOURCE, compile_flags, link, link_command, sources

BUILD = SOURCE / "build" / "release"
# Runs of minutes over code that the rest reaches, too: what they judge is forces.
LONG = "*Chance*:RetreatForce*:SceneOnBuses*:GainsInContact*:*Oracle*:*Moteus*"
# After a layer's own tests: whole runs in virtual time, none of more than some seconds.
OTHERS = {
    "control": (Stage("sim", "tactus_sim_tests", ("--gtest_fail_fast",)),
                Stage("supervisor", "tactus_supervisor_tests", ("--gtest_fail_fast", f"--gtest_filter=-{LONG}"))),
    "canopen": (Stage("supervisor", "tactus_supervisor_tests", ("--gtest_fail_fast", f"--gtest_filter=-{LONG}")),
                Stage("plant", "tactus_plant_tests", ("--gtest_fail_fast",))),
    "supervisor": (),
}
CAMPAIGN = Stage("campaign", "tactus_campaign", ("--runs", "40"))
PROGRAMS = sorted({f"tactus_{layer}_tests" for layer in LAYERS} | {CAMPAIGN.program}
                  | {stage.program for stages in OTHERS.values() for stage in stages})


def suites(layer, stem):
    """Suites of the test files whose names share most words with the source's, so the likeliest to kill."""
    words = set(stem.split("_"))
    found = []
    for path in sorted((SOURCE / "tests" / layer).glob("*_test.cpp")):
        own = path.stem.removesuffix("_test").split("_")
        near = len(words & set(own)) / len(words | set(own))
        if near >= 0.34:
            names = re.findall(r"^(?:TEST|TEST_F|TEST_P)\((\w+),", path.read_text(), re.M)
            found.append((-near, sorted(set(names))))
    return [name for _, names in sorted(found) for name in names]


def stages(file, own):
    _, layer, name = file.split("/")
    program = f"tactus_{layer}_tests"
    near = suites(layer, name.removesuffix(".cpp"))
    first = []
    if near:
        patterns = ":".join(f"{suite}.*:*/{suite}.*" for suite in near)
        first.append(Stage(f"near {patterns}", program, ("--gtest_fail_fast", f"--gtest_filter={patterns}")))
    whole = Stage(layer, program, ("--gtest_fail_fast", f"--gtest_filter=-{LONG}"))
    return [*first, whole] if own else [*first, whole, *OTHERS[layer], CAMPAIGN]


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


def forget_old(folder):
    """What the unchanged programs took is of other programs, if they were built since."""
    state = json.dumps([(BUILD / "tests" / program).stat().st_mtime_ns for program in PROGRAMS])
    mark = folder / "state"
    key = hashlib.sha256(state.encode()).hexdigest()
    if not mark.exists() or mark.read_text() != key:
        (folder / "baseline.json").unlink(missing_ok=True)
        shutil.rmtree(folder / "unchanged", ignore_errors=True)
        mark.write_text(key)


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
    forget_old(folder)

    def linked(program, replaced, output):
        changed = {file.split("/")[1] for file in replaced}
        words = {layer: [str(replaced.get(file, objects[file])) for file in every if file.split("/")[1] == layer]
                 for layer in changed}
        return link(BUILD, lines[program], words, output)

    return Target(SOURCE, every, flags, clang_flags, linked,
                  lambda file: stages(file, own))
