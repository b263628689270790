#!/usr/bin/env python3
"""Modes, faults and brakes: documents and SPIN's model are those of the tables that the code runs
from; SPIN finds nothing that must not be; the code takes the model's steps and no others; and models
that are wrong are refused.

usage: mode_model_test.py MODE_MODEL [--write]     --write writes what is generated anew
"""
import concurrent.futures
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
MODEL = ROOT / "tests/model/modes.pml"
PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())

# What is generated, in which file, and between what.
TABLE = r"(?<=\n)\|[^\n]*\n\|---(?:[^\n]*\n)(?:\|[^\n]*\n)+"
PARTS = [("modes", "docs/safety.md", r"\n## Modes\n", TABLE),
         ("remedies", "docs/safety.md", r"\n## Faults\n", TABLE),
         ("hazards", "docs/safety.md", r"\n## Hazards\n", TABLE),
         ("modes.8", "docs/man/tactusd.8", r"\n\.SH MODES\n", r"\.TP\n(?:.|\n)*?(?=\.SH )"),
         ("faults.8", "docs/man/tactusd.8", r"\nWhat is seen;", r"\.TP\n(?:.|\n)*?(?=\.SH )")]

CLAIMS = ["rests", "ends", "closes", "leaves"]

# Wrong models: what is changed, into what, and which claim refuses it; None: an assertion.
MUTANTS = {
    "a fault that is dropped": (":: fault == NO_FAULT -> fault = which",
                                ":: fault == NO_FAULT && mode != HOLDING -> fault = which", None),
    "a fault that takes another's place": (":: else -> skip\n    fi;\n    if\n    :: reaction <",
                                           ":: else -> fault = which\n    fi;\n    if\n    :: reaction <",
                                           None),
    "a reaction that grows milder": (":: reaction < asks_for ->", ":: reaction != asks_for ->", None),
    "a fault that is cleared at once": (" && may_clear -> acknowledge(); enter(BOOT)",
                                        " -> acknowledge(); enter(BOOT)", None),
    "a hold that goes on at once": (" && may_clear -> acknowledge(); enter(RUNNING)",
                                    " -> acknowledge(); enter(RUNNING)", None),
    "a fault that is cleared while it is there": ("    may_clear = false\n  :: else",
                                                  "    skip\n  :: else", None),
    "motion without enable": (":: !enable -> enter(HOLDING)\n    :: else -> if\n    :: reaction ==",
                              ":: false -> enter(HOLDING)\n    :: else -> if\n    :: reaction ==",
                              None),
    "a quick stop that is none": (":: reaction >= QUICK_STOP -> enter(FAULT)\n    :: else -> if\n"
                                  "    :: stop ->", ":: false -> enter(FAULT)\n    :: else -> if\n"
                                  "    :: stop ->", None),
    "a brake left open in a fault": ("!moving_on && cycles < DEADLINE_CYCLES", "!moving_on", None),
    "a brake left open at the end": (":: else -> is_open = false", ":: else -> skip", None),
    "a brake that an e-stop leaves open": (":: reaction != BRAKE && mode == FAULT",
                                           ":: mode == FAULT", None),
    "a stop that opens a brake": ("is_open = (is_open && rest_cycles == 0)",
                                  "is_open = (rest_cycles == 0)", None),
    "a brake that waits for good": ("is_open = (is_open && any_holds && !moving_on && cycles < "
                                    "DEADLINE_CYCLES)", "is_open = (is_open)", "closes"),
    "a retreat without an end": (":: cycles > RETREATING_CYCLES", ":: false", "rests"),
    "an end that waits for drives": (":: stop && (drives_off || cycles > STOPPING_CYCLES)",
                                     ":: stop && drives_off", "ends"),
    "a stop that waits for drives": (":: cycles > STOPPING_CYCLES ->", ":: false ->", "leaves"),
    "a stop request that is forgotten": (":: stop -> enter(OFF)\n    :: else -> if\n    :: fault",
                                         ":: false -> enter(OFF)\n    :: else -> if\n    :: fault",
                                         "ends"),
}


def generated(what):
    return subprocess.run([PROGRAM, what], check=True, capture_output=True, text=True).stdout


