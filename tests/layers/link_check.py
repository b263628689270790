#!/usr/bin/python3
"""Looks at what was built, as include_check.py does at what was written:

- A pure layer calls nothing but memory, mathematics, exceptions and other pure layers. So no system
  call, clock, file or thread can be reached from it, also not through a header that allows it.
- tactusd holds nothing that simulated runs, the commands, commissioning, the plant, the panel, Python's
  module or the benchmarks define, and finds no hosts: it has no network.
- No layer but the panel uses the HTTP library.

usage: link_check.py TACTUSD ARCHIVE...     ARCHIVE: libtactus_<layer>.a of all pure layers, of run, cli
                                            and plant, and of panel, python and bench where they
                                            are built"""

import pathlib
import re
import subprocess
import sys

sys.dont_write_bytecode = True

from include_check import PURE_LAYERS  # noqa: E402

NOT_IN_DAEMON = ("run", "cli", "commission", "plant", "panel", "python", "bench")
REQUIRED = PURE_LAYERS | {"run", "cli", "plant"}

# What a pure layer may take from outside, as nm -C prints it.
MATHEMATICS = (r"a?(sin|cos|tan)h?|atan2|sincos|exp(2|m1)?|log(2|10|1p|b)?|pow|sqrt|cbrt|hypot|fmod|"
               r"remainder|modf|ldexp|frexp|scalbln?|(l|ll)?r(ound|int)|nearbyint|floor|ceil|trunc|"
               r"fabs|fmax|fmin|fma|copysign|nextafter|c(abs|arg|exp|log|pow|sqrt)")
ALLOWED = re.compile("|".join((
    rf"({MATHEMATICS})[fl]?", r"__(mul|div)[sdx]c3",
    r"malloc|calloc|realloc|free|posix_memalign|aligned_alloc", r"operator (new|delete).*",
    r"mem(cpy|move|set|cmp|chr)|str(len|cmp|ncmp|chr)|vsnprintf|__mem(cpy|move|set)_chk",
    r"__cxa_.*|_Unwind_Resume|__gxx_personality_v0|__cxxabiv1::.*|std::terminate\(\)",
    r"(vtable|typeinfo|typeinfo name) for (__cxxabiv1::|std::).*",
    r"std::__throw_.*|std::(bad_\w+|\w*exception|\w+_error|invalid_argument|out_of_range)::.*",
    r"(std::)?__cxx11::basic_string<.*|std::__cxx11::(to_string|basic_string).*",
    r"std::operator\+ ?<char.*|bool std::operator== ?<char.*",
    r"std::_Rb_tree_\w+\(.*|std::__detail::(_Prime_rehash_policy|_List_node_base)::.*",
    r"std::_Hash_bytes\(.*|std::(to|from)_chars\(.*",
    r"_GLOBAL_OFFSET_TABLE_|__dso_handle|__stack_chk_fail|__tls_get_addr",
    r"abort|__assert_fail|std::__glibcxx_assert_fail\(.*",  # a failed assertion ends the program
)))


def symbols(path, *options):
    """(kind, name) of each symbol, demangled; see nm(1) for the kinds."""
    listing = subprocess.run(["nm", "-C", *options, path], check=True, capture_output=True, text=True)
    return [match.groups() for line in listing.stdout.splitlines()
            if (match := re.match(r"[0-9a-f]* +([A-Za-z]) (.+)", line))]


def layer_of(archive):
    return re.fullmatch(r"libtactus_(\w+)\.a", archive.name).group(1)


def defined(path):
    """Names that are defined here alone: neither inline nor local."""
    return {name for kind, name in symbols(path, "--defined-only") if kind in "TDBRGS"}


def impurities(archives):
    """A line for each name that a pure layer takes from where it must not."""
    pure = [path for path in archives if layer_of(path) in PURE_LAYERS]
    own = {name for path in pure for _, name in symbols(path, "--defined-only")}
    found = []
    for path in pure:
        wanted = {name for _, name in symbols(path, "-u")}
        found += [f"{layer_of(path)} must not use {name}" for name in sorted(wanted - own)
                  if not ALLOWED.fullmatch(name)]
    return found


def strangers(daemon, archives):
    """A line for each name in the daemon that a layer defines which does not belong there."""
    inside = {name for _, name in symbols(daemon, "--defined-only")}
    if "main" not in inside:
        return [f"{daemon} has no symbols: is it stripped?"]
    return [f"tactusd must not contain {name} of {layer_of(path)}"
            for path in archives if layer_of(path) in NOT_IN_DAEMON
            for name in sorted(defined(path) & inside)]


def networks(daemon):
    wanted = (name.partition("@")[0] for _, name in symbols(daemon, "-u"))
    return [f"tactusd must not use {name}, it has no network" for name in wanted
            if re.match("getaddrinfo|gethost|inet_", name)]


def listeners(archives):
    return [f"{layer_of(path)} must not use {name}, only panel does" for path in archives
            if layer_of(path) != "panel"
            for name in sorted({name for _, name in symbols(path) if "httplib::" in name})]


def main():
    daemon, *archives = map(pathlib.Path, sys.argv[1:])
    layers = [layer_of(path) for path in archives]
    found = [f"no archive of {layer}" for layer in sorted(REQUIRED - set(layers))]
    found += [f"{path} defines nothing" for path in archives if not defined(path)]
    found += impurities(archives) + strangers(daemon, archives)
    found += networks(daemon) + listeners(archives)
    print("\n".join(found) or f"{len(archives)} layers: the pure ones are pure, and tactusd holds "
                              f"nothing of {', '.join(x for x in NOT_IN_DAEMON if x in layers)}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
