"""What tools/mutate does; see there.

A mutant is one changed source, compiled alone and linked in the place of its own object; all else of the
programs is as the build folder has it. Each has a sandbox folder of its own."""

import collections
import concurrent.futures
import dataclasses
import hashlib
import json
import math
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import threading

import yaml

import places

MEMORY_BYTES = 6 << 30  # of a test program: a mutant may ask for all
LEAST_CPU_S = 5.0
MOST_TIMES = 5.0  # of what the program takes unchanged


@dataclasses.dataclass(frozen=True)
class Stage:
    """A program that judges, with its arguments; the first that fails has killed the mutant."""

    name: str
    program: str
    arguments: tuple = ()


@dataclasses.dataclass
class Target:
    """What is mutated and how it is judged: layers of the tree, or a toy of a test."""

    root: pathlib.Path
    files: list
    flags: dict  # file -> compiler and flags
    clang_flags: dict  # file -> those of clang's reading
    link: object  # of (program, {file: its changed object}, output): a finished process
    stages: object  # of a file: those that judge its mutants, the likeliest first


def limits(cpu_s):
    def apply():
        resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(cpu_s), math.ceil(cpu_s) + 1))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    return apply


def cpu_s(done):
    return float(done.stderr.rsplit("cpu_s ", 1)[1].split()[0]) if "cpu_s " in done.stderr else 0.0


# The time of a child's processor alone, which no other load of the machine changes.
MEASURED = """import resource, subprocess, sys
code = subprocess.call(sys.argv[1:])
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print("cpu_s", used.ru_utime + used.ru_stime, file=sys.stderr)
sys.exit(code if code >= 0 else 128 - code)"""


def run_stage(stage, program, folder, most_s):
    command = [str(program), *stage.arguments]
    return subprocess.run(["/usr/bin/python3", "-c", MEASURED, *command], cwd=folder, text=True, errors="replace",
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=limits(most_s))


def killer(stage, done):
    """The test that failed, or what ended the program."""
    if done.returncode in (128 + signal.SIGXCPU, 128 + signal.SIGKILL):
        return f"{stage.name}: time"
    failed = re.search(r"\[  FAILED  \] ([\w./]+)", done.stdout)
    if failed:
        return failed[1]
    running = re.findall(r"\[ RUN      \] ([\w./]+)", done.stdout)
    what = f"ends with {signal.Signals(done.returncode - 128).name}" if done.returncode > 128 else \
        f"exit code {done.returncode}"
    return f"{running[-1] if running else stage.name}: {what}"


