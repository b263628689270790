#!/usr/bin/env python3
"""What bash and zsh offer behind `tactus`.

usage: completion_test.py TACTUS
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

TACTUS = pathlib.Path(sys.argv.pop(1)).resolve()
SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "tools/completion/tactus"
# As readline calls it: the program, the word that is completed, the one before.
ASK = """
source "$1"; shift
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))
_tactus "$1" "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"
printf '%s\\n' "${COMPREPLY[@]}"
"""


class Completion(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="a folder ")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        for name in ("runs/mine", "runs/a b"):
            (self.folder / name).mkdir(parents=True)
        for name in ("one.yaml", "two words.yaml", "other.txt", "table.csv", "runs/mine/run.ulg"):
            (self.folder / name).touch()

    def offered(self, *words):
        result = subprocess.run(["bash", "-uc", ASK, "bash", SCRIPT, TACTUS, *words],
                                cwd=self.folder, capture_output=True, text=True, timeout=60)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        return result.stdout.split("\n")[:-1]

    def test_commands(self):
        help_text = subprocess.run([TACTUS, "--help"], capture_output=True, text=True).stdout
        offered = self.offered("")
        self.assertIn("simulate", offered)
        self.assertEqual(len(offered), len(help_text.split("Subcommands:\n")[1].split("\n")) - 2 + 2)
        self.assertEqual(self.offered("sim"), ["simulate"])
        self.assertEqual(self.offered("--v"), ["--version"])

    def test_options(self):
        self.assertEqual(self.offered("simulate", "one.yaml", "--"),
                         ["--help", "--output", "--name", "--set", "--json"])
        self.assertEqual(self.offered("keys", "--man", "s"), ["scene"])
        self.assertEqual(self.offered("doctor", "--duration", ""), [""])

    def test_files(self):
        self.assertEqual(self.offered("check", ""), ["one.yaml", "runs", "two words.yaml"])
        self.assertEqual(self.offered("check", "tw"), ["two words.yaml"])
        self.assertEqual(self.offered("replay", "runs/mine/"), ["runs/mine/run.ulg"])
        self.assertEqual(self.offered("identify", ""), ["cover"])
        self.assertEqual(sorted(self.offered("calibrate", "")), ["fit", "record", "show"])
        self.assertEqual(self.offered("calibrate", "fit", "one.yaml", "t"), ["two words.yaml"])
        self.assertEqual(self.offered("calibrate", "record", "one.yaml", "-o", "o"), ["one.yaml"])
        self.assertEqual(self.offered("init", ""), ["runs"])
        self.assertEqual(self.offered("identify", "cover", "o"), ["one.yaml"])
        self.assertEqual(self.offered("identify", "cover", "runs/mine/"), ["runs/mine/run.ulg"])
        self.assertEqual(self.offered("simulate", "one.yaml", "-o", ""), ["runs"])
        self.assertEqual(self.offered("scope", "runs/mine/"), ["runs/mine/run.ulg"])
        self.assertEqual(self.offered("stream", "runs/mine/"), ["runs/mine/run.ulg"])
        self.assertEqual(self.offered("stream", "--rate", ""), [""])
        self.assertEqual(self.offered("follow", "o"), ["one.yaml"])
        self.assertEqual(self.offered("move", "--to", ""), [""])
        self.assertEqual(self.offered("scope", "--trigger", ""), [""])
        self.assertEqual(self.offered("panel", "--port", ""), [""])
        self.assertEqual(self.offered("panel", "--socket", "o"), ["one.yaml", "other.txt"])
        self.assertEqual(self.offered("export", "x.ulg", "-o", ""), ["runs", "table.csv"])

    def test_keys_behind_set(self):
        self.assertEqual(self.offered("simulate", "--set", "controller.damp"), ["controller.damping="])
        offered = self.offered("simulate", "--set", "")
        self.assertIn("simulation.obstacles[0].x_m=", offered)
        self.assertNotIn("controller=", offered)
        self.assertNotIn("simulation.obstacles=", offered)
        self.assertEqual(self.offered("simulate", "--set", "controller.damping", "=", "0"), [""])

    def test_keys_and_sections_to_explain(self):
        self.assertEqual(self.offered("keys", "redundancy.joint")[0], "redundancy.joint_limit_avoidance")


# As zsh calls it; what would be added to its list is printed.
ASK_ZSH = """
fpath=("$1"); shift
autoload -Uz _tactus
compadd() { while [[ $1 != -- ]]; do shift; done; shift; print -rl -- "$@" }
words=("$@"); CURRENT=$#
_tactus
"""


class ZshCompletion(Completion):
    def offered(self, *words):
        quoted = [word.replace(" ", "\\ ") for word in words]
        result = subprocess.run(["zsh", "-fuc", ASK_ZSH, "zsh", SCRIPT.parent, TACTUS, *quoted],
                                cwd=self.folder, capture_output=True, text=True, timeout=60)
        self.assertEqual(result.stderr, "")
        offered = result.stdout.split("\n")[:-1]
        return sorted(word.removesuffix("/") for word in offered) or [""]

    def test_options(self):
        self.assertEqual(sorted(self.offered("simulate", "one.yaml", "--")),
                         ["--help", "--json", "--name", "--output", "--set"])
        self.assertEqual(self.offered("keys", "--man", "s"), ["scene"])


unittest.main()
