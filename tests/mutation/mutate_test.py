#!/usr/bin/python3
"""Mutation of a toy: places are found, a test kills, what survives is told, and a run goes on."""

import argparse
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import mutate  # noqa: E402
import places  # noqa: E402
import trials  # noqa: E402

SOURCE = """#include <algorithm>
#define LIMIT 7  // + is no place, 8 neither
// a + b; return true;
namespace toy {
double clip(double x, double least, double most) {
  const char* text = "1 + 2 < 3";
  if (x < least && text[0] != 'x') return least;
  return std::min(x, most);
}
int forever(int steps) {
  int passed = 0;
  while (passed < steps) ++passed;
  return passed;
}
double unused(double x) {
  return x - 0.0;
}
int limit() { return LIMIT; }
constexpr int kRows = 3;
struct Table {
  int rows[kRows], more;
  explicit Table(int first) : more(first + 1) {
    for (int& row : rows) row = first;
  }
  template <typename T>
  T twice(T x) const { return x + x; }
  auto sum() const -> int { return rows[0] + more; }
};
int ask(int first) {
  const Table table(first);
  return table.twice(table.sum());
}
}
"""
TEST = """namespace toy { double clip(double, double, double); int forever(int); int limit(); int ask(int); }
#include <cstdio>
int main() {
  using namespace toy;
  const bool is_right = clip(0.5, 1.0, 2.0) == 1.0 && clip(1.5, 1.0, 2.0) == 1.5 && clip(3.0, 1.0, 2.0) == 2.0 &&
                        forever(3) == 3 && limit() == 7 && ask(2) == 10;
  if (!is_right) std::printf("[  FAILED  ] Toy.Clips\\n");
  return is_right ? 0 : 1;
}
"""
FILE = "src/toy/clip.cpp"
COMPILER = ["c++", "-O0"]
trials.LEAST_CPU_S = 1.0  # so that what never ends takes no longer


