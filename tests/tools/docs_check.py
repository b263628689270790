"""What documents promise: links that lead somewhere, files that are there, commands that work.

A document's commands stand in fenced blocks marked `sh`. They are tried in the order in which they
stand, in a scratch folder that has a copy of config and the files that the document shows: a `yaml`
block that begins with `# name.yaml` is such a file. Commands of tactus that are cheap are run; of all
others it is looked at whether programs, files, options, presets and test programs exist."""

import json
import pathlib
import re
import shlex
import shutil
import subprocess

# Programs of the system that a document may name: they need a robot's computer, or a whole machine.
SYSTEM = {"apt", "apt-get", "cp", "export", "git", "ip", "journalctl", "mkdir", "reboot",
          "systemctl"}
# Commands of tactus that are run as they stand; of all others --help must know the options.
RUN = {"init", "check", "simulate", "export", "replay", "keys"}
LANGUAGES = {"sh", "yaml", "text", "python"}  # python: tests/python/docs_test.py runs it
PROGRAMS = {"build/release/tactus": "tactus", "build/dev/tactus": "tactus", "tactus": "tactus",
            "build/release/tactusd": "tactusd", "tactusd": "tactusd"}
FOLDERS = ("config", "debian", "docs", "examples", "include", "src", "tests", "tools", ".ci")
LOOP_WORDS = {"do", "done", "for", "then", "fi", "if"}


def fenced_blocks(text):
    """(line of the fence, language, body) of each fenced block."""
    for match in re.finditer(r"^```(\w*)\n(.*?)^```$", text, re.M | re.S):
        yield text.count("\n", 0, match.start()) + 1, match.group(1), match.group(2)


def prose(text):
    """The text without its fenced blocks, at the same lines."""
    return re.sub(r"^```.*?^```$", lambda match: "\n" * match.group().count("\n"), text,
                  flags=re.M | re.S)


def anchors(text):
    """The anchors of a page's headings, as GitHub makes them."""
    titles = re.findall(r"^#+ (.+)$", prose(text), re.M)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def simple_commands(block):
    """(line in the block, words) of each command, without loops' words and what follows a #."""
    for number, line in enumerate(block.splitlines()):
        lexer = shlex.shlex(line, posix=True, punctuation_chars=";&|<>")
        lexer.whitespace_split = True
        lexer.commenters = "#"
        words = []
        for word in [*lexer, ";"]:
            if not re.fullmatch(r"[;&|]+", word):
                words.append(word)
                continue
            if words[:1] == ["for"]:
                words = []
            while words and words[0] in LOOP_WORDS:
                words = words[1:]
            if words:
                yield number, words
            words = []


