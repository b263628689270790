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
    "include/tactus/control/a.h": ["<tactus/sim/arm.h>", '"tactus/scene/scene.h"', "<fmt/core.h>",
                                   "<thread>", "<pthread.h>", "<sys/mman.h>"],
    "src/sim/a.cpp": ['"tactus/canopen/drive.h"', '"tactus/scene/scene.h"', '"tactus/rt/thread.h"',
                      "<linux/can.h>", "<chrono>"],
    "src/analysis/a.cpp": ['"tactus/plant/plant.h"', '"tactus/io/bus.h"', "<fmt/core.h>", "<chrono>"],
    "src/canopen/a.cpp": ['"tactus/io/bus.h"', '"tactus/supervisor/mode.h"', '"tactus/sim/arm.h"',
                          "<linux/can.h>", "<chrono>"],
    "src/supervisor/a.cpp": ['"tactus/io/bus.h"', '"tactus/scene/scene.h"', '"tactus/sim/arm.h"',
                             "<unistd.h>", "<mutex>"],
    "src/commission/a.cpp": ['"tactus/io/bus.h"', '"tactus/plant/plant.h"', '"tactus/scene/scene.h"',
                             "<unistd.h>", "<chrono>", "<fmt/core.h>"],
    "src/plant/a.cpp": ['"tactus/analysis/contact_loop.h"', '"tactus/scene/scene.h"',
                        '"tactus/rt/thread.h"', '"tactus/io/bus.h"', "<linux/can.h>", "<chrono>"],
    "src/io/a.cpp": ['"tactus/plant/plant.h"', '"tactus/sim/arm.h"', '"tactus/rt/thread.h"',
                     "<yaml-cpp/yaml.h>"],
    "src/rt/a.cpp": ['"tactus/control/fault.h"', "<Eigen/Core>", "<sys/socket.h>", "<fmt/core.h>"],
    "src/scene/a.cpp": ['"tactus/record/replay.h"', '"tactus/io/bus.h"', '"tactus/supervisor/mode.h"',
                        "<sys/mman.h>", "<CLI/App.hpp>"],
    "src/record/a.cpp": ['"tactus/daemon/telemetry.h"', '"tactus/io/bus.h"', '"tactus/rt/thread.h"',
                         "<sys/socket.h>", "<yaml-cpp/yaml.h>"],
    "src/run/a.cpp": ['"tactus/daemon/telemetry.h"', '"tactus/cli/commands.h"', '"tactus/io/bus.h"',
                      "<CLI/App.hpp>", "<unistd.h>", "<sys/socket.h>"],
    "src/python/a.cpp": ['"tactus/daemon/control_client.h"', '"tactus/cli/commands.h"', "<CLI/App.hpp>",
                         "<sys/socket.h>", "<unistd.h>"],
    "src/doctor/a.cpp": ['"tactus/scene/json.h"', '"tactus/sim/arm.h"', "<sys/socket.h>", "<fcntl.h>",
                         "<nlohmann/json.hpp>"],
    "src/daemon/a.cpp": ["<sys/socket.h>", "<linux/can/raw.h>", "<netinet/in.h>", "<gpiod.h>",
                         "<boost/array.hpp>", '"tactus/cli/commands.h"', '"tactus/plant/plant.h"',
                         '"tactus/bench/study.h"', '"tactus/doctor/finding.h"'],
    "src/cli/a.cpp": ['"tactus/bench/study.h"', '"tactus/python/columns.h"', "<kdl/chain.hpp>", "<yaml-cpp/yaml.h>",
                      "<pybind11/pybind11.h>"],
    "src/panel/a.cpp": ["<httplib.h>", "<sys/socket.h>", '"tactus/cli/commands.h"', '"tactus/io/bus.h"',
                        '"tactus/plant/plant.h"'],
    "src/panel/panel_server.cpp": ["<sys/socket.h>", "<netinet/in.h>", "<httplib/httplib.h>"],
    "src/cli/panel_server.cpp": ["<httplib.h>", '"tactus/panel/panel_server.h"'],
    "src/daemon/src/panel/panel_server.cpp": ["<httplib.h>"],
    "src/bench/a.cpp": ['"tactus/rt/thread.h"', '"tactus/io/bus.h"', '"tactus/daemon/telemetry.h"',
                        "<sys/socket.h>"],
    "src/other/a.cpp": ["<vector>"],
}

ACCEPTED = {
    "src/math/a.cpp": ['"tactus/math/types.h"', "<Eigen/Core>", "<cmath>"],
    "src/control/a.cpp": ['"tactus/math/types.h"', "<array>", '"a.cpp"'],
    "src/sim/a.cpp": ['"tactus/control/robot.h"', "<random>"],
    "src/analysis/a.cpp": ['"tactus/sim/arm.h"', '"tactus/math/filter.h"', "<Eigen/Eigenvalues>"],
    "src/canopen/a.cpp": ['"tactus/control/robot.h"', '"tactus/canopen/drive.h"', "<span>"],
    "src/supervisor/a.cpp": ['"tactus/canopen/drive.h"', '"tactus/control/controller.h"'],
    "src/commission/a.cpp": ['"tactus/canopen/drive.h"', '"tactus/supervisor/brake.h"', "<optional>"],
    "src/plant/a.cpp": ['"tactus/canopen/can_frame.h"', '"tactus/sim/arm.h"'],
    "src/io/a.cpp": ['"tactus/canopen/can_frame.h"', "<linux/can.h>", "<gpiod.h>", "<chrono>"],
    "src/rt/a.cpp": ['"tactus/rt/thread.h"', "<sched.h>", "<sys/mman.h>", "<ctime>"],
    "src/scene/a.cpp": ['"tactus/plant/trouble.h"', '"tactus/analysis/margins.h"',
                        "<yaml-cpp/yaml.h>", "<pugixml.hpp>", "<nlohmann/json.hpp>",
                        "<fstream>"],
    "src/record/a.cpp": ['"tactus/scene/scene.h"', '"tactus/supervisor/mode.h"', "<fmt/format.h>",
                         "<fcntl.h>"],
    "src/run/a.cpp": ['"tactus/record/replay.h"', '"tactus/sim/simulated_robot.h"', "<fmt/format.h>", "<chrono>"],
    "src/python/a.cpp": ['"tactus/run/simulation.h"', '"tactus/record/ulog_reader.h"', "<pybind11/numpy.h>"],
    "src/doctor/a.cpp": ['"tactus/io/bus.h"', '"tactus/rt/thread.h"', "<fmt/format.h>",
                         "<filesystem>", "<fstream>"],
    "src/daemon/a.cpp": ['"tactus/io/bus.h"', '"tactus/record/run_log.h"', "<CLI/App.hpp>",
                         "<systemd/sd-daemon.h>", "<sys/mman.h>", "<fstream>"],
    "src/cli/a.cpp": ['"tactus/doctor/finding.h"', '"tactus/plant/plant.h"', "<CLI/App.hpp>"],
    "src/panel/a.cpp": ['"tactus/daemon/control_client.h"', '"tactus/record/growing_file.h"',
                        "<nlohmann/json.hpp>", "<CLI/CLI.hpp>", "<sys/random.h>"],
    "src/panel/panel_server.cpp": ["<httplib.h>"],
    "src/bench/a.cpp": ['"tactus/scene/scene.h"', '"tactus/run/simulation.h"', "<kdl/chain.hpp>",
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
