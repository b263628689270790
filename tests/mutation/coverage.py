"""What tools/coverage does; see there."""

import collections
import concurrent.futures
import json
import os
import pathlib
import shutil
import subprocess

import yaml

from programs import LAYERS, SOURCE, build, compile_flags, link, sources

BUILD = SOURCE / "build" / "release"
LIST = pathlib.Path(__file__).parent / "coverage.yaml"
CLANG, PROFDATA, COV = "clang++-19", "llvm-profdata-19", "llvm-cov-19"
PACKAGES = "clang-19 libclang-rt-19-dev llvm-19"
# The layers' tests, then others that take them through whole runs.
RUNS = (
    ("tactus_supervisor_tests", "--gtest_filter=-GainsInContact*"),  # minutes over what others reach
    ("tactus_control_tests",),
    ("tactus_canopen_tests",),
    ("tactus_sim_tests",),
    ("tactus_plant_tests",),
    ("tactus_campaign", "--runs", "60"),
)
# Minutes over code that the rest reaches, too.
QUICK = "--gtest_filter=-*Chance*:RetreatForce*:*SceneOnBuses*:GainsInContact*:GateOracle*:*Oracle*"


def run(command, **more):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **more)
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, command))}:\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return done.stdout


def profile_list(folder):
    """Only the layers and their headers are counted: Eigen's templates are another's."""
    allowed = [f"source:*{tree}/{layer}/*=allow" for layer in LAYERS for tree in ("src", "include/tactus")]
    path = folder / "profile.list"
    path.write_text("\n".join(["[clang]", "default:skip", *allowed, "source:/usr/*=skip",
                               "source:*include/tactus/math/*=skip"]) + "\n")
    return path


def compile_layer(folder, layer):
    """All sources of a layer in one compilation, as names are unique in a layer."""
    unity, output = folder / f"{layer}.cpp", folder / f"{layer}.o"
    unity.write_text("".join(f'#include "{path}"\n' for path in sources(layer)))
    run([CLANG, *compile_flags(BUILD, layer)[1:], "-O1", "-w", "-fprofile-instr-generate",
         "-fcoverage-mapping", "-fcoverage-mcdc", f"-fprofile-list={profile_list(folder)}",
         "-c", unity, "-o", output])
    return output


def run_tests(folder, objects, command, quick):
    """Links a program and runs it; each process writes a profile of its own."""
    program = folder / command[0]
    done = link(BUILD, command[0], {layer: [str(path)] for layer, path in objects.items()}, program,
                CLANG, ["-fprofile-instr-generate"])
    if done.returncode:
        raise SystemExit(done.stderr[-3000:])
    words = [program, *command[1:]]
    if command[0].endswith("_tests"):
        words += ["--gtest_brief=1"] + ([QUICK] if quick else [])  # the last filter counts
    run(words, cwd=SOURCE, env={**os.environ, "LLVM_PROFILE_FILE": f"{folder}/raw/{command[0]}.%p.profraw"})


def measure(folder, jobs, quick):
    shutil.rmtree(folder / "raw", ignore_errors=True)
    (folder / "raw").mkdir(parents=True)
    with concurrent.futures.ThreadPoolExecutor(jobs or os.cpu_count()) as pool:
        objects = dict(zip(LAYERS, pool.map(lambda layer: compile_layer(folder, layer), LAYERS)))
        runs = RUNS[:5] if quick else RUNS
        list(pool.map(lambda command: run_tests(folder, objects, command, quick), runs))
    run([PROFDATA, "merge", "-o", folder / "merged.profdata", *(folder / "raw").glob("*.profraw")])


def exported(folder, form):
    return run([COV, "export", f"-format={form}", f"-instr-profile={folder / 'merged.profdata'}",
                folder / "tactus_supervisor_tests"])


def own(name):
    """The path within the tree of a file of the layers, nothing of another."""
    path = pathlib.Path(name)
    if not path.is_relative_to(SOURCE):
        return None
    path = path.relative_to(SOURCE)
    layer = {"src": 1, "include": 2}.get(path.parts[0])
    return str(path) if layer and path.parts[layer] in LAYERS else None


def elsewhere(document, program):
    """{file: lines} of functions of headers that these layers call nowhere: they are compiled into other
    layers and tests, which are not counted."""
    counted = run(["llvm-nm-19", program])
    result = collections.defaultdict(set)
    for function in document["functions"]:
        file = own(function["filenames"][0])
        if file and file.startswith("include/") and f"__profc_{function['name']}\n" not in counted:
            for first, _, last, *_ in function["regions"]:
                result[file].update(range(first, last + 1))
    return result


