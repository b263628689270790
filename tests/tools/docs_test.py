#!/usr/bin/env python3
"""Documents: every link leads somewhere, every command works, and docs/log.md has the fields of log
and summary. The check itself must be able to fail.

usage: docs_test.py TACTUS TACTUSD
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True

import docs_check  # noqa: E402

PROGRAMS = {"tactusd": str(pathlib.Path(sys.argv.pop(2)).resolve()),
            "tactus": str(pathlib.Path(sys.argv.pop(1)).resolve())}
ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCUMENTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]

# What a page may not say, and a word of the finding.
REFUSED = {
    "[a](docs/missing.md)": "no such file",
    "![a\nb](docs/missing.svg)": "no such file",
    "[a](README.md#no-such-heading)": "no such heading",
    "[a](#nowhere)": "no such heading",
    "see `src/control/missing.cpp`": "there is no",
    "`tests/missing`": "there is no",
    "run `tactus simulate SCENE --nonsense`": "no option --nonsense",
    "run `tactus nonsense`": "no such command",
    "    tools/demo": "indented block",
    "```\ntools/demo\n```": "language",
    "```cpp\nint i;\n```": "language",
    "```sh\ntools/missing\n```": "neither",
    "```sh\ntools/demo --nonsense\n```": "no option",
    "```sh\ncowsay moo\n```": "neither",
    "```sh\nfor i in 0 1; do cowsay $i; done\n```": "neither",
    "```sh\ntools/demo && tools/missing # a\n```": "neither",
    "```sh\ncmake --preset nonsense\n```": "expected --preset",
    "```sh\ncmake --build --preset dev --target nonsense\n```": "no target",
    "```sh\ncmake --build --preset dev --target tactus_nonsense_tests\n```": "there is no tests",
    "```sh\nctest --preset dev -R hil.nonsense\n```": "no test",
    "```sh\nbuild/dev/tests/tactus_nonsense_tests\n```": "there is no tests",
    "```sh\nbuild/release/tactus check missing.yaml\n```": "ends with 1",
    "```sh\nbuild/release/tactus simulate config/scenes/free_motion.yaml\n```": "ends with 2",
    "```sh\nbuild/release/tactus export missing.ulg -o a.csv\n```": "ends with 1",
    "```sh\nbuild/release/tactus keys nonsense\n```": "ends with 1",
    "```sh\nbuild/release/tactus doctor --nonsense\n```": "no option",
    "```sh\nbuild/release/tactus bench --nonsense\n```": "no option",
    "```sh\nbuild/release/tactus plant missing.yaml\n```": "to start from",
    "```sh\nbuild/release/tactusd --nonsense\n```": "no option",
    "```yaml\n# a.yaml\nextends: config/scenes/free_motion.yaml\nnonsense: 1\n```\n"
    "```sh\ntactus check a.yaml\n```": "nonsense",
}
ACCEPTED = [
    "# A heading: here\n[a](#a-heading-here) [b](README.md) [c](https://example.org/x#y)",
    "see `src/control/controller.cpp`, `tests/<layer>` and `config/scenes/*.yaml`",
    "run `tactus status --watch`, `tactus --version`, `tactusd SCENE`",
    "    k_j = a^T b",
    "```sh\nfor i in 0 1; do ip link add can$i type vcan; ip link set can$i up; done\n```",
    "```sh\ntools/test && tools/demo -o a   # b; c\nctest --preset release -V -R hil.latency\n```",
    "```yaml\n# a.yaml\nextends: config/scenes/free_motion.yaml\n```\n"
    "```sh\ntactus check a.yaml\ntactus plant a.yaml &\n```",
]


class Installed(unittest.TestCase):
    def test_page_of_the_tools_tells_where_all_of_the_source_is(self):
        text = (ROOT / "debian/tactus-tools.README.Debian").read_text()
        table, _, demo = text.partition("what tools/demo does is")
        for folder in sorted(path for path in (ROOT / "config").iterdir() if path.is_dir()):
            self.assertIn(f"config/{folder.name}", table)
        scenes = re.findall(r"config(/scenes/\S*\*\.yaml)", (ROOT / "tools/demo").read_text())
        self.assertGreater(len(scenes), 1)
        self.assertEqual(re.findall(r"/usr/share/tactus(/scenes/\S*\*\.yaml)", demo), scenes)


class Scratch(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.scratch = pathlib.Path(folder.name)
        docs_check.prepare(ROOT, self.scratch)

    def tactus(self, *arguments):
        return subprocess.run([PROGRAMS["tactus"], *arguments], cwd=self.scratch, check=True,
                              capture_output=True, text=True).stdout


class Documents(Scratch):
    def test_every_link_and_command_works(self):
        checker = docs_check.Checker(ROOT, PROGRAMS, self.scratch)
        for path in DOCUMENTS:
            checker.check(path)
        self.assertEqual(checker.found, [])
        self.assertGreater(checker.links, 15)
        self.assertGreater(checker.commands, 40)

    def test_readme_is_short(self):
        self.assertLessEqual(len(DOCUMENTS[0].read_text().splitlines()), 150)

    def test_keys_of_the_pages_are_there(self):
        """What looks like a key, by its unit or by a section before it, and is no field of log or request."""
        paths = {re.sub(r"\[\]", "", row["key"]) for row in json.loads(self.tactus("keys", "--json"))}
        sections = {path.split(".")[0] for path in paths}
        fields = set(re.findall(r"\w+", (ROOT / "docs/log.md").read_text()))
        unit = r"_(m|s|N|Nm|kg|hz|rad|bytes|counts|per_\w+)$"
        looked_at = 0
        for name in ("robot", "tuning", "simulation", "gate", "service"):
            for text in re.findall(r"`([^`\n]+)`", docs_check.prose((ROOT / f"docs/{name}.md").read_text())):
                key = re.sub(r"\[\w*\]", "", re.split(r"[:=]", text)[0]).strip().removeprefix("robot.")
                is_path = re.fullmatch(r"\w+(\.\w+)+", key) and key.split(".")[0] in sections
                if not is_path and not (re.fullmatch(r"[\w.]+", key) and re.search(unit, key)):
                    continue
                looked_at += 1
                self.assertTrue(key in fields or any(f".{path}".endswith(f".{key}") for path in paths),
                                f"docs/{name}.md: `{text}` is no key")
        self.assertGreater(looked_at, 40)

    def test_log_page_has_every_field(self):
        page = (ROOT / "docs/log.md").read_text()
        self.tactus("simulate", "config/scenes/scenario2_estimated.yaml", "-o", "runs",
                    "--set", "simulation.duration_s=0.1")
        run = self.scratch / "runs/scenario2_estimated"
        header = self.tactus("export", str(run / "run.ulg"), "-o", "-").splitlines()[0]
        fields = list(dict.fromkeys(re.sub(r"_\d+$", "", name) for name in header.split(",")))
        self.assertEqual(re.findall(r"^\| `(\w+)` \|[^|]*\| \w+ \|", page, re.M), fields)
        summary = page[page.index("## The summary"):page.index("On hardware")]
        members = [name for row in re.findall(r"^\| (`.*?) \|", summary, re.M)
                   for name in re.findall(r"`(\w+)`", row)]
        self.assertEqual(members, list(json.loads((run / "summary.json").read_text())))


class Check(Scratch):
    def findings(self, text):
        (self.scratch / "docs").mkdir(exist_ok=True)
        page = self.scratch / "page.md"
        page.write_text(text + "\n")
        (self.scratch / "README.md").write_text("# Title\n")
        for name in ("src", "tests", "tools", "CMakePresets.json"):
            if not (self.scratch / name).exists():
                (self.scratch / name).symlink_to(ROOT / name)
        checker = docs_check.Checker(self.scratch, PROGRAMS, self.scratch)
        checker.check(page)
        return checker.found

    def test_refuses_each_wrong_page(self):
        for text, word in REFUSED.items():
            with self.subTest(text=text):
                found = self.findings(text)
                self.assertEqual(len(found), 1, found)
                self.assertIn(word, found[0])

    def test_accepts_each_right_page(self):
        for text in ACCEPTED:
            with self.subTest(text=text):
                self.assertEqual(self.findings(text), [])

    def test_names_file_and_line(self):
        self.assertRegex(self.findings("a\n\n```sh\ntools/demo\ntools/missing\n```")[0], r"^page\.md:5: ")
        self.assertRegex(self.findings("a\n[b](c.md)")[0], r"^page\.md:2: ")


unittest.main()
