"""The link check must be able to fail: on small archives, and with `tactus`, which holds all that
`tactusd` must not, in the place of `tactusd`.

usage: link_check_test.py COMPILER TACTUS ARCHIVE..."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True

import link_check  # noqa: E402

COMPILER, TACTUS, *ARCHIVES = sys.argv[1:]

HEADERS = """
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fcntl.h>
#include <fstream>
#include <map>
#include <mutex>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>
"""

# What a function of a pure layer may not do, and a word of the finding.
REFUSED = {
    "return std::chrono::steady_clock::now().time_since_epoch().count();": "steady_clock::now()",
    "return std::chrono::system_clock::now().time_since_epoch().count();": "system_clock::now()",
    "timespec now; return clock_gettime(CLOCK_MONOTONIC, &now);": "clock_gettime",
    "return time(nullptr);": "time",
    "return open(\"/dev/null\", O_RDONLY);": "open",
    "char c; return read(0, &c, 1);": "read",
    "return write(1, \"a\", 1);": "write",
    "return fopen(\"a\", \"r\") != nullptr;": "fopen",
    "return std::ofstream(\"a\").is_open();": "std::basic_filebuf",
    "return puts(\"a\");": "puts",
    "std::cout << 1.0; return 0;": "std::cout",
    "return getenv(\"HOME\") != nullptr;": "getenv",
    "return rand();": "rand",
    "return std::random_device()();": "std::random_device",
    "std::mutex m; m.lock(); return 0;": "pthread_mutex_lock",
    "std::thread([] {}).detach(); return 0;": "std::thread",
    "return usleep(1);": "usleep",
    "void elsewhere(); elsewhere(); return 0;": "elsewhere()",
}
ACCEPTED = [
    "return long(std::hypot(std::sin(x), std::exp(x)) + std::lround(x) + std::fmod(x, 2.0));",
    "return std::vector<double>(std::size_t(x), 1.0).size();",
    "return (std::to_string(x) + \"text\").append(std::string(9, 'a')).size();",
    "return std::map<int, double>{{1, x}, {2, x}}.size();",
    "if (x > 1.0) throw std::invalid_argument(\"too large\"); return 0;",
    "return std::mt19937_64(1)();",
    "return beside(x);",
]


def functions(bodies):
    return HEADERS + "long beside(double);\n" + "".join(
        f"long f{i}(double x) {{ (void)x; {body} }}\n" for i, body in enumerate(bodies))


class LinkCheck(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def compile(self, text, *options):
        source = self.folder / "source.cpp"
        source.write_text(text)
        subprocess.run([COMPILER, "-std=c++20", "-O1", "-w", source, *options], check=True)

    def archive(self, layer, text):
        self.compile(text, "-c", "-o", self.folder / "source.o")
        path = self.folder / f"libtactus_{layer}.a"
        path.unlink(missing_ok=True)
        subprocess.run(["ar", "rc", path, self.folder / "source.o"], check=True)
        return path

    def test_refuses_each_side_effect(self):
        found = link_check.impurities([self.archive("math", "#include <iostream>" + functions(REFUSED)),
                                       self.archive("io", "void elsewhere() {}")])
        names = [line.removeprefix("math must not use ") for line in found]
        for body, word in REFUSED.items():
            with self.subTest(body=body):
                self.assertTrue([name for name in names if name == word or "::" in word and word in name],
                                names)

    def test_accepts_memory_mathematics_and_exceptions(self):
        found = link_check.impurities([self.archive("plant", functions(ACCEPTED)),
                                       self.archive("math", "long beside(double) { return 1; }")])
        self.assertEqual(found, [])

    def test_finds_what_a_program_takes_from_a_layer_but_not_what_is_inline(self):
        plant = self.archive("plant", "void bus() {} int state = 1; inline void both() {} "
                                      "void user() { both(); }")
        self.compile("void bus(); extern int state; inline void both() {} "
                     "int main() { bus(); both(); return state; }", plant, "-o", self.folder / "d")
        found = link_check.strangers(self.folder / "d", [plant])
        self.assertEqual([line.split()[4] for line in found], ["bus()", "state", "user()"])

    def test_refuses_a_program_without_symbols(self):
        self.compile("int main() {}", "-s", "-o", self.folder / "d")
        self.assertIn("stripped", link_check.strangers(self.folder / "d", [])[0])

    def test_finds_the_http_library_outside_of_the_panel(self):
        text = "namespace httplib { void listen(); } void f() { httplib::listen(); }"
        found = link_check.listeners([self.archive("cli", text)])
        self.assertEqual(found, ["cli must not use httplib::listen(), only panel does"])
        self.assertEqual(link_check.listeners([self.archive("panel", text)]), [])

    def test_finds_a_network(self):
        self.assertIn("getaddrinfo", link_check.networks(pathlib.Path(TACTUS))[0])

    def test_finds_each_layer_in_the_program_that_has_it(self):
        archives = [pathlib.Path(path) for path in ARCHIVES]
        found = link_check.strangers(pathlib.Path(TACTUS), archives)
        for layer in ("cli", "commission", "plant"):
            self.assertTrue([line for line in found if line.endswith(f" of {layer}")], layer)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