def committed(part):
    """The file's text, and the span of what is generated."""
    _, path, heading, shape = part
    text = (ROOT / path).read_text()
    start = re.search(heading, text)
    assert start, f"{path}: no {heading!r}"
    found = re.compile(shape).search(text, start.end() - 1)
    assert found, f"{path}: nothing generated below {heading!r}"
    return text, found.span()


def write():
    MODEL.write_text(generated("promela"))
    for part in PARTS:
        text, (start, end) = committed(part)
        (ROOT / part[1]).write_text(text[:start] + generated(part[0]) + text[end:])


def verifier(folder, text, *options):
    """SPIN's verifier of a model, compiled."""
    folder.mkdir()
    (folder / "model.pml").write_text(text)
    for command in (["spin", "-a", "model.pml"], ["cc", "-O0", "-w", *options, "-o", "pan", "pan.c"]):
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    return [folder / "pan", "-m100000", "-w18"]


def complaint(pan, claim):
    """None, or what SPIN finds against a claim; without one, against the assertions."""
    arguments = [] if claim is None else ["-a", "-A", "-N", claim]
    said = subprocess.run(pan + arguments, cwd=pan[0].parent, capture_output=True, text=True,
                          check=False).stdout
    assert "Search not completed" in said or "errors: 0" in said, said
    assert "max search depth too small" not in said, said
    return None if "errors: 0" in said else said


class ModeModelTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.text = MODEL.read_text()

    def test_what_is_committed_is_what_the_tables_say(self):
        self.assertEqual(self.text, generated("promela"), "written anew by --write")
        for part in PARTS:
            with self.subTest(part[0]):
                text, (start, end) = committed(part)
                self.assertEqual(text[start:end], generated(part[0]), "written anew by --write")

    def test_the_code_takes_the_models_steps_and_spin_finds_nothing(self):
        pan = verifier(self.folder / "whole", self.text, "-DNOCLAIM", "-DSAFETY", "-DPRINTF")
        said = subprocess.run(pan, cwd=pan[0].parent, capture_output=True, text=True,
                              check=True).stdout
        steps = "".join(re.findall(r"^\d+(?: +\d+){20}\n", said, re.M))
        self.assertIn("errors: 0", said)
        self.assertNotIn("max search depth too small", said)
        of_modes = said[said.index("unreached in proctype"):].split("unreached in claim")[0]
        self.assertRegex(of_modes, r'"-end-"\s+\(1 of \d+ states\)', "a row that never happens")

        def agree(lines):
            return subprocess.run([PROGRAM, "agree"], input=lines, capture_output=True, text=True,
                                  check=False)

        done = agree(steps)
        print(done.stdout, end="")
        self.assertEqual(done.returncode, 0, done.stdout)
        first = steps[:steps.index("\n")].split()
        wrong = " ".join(first[:-9] + ["8"] + first[-8:])  # to another mode
        self.assertIn("the code to", agree(wrong).stdout)
        self.assertIn("the model never", agree(steps[:steps.rindex("\n", 0, 100000) + 1]).stdout)

    def test_spin_finds_nothing_against_the_claims(self):
        pan = verifier(self.folder / "claims", self.text)
        for claim in CLAIMS:
            with self.subTest(claim):
                self.assertIn(f"ltl {claim} ", self.text)
                self.assertIsNone(complaint(pan, claim))
        self.assertEqual(len(CLAIMS), len(re.findall(r"^ltl ", self.text, re.M)))

    def test_spin_refuses_wrong_models(self):
        def judge(number, mutant):
            was, becomes, claim = MUTANTS[mutant]
            text = self.text.replace(was, becomes)
            assert text != self.text, "nothing to change"
            options = ["-DNOCLAIM", "-DSAFETY"] if claim is None else []
            return complaint(verifier(self.folder / f"mutant{number}", text, *options), claim)

        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            found = list(pool.map(judge, range(len(MUTANTS)), MUTANTS))
        for (mutant, (_, _, claim)), said in zip(MUTANTS.items(), found):
            with self.subTest(mutant):
                self.assertIsNotNone(said, "not refused")
                self.assertIn("assertion violated" if claim is None else "acceptance cycle", said)


if __name__ == "__main__":
    if "--write" in sys.argv:
        write()
    else:
        unittest.main()