class Checker:
    """Collects what is wrong with documents below a root, `file:line: what`."""

    def __init__(self, root, programs, scratch):
        self.root = root
        self.programs = programs  # "tactus" and "tactusd" as built
        self.scratch = scratch
        self.found = []
        self.place = ""
        self.commands = 0
        self.links = 0

    def complain(self, problem):
        self.found.append(f"{self.place}: {problem}")

    def check(self, path):
        text = path.read_text()
        name = path.relative_to(self.root)
        self.check_links(path, name, prose(text))
        for line, language, body in fenced_blocks(text):
            self.place = f"{name}:{line}"
            if language not in LANGUAGES:
                self.complain(f"a block of language '{language}', expected one of {sorted(LANGUAGES)}")
            if language == "yaml":
                self.show_file(body)
        for line, language, body in fenced_blocks(text):
            for number, words in simple_commands(body) if language == "sh" else ():
                self.place = f"{name}:{line + 1 + number}"
                self.commands += 1
                self.check_command(words)

    def check_links(self, path, name, text):
        for match in re.finditer(r"\]\(([^)\s]+)\)|`([^`\n]+)`|^ {4}(\S+)", text, re.M):
            target, code, indented = match.groups()
            self.place = f"{name}:{text.count(chr(10), 0, match.start()) + 1}"
            if target:
                self.links += 1
                self.check_link(path, target)
            elif code:
                self.check_code(code)
            elif indented and (indented in PROGRAMS or self.is_tool(indented)):
                self.complain(f"{indented} in an indented block, expected a block marked sh")

    def check_code(self, code):
        """In the text: files are there, commands and their options exist."""
        word, *arguments = re.sub(r"[\[\]]", "", code).split() or [""]
        if re.match(rf"({'|'.join(map(re.escape, FOLDERS))})/", word):
            self.check_file(word)
        elif word in PROGRAMS and arguments and re.match(r"[-a-z]", arguments[0]):
            self.commands += 1
            self.check_options(PROGRAMS[word], arguments)

    def check_link(self, path, target):
        file, _, anchor = target.partition("#")
        if re.match(r"https?://\w", target):
            return
        page = (path.parent / file) if file else path
        if not page.exists():
            self.complain(f"link to {target}: there is no such file")
        elif anchor and anchor not in anchors(page.read_text()):
            self.complain(f"link to {target}: there is no such heading")

    def is_tool(self, word):
        return word.startswith(FOLDERS) and (self.root / word).is_file()

    def check_file(self, word):
        """A path of the source tree; patterns and names in <> stand for others."""
        if "<" not in word and not list(self.root.glob(word.rstrip("/"))):
            self.complain(f"there is no {word}")

    def show_file(self, body):
        name = re.match(r"# (\w+\.yaml)\n", body)
        if name:
            (self.scratch / name.group(1)).write_text(body)

    def check_command(self, words):
        words = words[1:] if words[0] == "sudo" else words
        program, arguments = words[0], words[1:]
        test_program = re.fullmatch(r"build/\w+/tests/tactus_(\w+)_tests", program)
        if program in PROGRAMS:
            self.check_tactus(PROGRAMS[program], arguments)
        elif program in ("cmake", "ctest"):
            self.check_preset(program, arguments)
        elif test_program:
            self.check_file(f"tests/{test_program.group(1)}/")
        elif self.is_tool(program):
            self.check_tool(program, arguments)
        elif program not in SYSTEM:
            self.complain(f"{program}: neither a file of the source nor a program that is known here")

    def check_tool(self, program, arguments):
        """The text of a script names its options, in what it says of itself or in its code."""
        text = (self.root / program).read_text(errors="replace")
        if not (self.root / program).stat().st_mode & 0o111:
            self.complain(f"{program} cannot be executed")
        for option in (word for word in arguments if word.startswith("-") and word[1:2] != "D"):
            if not re.search(rf"(?<![\w-]){re.escape(option)}(?![\w-])", text):
                self.complain(f"{program} has no option {option}")

    def check_preset(self, program, arguments):
        presets = json.loads((self.root / "CMakePresets.json").read_text())
        kind = "testPresets" if program == "ctest" else (
            "buildPresets" if "--build" in arguments else "configurePresets")
        names = {preset["name"] for preset in presets[kind] if not preset.get("hidden")}
        if "--preset" not in arguments or arguments[arguments.index("--preset") + 1] not in names:
            self.complain(f"{program}: expected --preset and one of {sorted(names)}")
        targets = arguments[arguments.index("--target") + 1:] if "--target" in arguments else []
        for target in targets:
            layer = re.fullmatch(r"tactus_(\w+)_tests", target)
            if layer:
                self.check_file(f"tests/{layer.group(1)}/")
            elif target not in self.programs:
                self.complain(f"cmake: no target {target}")
        if program == "ctest" and "-R" in arguments:
            kind, _, name = arguments[arguments.index("-R") + 1].partition(".")
            if not re.search(rf"\b(tactus_)?{kind}\b.*\b{name}\b|\w*{kind}\w*_test\({name}\)",
                             (self.root / "tests/CMakeLists.txt").read_text()):
                self.complain(f"ctest: no test {kind}.{name}")

    def check_tactus(self, program, arguments):
        if program == "tactus" and arguments[:1] and arguments[0] in RUN:
            self.run([self.programs[program], *arguments])
            return
        self.check_options(program, arguments)
        for file in (word for word in arguments if word.endswith(".yaml")):
            if not file.startswith("/etc/") and not (self.scratch / file).is_file():
                self.complain(f"there is no {file} to start from")

    def check_options(self, program, arguments):
        command = [self.programs[program]]
        if program == "tactus" and arguments and not arguments[0].startswith("-"):
            command.append(arguments[0])
        knows = self.options(command)
        for option in (word.split("=")[0] for word in arguments if word.startswith("-")):
            if option not in knows:
                self.complain(f"{' '.join(command[1:]) or program} has no option {option}")

    def options(self, command):
        if command[1:] == ["bench"]:  # a program of its own, which not every build has
            text = (self.root / "src/bench/bench_main.cpp").read_text()
        else:
            done = subprocess.run([*command, "--help"], capture_output=True, text=True)
            if done.returncode != 0:
                self.complain(f"{command[-1]}: no such command")
            text = done.stdout
        return set(re.findall(r"(?<![\w-])--?[a-z][\w-]*", text))

    def run(self, command):
        done = subprocess.run(command, cwd=self.scratch, capture_output=True, text=True, timeout=300)
        if done.returncode != 0:
            self.complain(f"{' '.join(command[1:])} ends with {done.returncode}: {done.stderr.strip()}")


def prepare(root, scratch):
    """What commands find where they are tried."""
    shutil.copytree(root / "config", scratch / "config")
