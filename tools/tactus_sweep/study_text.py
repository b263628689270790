"""YAML with the place of each value, so that an error names file, line and column."""

import math
import re

import yaml

LARGEST_FILE = 1 << 20
NUMBER = r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?"  # as scenes take it


class StudyError(Exception):
    """One line: file:line:column: key: what is wrong, what is expected."""


class Node:
    """A value of the file. `key` is dotted, "-" of the whole."""

    def __init__(self, path, text, node, key="-"):
        self.path, self.text, self.node, self.key = path, text, node, key

    def error(self, problem, expected, node=None):
        mark = (node or self.node).start_mark
        return error_at(self.path, mark.line, mark.column, self.key, problem, expected)

    def wrong(self, expected):
        return self.error(f"'{self.node.value}'" if isinstance(self.node, yaml.ScalarNode)
                          else "a list" if isinstance(self.node, yaml.SequenceNode) else "a section",
                          expected)

    def below(self, name, node):
        return Node(self.path, self.text, node, name if self.key == "-" else f"{self.key}.{name}")

    @property
    def is_section(self):
        return isinstance(self.node, yaml.MappingNode)

    @property
    def is_list(self):
        return isinstance(self.node, yaml.SequenceNode)

    def entries(self, expected="a section of keys"):
        """{name: Node}, in the order of the file."""
        if not self.is_section:
            raise self.wrong(expected)
        found = {}
        for name, value in self.node.value:
            if not isinstance(name, yaml.ScalarNode):
                raise self.error("a key that is no text", "key: value", name)
            entry = self.below(name.value, value)
            if name.value in found:
                raise entry.error("is there twice", "it once", name)
            entry.name_mark = name.start_mark
            found[name.value] = entry
        return found

    def section(self, known):
        """entries() that are among these alone."""
        entries = self.entries()
        for name, entry in entries.items():
            if name not in known:
                raise error_at(self.path, entry.name_mark.line, entry.name_mark.column, entry.key,
                               "unknown key", f"expected one of {', '.join(known)}")
        return entries

    def items(self, expected):
        if not self.is_list:
            raise self.wrong(expected)
        return [Node(self.path, self.text, node, f"{self.key}[{number}]")
                for number, node in enumerate(self.node.value)]

    def word(self, expected):
        if not isinstance(self.node, yaml.ScalarNode) or not self.node.value:
            raise self.wrong(expected)
        return self.node.value

    def plain(self, expected):
        """A word without quotes, in which scenes take neither numbers nor flags."""
        word = self.word(expected)
        if self.node.style:
            raise self.error(f"the text '{word}'", expected)
        return word

    def number(self, expected="a finite number"):
        text = self.plain(expected)
        if not re.fullmatch(NUMBER, text) or not math.isfinite(float(text)):
            raise self.wrong(expected)
        return float(text)

    def whole(self, lower, upper):
        expected = f"a whole number from {lower} to {upper}"
        text = self.plain(expected)
        if not re.fullmatch(r"[0-9]{1,18}", text) or not lower <= int(text) <= upper:
            raise self.wrong(expected)
        return int(text)

    def flag(self):
        if self.plain("true or false") not in ("true", "false"):
            raise self.wrong("true or false")
        return self.node.value == "true"

    def setting(self):
        """As --set takes it: text as it stands here, lists and sections in brackets."""
        if isinstance(self.node, yaml.ScalarNode) and not self.node.style:
            return self.node.value
        text = self.text[self.node.start_mark.index:self.node.end_mark.index]
        is_block = self.node.style in ("|", ">") if isinstance(self.node, yaml.ScalarNode) else (
            not self.node.flow_style)
        is_one_line = len(text.splitlines()) == 1  # without a comment, for it would hide the end
        if is_block or "#" in text and not is_one_line:
            raise self.wrong("a value, or a list or section in brackets without a comment")
        return text if is_one_line else " ".join(text.split())


def error_at(path, line, column, key, problem, expected):
    expected = expected if expected.startswith("expected") else f"expected {expected}"
    return StudyError(one_line(f"{path}:{line + 1}:{column + 1}: {key}: {problem}, {expected}"))


def one_line(text):
    """What a terminal may be given."""
    return "".join(sign if sign.isprintable() else f"\\x{ord(sign):02x}" for sign in text)


def read_node(path):
    """The whole file. Raises StudyError."""
    try:
        with open(path, "rb") as file:
            content = file.read(LARGEST_FILE + 1)
        if len(content) > LARGEST_FILE:
            raise error_at(path, 0, 0, "-", "more than 1 MiB", "a study")
        text = content.decode("utf-8")
    except OSError as error:
        raise error_at(path, 0, 0, "-", error.strerror, "a readable file") from error
    except UnicodeDecodeError as error:
        raise error_at(path, content.count(b"\n", 0, error.start), 0, "-", "not UTF-8", "text") from error
    try:
        for event in yaml.parse(text, yaml.SafeLoader):  # one of few bytes may stand for gigabytes
            if isinstance(event, yaml.AliasEvent):
                raise error_at(path, event.start_mark.line, event.start_mark.column, "-", "an alias",
                               "the value itself")
        node = yaml.compose(text, yaml.SafeLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        problem = error.problem or error.context or ""
        # YAML takes them for a list within the braces.
        is_bracket = problem.endswith("got '['")
        expected = "a key with [ ] in quotes, or on a line of its own" if is_bracket else "YAML"
        raise error_at(path, mark.line, mark.column, "-", problem, expected) from error
    except yaml.reader.ReaderError as error:
        before = text[:error.position]
        raise error_at(path, before.count("\n"), len(before) - before.rfind("\n") - 1, "-",
                       f"the character #x{error.character:02x}", "YAML") from error
    except (yaml.YAMLError, RecursionError) as error:
        raise error_at(path, 0, 0, "-", type(error).__name__, "YAML") from error
    if node is None:
        raise error_at(path, 0, 0, "-", "an empty file", "a study")
    return Node(path, text, node)
