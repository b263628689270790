"""The include check must be able to fail."""

import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True

import include_check  # noqa: E402

REFUSED = {
    "src/math/a.cpp": ['"tactus/control/robot.h"', "<yaml-cpp/yaml.h>", "<chrono>", "<unistd.h>",
                       "<boost/array.hpp>", "MACRO", '"missing.h"', '"../sim/arm.h"', "<fstream>"],
    "include/tactus/control/a.h": ["<tactus/sim/arm.h>", '"tactus/daemon/scene.h"', "<fmt/core.h>",
                                   "<thread>", "<pthread.h>", "<sys/mman.h>"],
    "src/sim/a.cpp": ['"tactus/io/bus.h"', '"tactus/daemon/scene.h"', '"tactus/rt/thread.h"',
                      "<linux/can.h>", "<chrono>"],
    "src/analysis/a.cpp": ['"tactus/plant/plant.h"', '"tactus/io/bus.h"', "<fmt/core.h>", "<chrono>"],
    "src/plant/a.cpp": ['"tactus/analysis/contact_loop.h"', '"tactus/daemon/scene.h"', '"tactus/rt/thread.h"', "<linux/can.h>", "<chrono>"],
    "src/io/a.cpp": ['"tactus/plant/plant.h"', '"tactus/sim/arm.h"', '"tactus/rt/thread.h"', "<yaml-cpp/yaml.h>"],
    "src/rt/a.cpp": ['"tactus/math/types.h"', "<Eigen/Core>", "<sys/socket.h>", "<fmt/core.h>"],
    "src/doctor/a.cpp": ['"tactus/daemon/json.h"', '"tactus/sim/arm.h"', "<sys/socket.h>", "<fcntl.h>"],
    "src/daemon/a.cpp": ["<sys/socket.h>", "<linux/can/raw.h>", "<netinet/in.h>", "<gpiod.h>",
                         "<boost/array.hpp>"],
    "src/bench/a.cpp": ['"tactus/rt/thread.h"', '"tactus/io/bus.h"', "<sys/socket.h>"],
    "src/daemon/b.cpp": ['"tactus/bench/study.h"', "<kdl/chain.hpp>"],
    "src/other/a.cpp": ["<vector>"],
}

ACCEPTED = {
    "src/math/a.cpp": ['"tactus/math/types.h"', "<Eigen/Core>", "<cmath>"],
    "src/control/a.cpp": ['"tactus/math/types.h"', "<array>", '"a.cpp"'],
    "src/sim/a.cpp": ['"tactus/control/robot.h"', "<random>"],
    "src/analysis/a.cpp": ['"tactus/sim/arm.h"', '"tactus/math/filter.h"', "<Eigen/Eigenvalues>"],
    "src/plant/a.cpp": ['"tactus/io/can_frame.h"', '"tactus/sim/arm.h"'],
    "src/io/a.cpp": ['"tactus/control/robot.h"', "<linux/can.h>", "<gpiod.h>", "<chrono>"],
    "src/rt/a.cpp": ['"tactus/rt/thread.h"', "<sched.h>", "<sys/mman.h>", "<ctime>"],
    "src/doctor/a.cpp": ['"tactus/io/bus.h"', '"tactus/rt/thread.h"', "<fmt/format.h>",
                         "<filesystem>", "<fstream>"],
    "src/daemon/a.cpp": ['"tactus/io/bus.h"', '"tactus/doctor/finding.h"', '"tactus/sim/arm.h"', "<yaml-cpp/yaml.h>",
                         "<CLI/App.hpp>", "<systemd/sd-daemon.h>", "<sys/mman.h>", "<fstream>"],
    "src/bench/a.cpp": ['"tactus/daemon/scene.h"', '"tactus/math/types.h"', "<kdl/chain.hpp>",
                        "<valgrind/callgrind.h>", "<chrono>", "<sys/wait.h>"],
}


def findings(file, include):
    with tempfile.TemporaryDirectory() as scratch:
        path = pathlib.Path(scratch) / file
        path.parent.mkdir(parents=True)
        path.write_text(f"// first line\n#include {include}\n")
        return include_check.violations(pathlib.Path(scratch))[0]


class IncludeCheck(unittest.TestCase):
    def test_refuses_each_wrong_include(self):
        for file, includes in REFUSED.items():
            for include in includes:
                with self.subTest(file=file, include=include):
                    self.assertEqual(len(findings(file, include)), 1)

    def test_accepts_each_right_include(self):
        for file, includes in ACCEPTED.items():
            for include in includes:
                with self.subTest(file=file, include=include):
                    self.assertEqual(findings(file, include), [])

    def test_names_file_and_line(self):
        self.assertRegex(findings("src/math/a.cpp", "<chrono>")[0], r"src/math/a\.cpp:2: math ")

    def test_sees_includes_written_oddly(self):
        self.assertEqual(len(findings("src/math/a.cpp", "<chrono>\n #  include<thread>")), 2)


if __name__ == "__main__":
    unittest.main()