def lines_of(lcov):
    """{file: {line: count}}"""
    result, file = {}, None
    for text in lcov.splitlines():
        key, _, value = text.partition(":")
        if key == "SF":
            file = own(value)
        elif key == "DA" and file:
            line, count = value.split(",")[:2]
            result.setdefault(file, {})[int(line)] = int(count)
    return result


def branches_of(document):
    """{file: {(line, column, outcome): count}}; instances of a template count together."""
    result = {}
    for entry in document["files"]:
        file = own(entry["filename"])
        if file:
            counts = result.setdefault(file, collections.Counter())
            for line, column, _, _, taken, left, *_ in entry["branches"]:
                counts[line, column, "true"] += taken
                counts[line, column, "false"] += left
    return result


def conditions_of(document):
    """{file: {(line, column, number of the condition): has shown that it decides alone}}"""
    result = {}
    for entry in document["files"]:
        file = own(entry["filename"])
        if file:
            shown = result.setdefault(file, {})
            for record in entry.get("mcdc_records", []):
                conditions = next(part for part in record[4:] if isinstance(part, list))
                for number, has in enumerate(conditions, 1):
                    place = record[0], record[1], number
                    shown[place] = shown.get(place, False) or has
    return result


def uncovered(lines, branches, conditions):
    """(file, line, kind, detail); what hangs on a line that is not reached is one with it."""
    result = []
    for file, counts in sorted(lines.items()):
        missed = {line for line, count in counts.items() if not count}
        result += [(file, line, "line", "") for line in sorted(missed)]
        result += [(file, line, "branch", f"column {column} never {outcome}")
                   for (line, column, outcome), count in sorted(branches.get(file, {}).items())
                   if not count and line not in missed]
        result += [(file, line, "condition", f"column {column}, condition {number}")
                   for (line, column, number), has in sorted(conditions.get(file, {}).items())
                   if not has and line not in missed]
    return result


def judge(missing, listed, text_at):
    """What no entry of the list gives a reason for, and the entries that fit nothing."""
    used, without = set(), []
    for file, line, kind, detail in missing:
        fits = [number for number, entry in enumerate(listed)
                if entry["file"] == file and entry["code"] == text_at(file, line) and kind in entry["kinds"]]
        used.update(fits)
        if not fits:
            without.append((file, line, kind, detail))
    return without, [entry for number, entry in enumerate(listed) if number not in used]


def share(counts):
    values = [bool(value) for file in counts.values() for value in file.values()]
    return f"{sum(values)} of {len(values)} ({100 * sum(values) / max(1, len(values)):.2f} %)"


def text_at(file, line):
    return (SOURCE / file).read_text().splitlines()[line - 1].strip()


def main(options):
    folder = options.o.resolve()
    if not options.report_only:
        for program in (CLANG, PROFDATA, COV, "llvm-nm-19"):
            if not shutil.which(program):
                raise SystemExit(f"tools/coverage: no {program}; as root: apt-get install {PACKAGES}")
        if not options.no_build:
            build(BUILD, [command[0] for command in RUNS])
        measure(folder, options.jobs, options.quick)
    document = json.loads(exported(folder, "text"))["data"][0]
    tables = lines_of(exported(folder, "lcov")), branches_of(document), conditions_of(document)
    for file, missed in elsewhere(document, folder / "tactus_supervisor_tests").items():
        for table in tables:
            for place in list(table.get(file, {})):
                if (place if isinstance(place, int) else place[0]) in missed:
                    del table[file][place]
    for layer in LAYERS:
        print(f"{layer}:", *(f"{name} {share({f: c for f, c in table.items() if f'/{layer}/' in f})}"
                             for name, table in zip(("lines", "branches", "conditions"), tables)), sep="\n  ")
    listed = yaml.safe_load(LIST.read_text()) or []
    without, stale = judge(uncovered(*tables), listed, text_at)
    for file, line, kind, detail in without:
        print(f"{file}:{line}: {kind} not covered{': ' if detail else ''}{detail}: {text_at(file, line)}")
    for entry in stale:
        print(f"{LIST.relative_to(SOURCE)}: nothing is uncovered there any more: {entry['file']}: {entry['code']}")
    print(f"{len(listed)} places with a reason, {len(without)} without, {len(stale)} reasons that fit nothing")
    return 1 if without or stale else 0