def baseline(target, folder, stages):
    """CPU time of each stage unchanged, from the last run where the programs are the same."""
    path = folder / "baseline.json"
    known = json.loads(path.read_text()) if path.exists() else {}
    for stage in stages:
        if stage.name in known:
            continue
        sandbox = folder / "unchanged"
        sandbox.mkdir(exist_ok=True)
        program = sandbox / stage.program
        done = target.link(stage.program, {}, program)
        if done.returncode:
            raise SystemExit(f"{stage.program} does not link unchanged:\n{done.stderr[-2000:]}")
        done = run_stage(stage, program, sandbox, 3600)
        if done.returncode:
            raise SystemExit(f"{stage.name} fails unchanged:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        known[stage.name] = cpu_s(done)
        path.write_text(json.dumps(known, indent=1))
    return known


def compile_source(target, file, source, output):
    words = [*target.flags[file], "-iquote", str((target.root / file).parent), "-c", str(source), "-o", str(output)]
    return subprocess.run(words, capture_output=True, text=True)


def trial(target, mutant, folder, base):
    """(state, by): killed by a test, survived, or 'does not compile'."""
    sandbox = folder / f"sandbox-{hashlib.sha256(mutant.name.encode()).hexdigest()[:12]}"
    shutil.rmtree(sandbox, ignore_errors=True)
    sandbox.mkdir(parents=True)
    try:
        source = (target.root / mutant.file).read_bytes()
        changed = sandbox / pathlib.Path(mutant.file).name
        changed.write_bytes(source[:mutant.start] + mutant.text.encode() + source[mutant.end:])
        output = sandbox / "mutant.o"
        if compile_source(target, mutant.file, changed, output).returncode:
            return "does not compile", ""
        linked = {}
        for stage in target.stages(mutant.file):
            program = sandbox / stage.program
            if stage.program not in linked:
                done = target.link(stage.program, {mutant.file: output}, program)
                if done.returncode:
                    return "does not compile", "does not link"
                linked[stage.program] = program
            done = run_stage(stage, program, sandbox, max(LEAST_CPU_S, MOST_TIMES * base[stage.name]))
            if done.returncode:
                return "killed", killer(stage, done)
        return "survived", ""
    finally:
        shutil.rmtree(sandbox, ignore_errors=True)


def code_at(target, mutant):
    return (target.root / mutant.file).read_text().splitlines()[mutant.line - 1].strip()


def reason_for(target, mutant, listed):
    """Of the list: same file, text of the line and change; `nth` where a line has several such places."""
    for entry in listed:
        if entry["file"] == mutant.file and entry["code"] == code_at(target, mutant) and \
                mutant.what in entry["what"] and entry.get("column", mutant.column) == mutant.column:
            return entry
    return None


def version(target, file):
    """Of the source: a result of another is none."""
    return hashlib.sha256((target.root / file).read_bytes()).hexdigest()[:12]


class Results:
    """A line of text a mutant, tab between: version, state, by whom, name. Appended, so a run can go on."""

    def __init__(self, path):
        self.path, self.lock, self.known = path, threading.Lock(), {}
        if path.exists():
            for line in path.read_text().splitlines():
                if line.count("\t") == 3:  # not half a line of a run that was ended
                    of, state, by, name = line.split("\t")
                    self.known[of, name] = state, by

    def add(self, of, mutant, state, by):
        with self.lock:
            self.known[of, mutant.name] = state, by
            with self.path.open("a") as file:
                file.write(f"{of}\t{state}\t{by}\t{mutant.name}\n")


def interval_95(killed, all_of):
    """Wilson's, of a share that a sample has."""
    if not all_of:
        return 0.0, 1.0
    z, share = 1.96, killed / all_of
    middle = share + z * z / (2 * all_of)
    half = z * math.sqrt(share * (1 - share) / all_of + z * z / (4 * all_of * all_of))
    return (middle - half) / (1 + z * z / all_of), (middle + half) / (1 + z * z / all_of)


def chosen(mutants, sample, seed):
    """A larger sample of the same seed holds the smaller one."""
    order = sorted(mutants)
    random.Random(seed).shuffle(order)
    return order[:sample] if sample else order


def places_of(target, file, folder):
    """Remembered for this version of the source, as clang reads headers for seconds."""
    known = folder / "places" / f"{file.replace('/', '_')}.{version(target, file)}.json"
    if known.exists():
        return [places.Mutant(*fields) for fields in json.loads(known.read_text())]
    found = places.mutants(target.root / file, target.clang_flags[file], file)
    known.parent.mkdir(exist_ok=True)
    part = known.with_suffix(".part")
    part.write_text(json.dumps([dataclasses.astuple(mutant) for mutant in found]))
    part.rename(known)
    return found


def run(target, folder, options, listed):
    folder.mkdir(parents=True, exist_ok=True)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        found = pool.map(lambda file: places_of(target, file, folder), target.files)
        every = [mutant for of_file in found for mutant in of_file]
    stale = [entry for entry in listed if not any(reason_for(target, mutant, [entry]) for mutant in every
                                                  if mutant.file == entry["file"])
             and entry["file"] in target.files]
    for entry in stale:
        print(f"reason that fits no mutant any more: {entry['file']}: {entry['code']}: {entry['what']}")
    mutants = chosen(every, options.sample, options.seed)
    results = Results(folder / "results.txt")
    versions = {file: version(target, file) for file in target.files}

    def known(mutant):
        return results.known.get((versions[mutant.file], mutant.name))

    open_ones = [mutant for mutant in mutants
                 if (known(mutant) is None or (options.again and known(mutant)[0] == "survived"))
                 and not reason_for(target, mutant, listed)]
    stages = {stage.name: stage for mutant in open_ones for stage in target.stages(mutant.file)}
    base = baseline(target, folder, stages.values())

    def judge(mutant):
        state, by = trial(target, mutant, folder, base)
        results.add(versions[mutant.file], mutant, state, by)
        print(f"{mutant.name}: {state}{' by ' if by else ''}{by}", flush=True)

    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for done in [pool.submit(judge, mutant) for mutant in open_ones]:
            done.result()
    return stale, table(target, mutants, known, listed, len(every))


def table(target, mutants, known, listed, every):
    counts = collections.Counter()
    print("\n== what is not killed")
    for mutant in sorted(mutants):
        entry = reason_for(target, mutant, listed)
        state = "equivalent" if entry else known(mutant)[0]
        counts[state] += 1
        if state == "survived" or entry:
            print(f"{mutant.name}: {state}{': ' + entry['reason'] if entry else ''}\n    {code_at(target, mutant)}")
    judged = counts["killed"] + counts["survived"]
    low, high = interval_95(counts["killed"], judged)
    print(f"\n{every} mutants, {len(mutants)} of them drawn: {counts['killed']} killed, {counts['survived']} survived, "
          f"{counts['equivalent']} equivalent, {counts['does not compile']} do not compile")
    print(f"score: {counts['killed']} of {judged}, {100 * counts['killed'] / max(1, judged):.1f} %"
          + (f", 95 % interval {100 * low:.1f} to {100 * high:.1f} %" if len(mutants) < every else ""))
    return counts


def read_list(path):
    return yaml.safe_load(path.read_text()) or [] if path.exists() else []
