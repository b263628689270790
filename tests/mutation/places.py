"""Places of a C++ source where one change makes a mutant, by clang's syntax tree.

Comments, strings, macros, types and template arguments are no places; neither is what a header holds."""

import dataclasses
import pathlib

from clang.cindex import CursorKind as Kind
from clang.cindex import Index, TokenKind, TranslationUnit, TypeKind

OPERATORS = {
    "<": ("<=", ">="), "<=": ("<", ">"), ">": (">=", "<="), ">=": (">", "<"),
    "==": ("!=",), "!=": ("==",), "&&": ("||",), "||": ("&&",),
    "+": ("-",), "-": ("+",), "*": ("/",), "/": ("*",), "%": ("*",),
    "+=": ("-=",), "-=": ("+=",), "*=": ("/=",), "/=": ("*=",),
    "&": ("|",), "|": ("&",), "<<": (">>",), ">>": ("<<",), "&=": ("|=",), "|=": ("&=",),
}
# Of overloaded operators those which compile for matrices, times and iterators alike.
OVERLOADED = {"+", "-", "+=", "-=", "==", "!=", "<", "<=", ">", ">="}
NAMES = {"min": "max", "max": "min", "cwiseMin": "cwiseMax", "cwiseMax": "cwiseMin", "minCoeff": "maxCoeff",
         "maxCoeff": "minCoeff", "any_of": "all_of", "all_of": "any_of", "front": "back", "back": "front"}
FOR_SERIALIZATION = 0x10  # of clang-c/Index.h, which the bindings do not name
COMPARISONS = {"<", "<=", ">", ">=", "==", "!="}
FLOATING = {TypeKind.DOUBLE, TypeKind.FLOAT}
ACTIONS = {Kind.CALL_EXPR, Kind.BINARY_OPERATOR, Kind.COMPOUND_ASSIGNMENT_OPERATOR, Kind.UNARY_OPERATOR,
           Kind.BREAK_STMT, Kind.CONTINUE_STMT}
BODIES = {Kind.IF_STMT, Kind.FOR_STMT, Kind.WHILE_STMT, Kind.CXX_FOR_RANGE_STMT}


@dataclasses.dataclass(frozen=True, order=True)
class Mutant:
    file: str
    line: int
    column: int
    start: int  # bytes of the source
    end: int
    text: str  # what stands there instead
    what: str

    @property
    def name(self):
        return f"{self.file}:{self.line}:{self.column}: {self.what}"


