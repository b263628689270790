#!/usr/bin/env python3
"""The runner for User Mode Linux: what a script does in there comes out, and nothing else does. And two
daemons on buses of their own.

usage: uml_test.py TACTUSD
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
TACTUSD = pathlib.Path(sys.argv.pop(1)).resolve()


class Scripts(unittest.TestCase):
    def setUp(self):
        build = HERE.parents[1] / "build/hil"
        build.mkdir(parents=True, exist_ok=True)
        folder = tempfile.TemporaryDirectory(prefix="with space ", dir=build)
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.folder.chmod(0o755)
        self.out = self.folder / "out"

    def run_script(self, text, *arguments, timeout_s=60):
        script = self.folder / "a script"
        script.write_text(f"#!/bin/sh\n{text}")
        script.chmod(0o755)
        command = [HERE / "uml", script, "--out", self.out, "--timeout", str(timeout_s)]
        return subprocess.run(
            [*command, "--", *arguments], capture_output=True, text=True, timeout=400
        )


class Runner(Scripts):
    def test_script_finds_what_it_needs(self):
        victim = self.folder / "victim"
        victim.write_text("mine")
        result = self.run_script(
            'for i in 0 1 2 3; do ip link show "can$i" | grep -q UP || exit 1; done\n'
            'test "$PWD" = "$1" || exit 2\n'
            'test "$2" = "it\'s one" || exit 3\n'
            'mount -o remount,rw /; echo lost >"$3"\n'
            'echo kept >"$RESULTS/a result"\n'
            "candump -n 1 -T 5000 can2 & sleep 0.5; cansend can2 123#11; wait\n"
            "exit 42\n",
            HERE.parents[1],
            "it's one",
            victim,
        )
        self.assertEqual(result.returncode, 42, result)
        self.assertIn("123   [1]  11", result.stdout)
        self.assertEqual((self.out / "a result").read_text(), "kept\n")
        # As an ordinary user the files are as safe as that user's rights make them.
        if os.getuid() == 0:
            self.assertEqual(victim.read_text(), "mine")

    def test_endless_script_is_ended(self):
        result = self.run_script("echo begun; trap '' TERM; while :; do sleep 1; done", timeout_s=1)
        self.assertIn(result.returncode, (124, 137), result)
        self.assertIn("begun", result.stdout)

    def test_run_without_status_is_no_success(self):
        self.out.mkdir()
        (self.out / "status").write_text("0")  # of an older run
        result = self.run_script("echo o >/proc/sysrq-trigger; sleep 60")
        self.assertEqual(result.returncode, 125, result)
        self.assertIn("did not end", result.stderr)


# Without drives that answer, a daemon waits for them, for longer here than another one takes to start.
TWO_DAEMONS = """
for i in 0 1 2 3; do ip link add bus$i type vcan; ip link set bus$i up; done
mkdir config
cp -r "$1/config/robots" "$1/config/scenes" config
robots=$PWD/config/robots/crops9
sed -i 's/^can:/&\\n  boot_timeout_s: 60/' "$robots/robot.yaml"
sed 's/interface: can/interface: bus/' "$robots/robot.yaml" >"$robots/other.yaml"
for robot in robot other; do
  printf 'extends: config/scenes/free_motion.yaml\nrobot: %s\nreal_time: {required: false}\n' \
    "$robots/$robot.yaml" >$robot.yaml
  mkdir runtime_$robot
done
# run ROBOT: says what it comes to.
run() { RUNTIME_DIRECTORY=$PWD/runtime_$1 exec "$2" $1.yaml --name arm -o out 2>$1.txt; }
wait_for_boot() {
  for _ in $(seq 600); do grep -q 'tactusd: boot' $1.txt && return; sleep 0.1; done
  cat $1.txt; exit 9
}
run robot "$2" & first=$!
wait_for_boot robot
echo of the first >out/arm/run.1.ulg
(run other "$2"); echo "second: $?"
kill -0 $first || { cat robot.txt; exit 8; }
cat other.txt
cat out/arm/run.1.ulg
kill -9 $first
wait $first 2>/dev/null
run other "$2" & third=$!
wait_for_boot other
ls out/arm
kill -9 $third
"""


class TwoDaemons(Scripts):
    def test_do_not_write_into_one_folder(self):
        result = self.run_script(f"cd /tmp{TWO_DAEMONS}", HERE.parents[1], TACTUSD, timeout_s=200)
        self.assertEqual(result.returncode, 0, result)
        self.assertIn("second: 1\n", result.stdout)
        self.assertIn("out/arm:1:1: -o: another run writes there, expected another folder\n", result.stdout)
        self.assertIn("\nof the first\n", result.stdout)
        self.assertTrue(result.stdout.endswith("\nrun.ulg\n"), result.stdout)


if __name__ == "__main__":
    unittest.main()