class Toy(unittest.TestCase):
    def setUp(self):
        self.held = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.held.name)
        (self.root / "src" / "toy").mkdir(parents=True)
        (self.root / FILE).write_text(SOURCE)
        (self.root / "toy.cpp").write_text(TEST)
        (self.root / "blind.cpp").write_text(TEST.replace("is_right ? 0 : 1", "0"))
        for name in (FILE, "toy.cpp", "blind.cpp"):
            subprocess.run([*COMPILER, "-c", self.root / name, "-o", self.object(name)], check=True)
        self.runs = []

    def tearDown(self):
        self.held.cleanup()

    def object(self, name):
        return self.root / (pathlib.Path(name).stem + ".o")

    def target(self, stage):
        def link(program, replaced, output):
            self.runs.append(replaced)
            return subprocess.run([*COMPILER, str(self.object(f"{program}.cpp")),
                                   str(replaced.get(FILE, self.object(FILE))), "-o", str(output)],
                                  capture_output=True, text=True)

        return trials.Target(self.root, [FILE], {FILE: COMPILER}, {FILE: []}, link,
                             lambda file: [trials.Stage(stage, stage)])

    def run_all(self, sample=0, seed=1, listed=(), unnoticed=(), stage="toy"):
        options = argparse.Namespace(sample=sample, seed=seed, jobs=2, again=False)
        return mutate.run(self.target(stage), self.root / "out", options, list(listed), list(unnoticed))

    def state(self, what):
        for line in (self.root / "out" / "results.txt").read_text().splitlines():
            if line.endswith(what):
                return line.split("\t")[1:3]
        self.fail(f"no {what}")

    def test_places_are_code_alone(self):
        found = places.mutants(self.root / FILE, [], FILE)
        what = [(mutant.line, mutant.what) for mutant in found]
        for expected in ((7, "< becomes <="), (7, "< becomes >="), (7, "&& becomes ||"), (7, "!= becomes =="),
                         (7, "condition is negated"), (8, "min becomes max"), (12, "statement is left out"),
                         (16, "- becomes +"), (16, "returns the negative")):
            self.assertIn(expected, what)
        self.assertFalse([line for line, _ in what if line in (2, 3, 6)], "comments, macros, strings")
        self.assertFalse([what for line, what in what if line == 18 and "becomes" in what], "of a macro")
        for mutant in found:
            changed = SOURCE[:mutant.start] + mutant.text + SOURCE[mutant.end:]
            self.assertNotEqual(changed, SOURCE)

    def test_kills_and_tells_what_survives(self):
        stale, counts = self.run_all()
        self.assertEqual(stale, [])
        self.assertEqual(self.state(":8:15: min becomes max"), ["killed", "Toy.Clips"])
        self.assertEqual(self.state(":12:26: statement is left out")[0], "killed")
        self.assertIn("time", self.state(":12:26: statement is left out")[1])
        self.assertEqual(self.state(":16:12: - becomes +")[0], "survived")
        self.assertGreater(counts["killed"], 5)
        self.assertGreater(counts["survived"], 0)

    def test_changes_what_is_no_function_alone(self):
        self.run_all()
        for what in (":22:42: + becomes -", ":26:33: + becomes -", ":27:44: + becomes -", ":31:10: returns one more"):
            self.assertEqual(self.state(what), ["killed", "Toy.Clips"], what)
        self.assertEqual(self.state(":19:23: 3 becomes (2 * 3)")[0], "survived")
        made = (self.root / "out" / "trials").iterdir()
        copied = next(path for path in made if path.name == "src_toy_clip.cpp.cpp").read_text()
        self.assertIn("constexpr int kRows = 3;", copied, "which the array needs")

    def test_goes_on_and_knows_equivalents(self):
        self.run_all(sample=4)
        done = len(self.runs)
        self.run_all(sample=4)
        self.assertEqual(len(self.runs), done, "nothing is left to do")
        with (self.root / "out" / "results.txt").open("a") as file:
            file.write("half a li")  # ended here
        self.run_all(sample=8)
        self.assertGreater(len(self.runs), done)
        first = {mutant.name for mutant in mutate.chosen(places.mutants(self.root / FILE, [], FILE), 4, 1)}
        more = {mutant.name for mutant in mutate.chosen(places.mutants(self.root / FILE, [], FILE), 8, 1)}
        self.assertLess(first, more)
        reasons = [{"file": FILE, "code": "return x - 0.0;", "what": ["- becomes +"], "reason": "of 0"},
                   {"file": FILE, "code": "return x - 1.0;", "what": ["- becomes +"], "reason": "no such line"}]
        stale, counts = self.run_all(listed=reasons)
        self.assertEqual(stale, reasons[1:])
        self.assertEqual(counts["equivalent"], 1)

    def test_counts_what_survives_without_a_reason(self):
        _, counts = self.run_all()
        self.assertEqual(counts["without a reason"], counts["survived"])
        reasons = [{"file": FILE, "code": "return x - 0.0;", "what": ["- becomes +"], "reason": "nobody asks"},
                   {"file": FILE, "code": "return x - 1.0;", "what": ["- becomes +"], "reason": "no such line"}]
        stale, again = self.run_all(unnoticed=reasons)
        self.assertEqual(stale, reasons[1:])
        self.assertEqual(again["survived"], counts["survived"])
        self.assertEqual(again["without a reason"], counts["survived"] - 1)

    def test_a_reason_may_name_the_line_before(self):
        def survived(after):
            return {"file": FILE, "code": "return x - 0.0;", "after": after, "what": ["- becomes +"], "reason": "x"}

        stale, counts = self.run_all(listed=[survived("double unused(double x) {"), survived("int limit() {")])
        self.assertEqual(stale, [survived("int limit() {")])
        self.assertEqual(counts["equivalent"], 1)

    def test_what_other_judges_said_is_asked_again(self):
        for stage in ("blind", "toy", "blind"):
            _, counts = self.run_all(sample=6, stage=stage)
            self.assertEqual(counts["killed"] > 0, stage == "toy", stage)

    def test_the_interval_holds_the_share(self):
        low, high = mutate.interval_95(90, 100)
        self.assertAlmostEqual(low, 0.8256, 3)
        self.assertAlmostEqual(high, 0.9448, 3)
        self.assertEqual(mutate.interval_95(10, 10)[1], 1.0)


class Lists(unittest.TestCase):
    def test_every_reason_is_of_a_line_that_is_there(self):
        root = pathlib.Path(__file__).resolve().parents[2]
        for name in ("survivors", "unnoticed", "coverage"):
            for entry in mutate.read_list(pathlib.Path(__file__).parent / f"{name}.yaml"):
                lines = [line.strip() for line in (root / entry["file"]).read_text().splitlines()]
                self.assertIn(entry["code"], lines, f"{name}.yaml: {entry['file']}")
                if "after" in entry:
                    self.assertIn((entry["after"], entry["code"]), list(zip(lines, lines[1:])))


if __name__ == "__main__":
    unittest.main()