class Finder:
    """Walks the tree of one source."""

    def __init__(self, path, flags, file):
        self.path, self.file, self.mutants = str(path), file, set()
        self.source = pathlib.Path(path).read_bytes()
        self.unit = Index.create().parse(self.path, args=flags)
        errors = [str(message) for message in self.unit.diagnostics if message.severity >= 3]
        if errors:
            raise SystemExit(f"{file}: clang cannot read it: {errors[0]}")

    def text(self, extent):
        return self.source[extent.start.offset:extent.end.offset].decode()

    def add(self, location, start, end, text, what):
        self.mutants.add(Mutant(self.file, location.line, location.column, start, end, text, what))

    def replace(self, extent, text, what):
        self.add(extent.start, extent.start.offset, extent.end.offset, text, what)

    def inside(self, cursor):
        file = cursor.location.file
        return file is not None and file.name == self.path and cursor.extent.end.offset > cursor.extent.start.offset

    def find(self):
        for cursor in self.unit.cursor.get_children():
            if self.inside(cursor):
                self.walk(cursor)
        return sorted(self.mutants)

    def walk(self, cursor):
        if cursor.kind == Kind.STATIC_ASSERT:
            return
        children = list(cursor.get_children())
        self.visit(cursor, children)
        for child in children:
            if self.inside(child):
                self.walk(child)

    def visit(self, cursor, children):
        kind = cursor.kind
        if kind in (Kind.BINARY_OPERATOR, Kind.COMPOUND_ASSIGNMENT_OPERATOR) and len(children) == 2:
            self.operator(children[0].extent.end.offset, children[1].extent.start.offset, cursor, OPERATORS)
        elif kind == Kind.CALL_EXPR and cursor.spelling.startswith("operator") and len(children) == 3:
            self.operator(children[0].extent.end.offset, children[2].extent.start.offset, cursor, OVERLOADED)
        elif kind == Kind.UNARY_OPERATOR:
            self.unary(cursor)
        elif kind in (Kind.INTEGER_LITERAL, Kind.FLOATING_LITERAL):
            self.literal(cursor)
        elif kind == Kind.CXX_BOOL_LITERAL_EXPR:
            value = self.text(cursor.extent)
            if value in ("true", "false"):
                other = "false" if value == "true" else "true"
                self.replace(cursor.extent, other, f"{value} becomes {other}")
        elif kind in (Kind.DECL_REF_EXPR, Kind.MEMBER_REF_EXPR) and cursor.spelling in NAMES:
            self.renamed(cursor)
        elif kind == Kind.RETURN_STMT and children:
            self.returned(children[0])
        elif kind == Kind.COMPOUND_STMT:
            for child in children:
                self.deleted(child)
        if kind in BODIES and children:
            self.body(kind, children)
        elif kind == Kind.CONDITIONAL_OPERATOR:
            self.negated(children[0])

    def operator(self, start, end, cursor, allowed):
        """The operator lies between both operands, whatever brackets and spaces are there."""
        for token in cursor.get_tokens():
            extent = token.extent
            if token.kind == TokenKind.PUNCTUATION and start <= extent.start.offset and extent.end.offset <= end \
                    and token.spelling in allowed:
                for other in OPERATORS[token.spelling]:
                    self.replace(extent, other, f"{token.spelling} becomes {other}")
                return

    def unary(self, cursor):
        first = self.source[cursor.extent.start.offset:cursor.extent.start.offset + 2].decode()
        if first[0] in "!-" and first != "--":
            start = cursor.extent.start
            self.add(start, start.offset, start.offset + 1, " ", f"{first[0]} is left out")

    def literal(self, cursor):
        value = self.text(cursor.extent)
        try:
            number = float(value) if cursor.kind == Kind.FLOATING_LITERAL else int(value, 0)
        except ValueError:
            return  # of a macro, or with a suffix
        others = ("1.0" if cursor.kind == Kind.FLOATING_LITERAL else "1",) if number == 0 else \
            (f"(2 * {value})", "0.0" if cursor.kind == Kind.FLOATING_LITERAL else "0")
        for other in others:
            self.replace(cursor.extent, other, f"{value} becomes {other}")

    def renamed(self, cursor):
        for token in cursor.get_tokens():
            if token.spelling == cursor.spelling:
                self.replace(token.extent, NAMES[token.spelling],
                             f"{token.spelling} becomes {NAMES[token.spelling]}")

    def returned(self, value):
        kind, text = value.type.get_canonical().kind, self.text(value.extent)
        if kind == TypeKind.BOOL and text not in ("true", "false"):
            self.replace(value.extent, f"!({text})", "returns the contrary")
        elif kind in FLOATING and text != "0.0":
            self.replace(value.extent, f"-({text})", "returns the negative")
        elif kind in (TypeKind.INT, TypeKind.LONG, TypeKind.LONGLONG):
            self.replace(value.extent, f"({text}) + 1", "returns one more")

    def deleted(self, statement):
        if statement.kind in ACTIONS or (statement.kind == Kind.UNEXPOSED_EXPR):
            self.replace(statement.extent, "", "statement is left out")
        elif statement.kind == Kind.RETURN_STMT and not list(statement.get_children()):
            self.replace(statement.extent, "", "return is left out")

    def negated(self, condition):
        tokens = [token.spelling for token in condition.get_tokens()]
        if condition.kind == Kind.BINARY_OPERATOR and COMPARISONS & set(tokens) and not {"&&", "||"} & set(tokens):
            return  # its operator's own mutants are that
        self.replace(condition.extent, f"!({self.text(condition.extent)})", "condition is negated")

    def body(self, kind, children):
        if kind in (Kind.IF_STMT, Kind.WHILE_STMT):
            condition = next((child for child in children if child.kind.is_expression()), None)
            if condition is not None and children[0].kind != Kind.DECL_STMT:
                self.negated(condition)
        for child in children[1:] if kind != Kind.FOR_STMT else children[-1:]:
            if child.kind != Kind.COMPOUND_STMT and (child.kind in ACTIONS or child.kind == Kind.UNEXPOSED_EXPR
                                                     or child.kind == Kind.RETURN_STMT):
                self.deleted(child)


def precompile(header, flags, output):
    """For clang's own reading, which knows no header that GCC has precompiled."""
    unit = Index.create().parse(str(header), args=["-x", "c++-header", *flags],
                                options=TranslationUnit.PARSE_INCOMPLETE | FOR_SERIALIZATION)
    unit.save(str(output))


def mutants(path, flags, file):
    return Finder(path, flags, file).find()
