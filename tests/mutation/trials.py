"""Whether a program notices a mutant. One that has a copy (copies.py) is chosen in programs that hold all of them;
another is compiled alone and linked in the place of its source's object. Of a program's tests only those run that
reach the changed function: first the suites next to the source, then the cheap ones. Each trial has a sandbox
folder of its own."""

import concurrent.futures
import dataclasses
import math
import os
import pathlib
import re
import resource
import signal
import subprocess
import tempfile

import copies
import places

MEMORY_BYTES = 6 << 30  # of a test program: a mutant may ask for all
LEAST_CPU_S = 3.0
MOST_TIMES = 5.0  # of what the tests take unchanged
CHEAP_S = 0.3
NEAR_S = 2.0


@dataclasses.dataclass(frozen=True)
class Stage:
    """A program that judges, with its arguments; the first that fails has killed the mutant."""

    name: str
    program: str
    arguments: tuple = ()
    has_tests: bool = False  # of GoogleTest, each of which can run by itself
    most_s: float = math.inf  # tests that take longer are left out


@dataclasses.dataclass
class Target:
    """What is mutated and how it is judged: layers of the tree, or a toy of a test."""

    root: pathlib.Path
    files: list
    flags: dict  # file -> compiler and flags
    clang_flags: dict  # file -> those of clang's reading
    link: object  # of (program, {file: its changed object}, output): a finished process
    stages: object  # of a file: those that judge its mutants, the likeliest first
    near: object = lambda file: ()  # suites that are likely to kill its mutants


@dataclasses.dataclass
class Test:
    name: str
    cpu_s: float
    reached: frozenset  # numbers of functions

    def is_of(self, suites):
        return not set(self.name.split(".")[0].split("/")).isdisjoint(suites)


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


def run(program, arguments, folder, most_s, **environment):
    command = ["/usr/bin/python3", "-S", "-c", MEASURED, str(program), *arguments]
    return subprocess.run(command, cwd=folder, text=True, errors="replace", env={**os.environ, **environment},
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=limits(most_s))


