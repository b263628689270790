"""All changes of a source in one object: a function holds a copy of its body for each of its mutants, and the
environment says which one runs. So hundreds of mutants cost one compilation.

Constants of a file are chosen likewise, when the program starts. What is neither (initialisers of a constructor,
constexpr functions) has no copy: such a mutant is compiled alone."""

import dataclasses
import re
import subprocess

from clang.cindex import CursorKind as Kind

FUNCTIONS = {Kind.FUNCTION_DECL, Kind.CXX_METHOD, Kind.CONSTRUCTOR, Kind.DESTRUCTOR, Kind.CONVERSION_FUNCTION,
             Kind.FUNCTION_TEMPLATE}
WITHOUT_RESULT = {Kind.CONSTRUCTOR, Kind.DESTRUCTOR}
NUMBER = r"constexpr (double|float|int|unsigned|std::\w+_t) \w+ = [^{]*$"
MOST_FUNCTIONS = 1 << 14
# In each object: the linker keeps one. Before all other constructors, which may run what is mutated.
SWITCH = f"""#include <cstdio>
#include <cstdlib>
inline int tactus_mutant = 0;
inline bool tactus_reached[{MOST_FUNCTIONS}];
namespace {{
[[gnu::constructor(101)]] void tactusChoose() {{
  if (const char* number = std::getenv("TACTUS_MUTANT")) tactus_mutant = std::atoi(number);
}}
[[gnu::destructor(101)]] void tactusTell() {{
  const char* path = std::getenv("TACTUS_REACHED");
  std::FILE* file = path ? std::fopen(path, "w") : nullptr;
  if (!file) return;
  for (int i = 0; i < {MOST_FUNCTIONS}; ++i)
    if (tactus_reached[i]) std::fprintf(file, "%d\\n", i);
  std::fclose(file);
}}
}}
"""


@dataclasses.dataclass
class Region:
    """A function's body with its braces, or the definition of a file's constant: bytes of the source."""

    start: int
    end: int
    result: str = ""  # type as it is written; none of constructors
    is_constant: bool = False
    number: int = 0  # of a function, in all sources
    mutants: list = dataclasses.field(default_factory=list)


def result_of(cursor, source, body):
    """What stands before the function's name, but words that are no type; a trailing one where there is one."""
    trailing = re.search(r"->\s*([^{]+)$", source[cursor.location.offset:body.extent.start.offset].decode())
    if trailing:
        return trailing[1].strip()
    head = source[cursor.extent.start.offset:cursor.location.offset].decode().strip()
    head = re.sub(r"^template\s*<[^{;]*?>\s*(?=\S)", "", head, flags=re.S)
    head = re.sub(r"\[\[.*?\]\]|\b(static|inline|virtual|explicit|friend)\b", " ", head)
    return re.sub(r"(\w+(<[^<>]*>)?::)*$", "", head).strip()  # without the class of a method


def function_at(cursor, source):
    body = next((part for part in cursor.get_children() if part.kind == Kind.COMPOUND_STMT), None)
    head = source[cursor.extent.start.offset:cursor.location.offset].decode()
    if body is None or re.search(r"\b(constexpr|consteval)\b", head):
        return []
    result = "" if cursor.kind in WITHOUT_RESULT else result_of(cursor, source, body)
    return [Region(body.extent.start.offset, body.extent.end.offset, result)]


def regions(cursor, path, source):
    """Outermost functions and constants of the file, in their order."""
    found = []
    for child in cursor.get_children():
        if child.location.file is None or child.location.file.name != path:
            continue
        start, end = child.extent.start.offset, child.extent.end.offset
        if child.kind in FUNCTIONS:
            found += function_at(child, source)
        elif child.kind != Kind.VAR_DECL:
            found += regions(child, path, source)
        elif re.match(NUMBER, source[start:end].decode()):
            found.append(Region(start, end, is_constant=True))
    return sorted(found, key=lambda region: region.start)


def changed(source, start, end, mutant):
    return (source[start:mutant.start] + mutant.text.encode() + source[mutant.end:end]).decode()


def constant_text(source, region, numbers):
    """No constexpr any more; where that is needed, the compiler refuses it."""
    head, value = source[region.start:region.end].decode().split(" = ", 1)
    first = region.end - len(value.encode())
    choices = [f"tactus_mutant == {numbers[mutant]} ? ({changed(source, first, region.end, mutant)}) : "
               for mutant in region.mutants]
    return f"{head.replace('constexpr', 'const', 1)} = {''.join(choices)}({value})"


def function_text(source, region, numbers, file):
    words = [f"{{ tactus_reached[{region.number}] = true;\nswitch (tactus_mutant) {{\n"]
    for mutant in region.mutants:
        body = f'\n#line 1 "mutant_{numbers[mutant]}"\n{changed(source, region.start, region.end, mutant)}\n'
        call = f"return [&]() -> {region.result} {body} ();" if region.result else f"[&]() {body} (); return;"
        words.append(f"case {numbers[mutant]}: {call}\n")
    line = source[:region.start].count(b"\n") + 1
    words.append(f'default: break;\n}}\n#line {line} "{file}"\n')
    return "".join(words) + source[region.start:region.end].decode() + "\n}"


def text_of(source, file, inside, numbers):
    parts, at = [SWITCH, f'#line 1 "{file}"\n'], 0
    for region in inside:
        if region.is_constant and not region.mutants:
            continue
        text = constant_text(source, region, numbers) if region.is_constant else \
            function_text(source, region, numbers, file)
        parts += [source[at:region.start].decode(), text]
        at = region.end
    return "".join(parts) + source[at:].decode()


def compile_all(words, source, file, inside, numbers, output):
    """What does not compile is returned; that and what has to be compiled alone is taken out of the regions."""
    refused = set()
    while True:
        path = output.with_suffix(".cpp")
        path.write_text(text_of(source, file, inside, numbers))
        done = subprocess.run([*words, "-fmax-errors=0", "-c", str(path), "-o", str(output)],
                              capture_output=True, text=True)
        if not done.returncode:
            return refused
        named = set(map(int, re.findall(r"\bmutant_(\d+):", done.stderr)))
        new = {mutant for region in inside for mutant in region.mutants if numbers[mutant] in named}
        refused |= new
        if not new:  # a constant that has to be constexpr, else a body that cannot be a lambda's
            new = {mutant for region in inside if region.is_constant for mutant in region.mutants} or \
                {mutant for region in inside for mutant in region.mutants}
        if not new:
            raise SystemExit(f"{file} does not compile unchanged:\n{done.stderr[:2000]}")
        for region in inside:
            region.mutants = [mutant for mutant in region.mutants if mutant not in new]