def run_unchanged(name, program, arguments, folder, **environment):
    done = run(program, arguments, folder, 3600, **environment)
    if done.returncode:
        raise SystemExit(f"{name} fails unchanged:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return cpu_s(done)


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


def list_tests(program, arguments):
    listed = subprocess.run([program, "--gtest_list_tests", *arguments], check=True, capture_output=True, text=True)
    names, suite = [], ""
    for line in listed.stdout.splitlines():
        if line.startswith("  "):
            names.append(suite + line.split()[0])
        elif line and line.split()[0].endswith("."):
            suite = line.split()[0]
    return names


class DoesNotLink(SystemExit):
    """Of a mutant that is compiled alone that is a state; of all else it ends the tool."""


class Trials:
    """Of these mutants; `folder` is made anew."""

    def __init__(self, target, mutants, folder, jobs):
        self.target, self.folder, self.jobs = target, folder, jobs
        self.numbers = {mutant: number for number, mutant in enumerate(mutants, 1)}
        self.files = sorted({mutant.file for mutant in mutants})
        self.refused, self.objects, self.programs, self.tests, self.whole_s = set(), {}, {}, {}, {}
        self.regions = self.find_regions()
        self.compile_copies()
        self.with_copy = {mutant for of_file in self.regions.values() for region in of_file
                          for mutant in region.mutants}
        for stage in {stage.name: stage for file in self.files for stage in target.stages(file)}.values():
            self.measure(stage)

    def find_regions(self):
        found, number = {}, 0
        for file in self.files:
            path = self.target.root / file
            unit = places.Finder(path, self.target.clang_flags[file], file).unit
            found[file] = copies.regions(unit.cursor, str(path), path.read_bytes())
            own = [mutant for mutant in self.numbers if mutant.file == file]
            for region in found[file]:
                number += 1
                region.number = number
                region.mutants = [mutant for mutant in own
                                  if region.start <= mutant.start and mutant.end <= region.end]
        return found

    def words(self, file):
        return [*self.target.flags[file], "-iquote", str((self.target.root / file).parent)]

    def compile_copies(self):
        def one(file):
            output = self.folder / f"{file.replace('/', '_')}.o"
            refused = copies.compile_all(self.words(file), (self.target.root / file).read_bytes(), file,
                                         self.regions[file], self.numbers, output)
            return file, output, refused

        with concurrent.futures.ThreadPoolExecutor(self.jobs) as pool:
            for file, self.objects[file], refused in pool.map(one, self.files):
                self.refused |= refused

    def link(self, program, objects, folder):
        output = folder / program
        done = self.target.link(program, objects, output)
        if done.returncode:
            raise DoesNotLink(f"{program} does not link:\n{done.stderr[-2000:]}")
        return output

    def measure(self, stage):
        """What each test reaches and takes, or what the whole stage takes."""
        if stage.program not in self.programs:
            self.programs[stage.program] = self.link(stage.program, self.objects, self.folder)
        program = self.programs[stage.program]

        def test(name):
            with tempfile.TemporaryDirectory(dir=self.folder) as sandbox:
                path = pathlib.Path(sandbox) / "reached.txt"
                taken_s = run_unchanged(name, program, (f"--gtest_filter={name}",), sandbox, TACTUS_REACHED=str(path))
                return Test(name, taken_s, frozenset(map(int, path.read_text().split())))

        if not stage.has_tests:
            with tempfile.TemporaryDirectory(dir=self.folder) as sandbox:
                self.whole_s[stage.name] = run_unchanged(stage.name, program, stage.arguments, sandbox)
            return
        with concurrent.futures.ThreadPoolExecutor(self.jobs) as pool:
            tests = pool.map(test, list_tests(program, stage.arguments))
            self.tests[stage.name] = [test for test in tests if test.cpu_s <= stage.most_s]

    def functions(self, mutant):
        """That have to be reached: its own, or any of its file where it is in none."""
        inside = self.regions[mutant.file]
        own = {region.number for region in inside if mutant in region.mutants and not region.is_constant}
        return own or {region.number for region in inside}

    def groups(self, mutant, stage):
        reaching = [test for test in self.tests[stage.name] if not self.functions(mutant).isdisjoint(test.reached)]
        first = [test for test in reaching if test.is_of(self.target.near(mutant.file)) and test.cpu_s < NEAR_S]
        rest = [test for test in reaching if test not in first]
        cheap = [test for test in rest if test.cpu_s < CHEAP_S]
        return [first, cheap, [test for test in rest if test not in cheap]]

    def runs(self, mutant):
        """(stage, arguments, CPU time unchanged)"""
        for stage in self.target.stages(mutant.file):
            if not stage.has_tests:
                yield stage, stage.arguments, self.whole_s[stage.name]
                continue
            for group in filter(None, self.groups(mutant, stage)):
                names = ":".join(test.name for test in group)
                yield stage, ("--gtest_fail_fast", f"--gtest_filter={names}"), sum(test.cpu_s for test in group)

    def judge(self, mutant, programs, sandbox):
        for stage, arguments, unchanged_s in self.runs(mutant):
            done = run(programs(stage.program), arguments, sandbox, max(LEAST_CPU_S, MOST_TIMES * unchanged_s),
                       TACTUS_MUTANT=str(self.numbers[mutant]))
            if done.returncode:
                return "killed", killer(stage, done)
        return "survived", ""

    def alone(self, mutant, sandbox):
        source = (self.target.root / mutant.file).read_bytes()
        changed = sandbox / pathlib.Path(mutant.file).name
        changed.write_text(copies.changed(source, 0, len(source), mutant))
        output = sandbox / "mutant.o"
        words = [*self.words(mutant.file), "-c", str(changed), "-o", str(output)]
        if subprocess.run(words, capture_output=True).returncode:
            return "does not compile", ""
        linked = {}

        def program(name):
            if name not in linked:
                linked[name] = self.link(name, {mutant.file: output}, sandbox)
            return linked[name]

        try:
            return self.judge(mutant, program, sandbox)
        except DoesNotLink:
            return "does not compile", "does not link"

    def trial(self, mutant):
        """(state, by): killed by a test, survived, or 'does not compile'."""
        if mutant in self.refused:
            return "does not compile", ""
        with tempfile.TemporaryDirectory(dir=self.folder) as sandbox:
            if mutant in self.with_copy:
                return self.judge(mutant, self.programs.get, sandbox)
            return self.alone(mutant, pathlib.Path(sandbox))
