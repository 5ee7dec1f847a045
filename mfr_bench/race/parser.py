"""Reads GLSL that is preprocessed, by recursive descent over the grammar of the GLSL 4.60 specification, §9.

Own code: the C grammars of pycparser and of tree-sitter-glsl do not have GLSL's array constructors and array types
before a name, and no grammar of GLSL is kept for a parser generator such as Lark.
"""

from __future__ import annotations

from .syntax import (
    Assignment,
    Binary,
    Block,
    Call,
    Choice,
    Declaration,
    Evaluate,
    Expression,
    Function,
    Global,
    If,
    Index,
    Jump,
    Length,
    Loop,
    Member,
    Name,
    Number,
    Parameter,
    Shader,
    Statement,
    Storage,
    Struct,
    Type,
    Unary,
    Variable,
)
from .tokens import Locate, Tokens

TYPES = frozenset({"void", "bool", "int", "uint", "float", "uint64_t", "int64_t", "atomic_uint",
                   *(f"{kind}vec{size}" for kind in ("", "u", "i", "b") for size in (2, 3, 4)),
                   *(f"{kind}{shape}" for kind in ("", "u", "i") for shape in (
                       "sampler2D", "sampler2DMS", "sampler2DArray", "image2D"))})
QUALIFIERS = frozenset({"in", "out", "inout", "const", "flat", "uniform", "buffer", "coherent", "readonly", "writeonly",
                        "volatile", "restrict", "precise", "highp", "mediump", "lowp", "shared", "invariant", "smooth",
                        "noperspective", "centroid", "sample"})
LEVELS = (("||",), ("^^",), ("&&",), ("|",), ("^",), ("&",), ("==", "!="), ("<", ">", "<=", ">="), ("<<", ">>"),
          ("+", "-"), ("*", "/", "%"))
ASSIGNMENTS = frozenset({"=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>="})


def parse(text: str, locate: Locate) -> Shader:
    """The syntax tree of one preprocessed stage. Raises ShaderError that names file, line and construct."""
    return _Parser(Tokens(text, locate)).shader()


class _Parser:
    def __init__(self, tokens: Tokens):
        self.tokens = tokens
        self.types = set(TYPES)
        self.structs: list[Struct] = []
        self.blocks: list[Storage] = []
        self.globals: list[Global] = []
        self.functions: list[Function] = []
        self.inputs: list[tuple[str, Expression | None]] = []

    def shader(self) -> Shader:
        while self.tokens:
            self._outer()
        return Shader(tuple(self.structs), tuple(self.blocks), tuple(self.globals), tuple(self.functions),
                      tuple(self.inputs))

    def _outer(self) -> None:
        tokens = self.tokens
        if tokens.accept(";"):
            return
        if tokens.text == "struct":
            self._struct()
            return
        if tokens.text == "precision":
            while not tokens.accept(";"):
                tokens.take()
            return
        layout, qualifiers, line = self._layout(), self._qualifiers(), tokens.line
        layout += self._layout() if tokens.text == "layout" else []
        qualifiers |= self._qualifiers()
        if tokens.accept(";"):
            self.inputs += layout
        elif tokens.kind == "word" and tokens.text not in self.types and tokens.ahead(1) == "{":
            self._block(layout, qualifiers)
        elif tokens.kind == "word" and tokens.text not in self.types and tokens.ahead(1) == ";":
            tokens.take()  # `invariant gl_Position;` says nothing of memory
        else:
            self._function_or_globals(line, layout, qualifiers)

    def _struct(self) -> None:
        self.tokens.take()
        name = self.tokens.word()
        members = self._members()
        self.tokens.expect(";")
        self.types.add(name)
        self.structs.append(Struct(name, members))

    def _layout(self) -> list[tuple[str, Expression | None]]:
        found: list[tuple[str, Expression | None]] = []
        if self.tokens.accept("layout"):
            self.tokens.expect("(")
            while not self.tokens.accept(")"):
                name = self.tokens.word()
                found.append((name, self._conditional() if self.tokens.accept("=") else None))
                self.tokens.accept(",")
        return found

    def _qualifiers(self) -> set[str]:
        found = set()
        while self.tokens.text in QUALIFIERS:
            found.add(self.tokens.take())
        return found

    def _members(self) -> tuple[tuple[str, Type], ...]:
        self.tokens.expect("{")
        members: list[tuple[str, Type]] = []
        while not self.tokens.accept("}"):
            self._layout()
            self._qualifiers()
            kind = self._type()
            members.append(self._declarator(kind))
            while self.tokens.accept(","):
                members.append(self._declarator(kind))
            self.tokens.expect(";")
        return tuple(members)

    def _block(self, layout: list[tuple[str, Expression | None]], qualifiers: set[str]) -> None:
        self.tokens.take()
        members = self._members()
        if self.tokens.kind == "word":
            raise self.tokens.unknown(f"does not know blocks with a name of their own, such as {self.tokens.text!r}")
        self.tokens.expect(";")
        binding = dict(layout).get("binding")
        kind = "buffer" if "buffer" in qualifiers else "uniform"
        self.blocks.append(Storage(kind, int(binding.text) if isinstance(binding, Number) else None,
                                   frozenset(qualifiers), members))

    def _type(self) -> Type:
        name = self.tokens.word()
        if name not in self.types:
            self.tokens.at -= 1
            raise self.tokens.unknown(f"does not know the type {name!r}")
        return Type(name, self._lengths())

    def _lengths(self) -> tuple[Expression | None, ...]:
        found: list[Expression | None] = []
        while self.tokens.accept("["):
            found.append(None if self.tokens.text == "]" else self._expression())
            self.tokens.expect("]")
        return tuple(found)

    def _declarator(self, kind: Type) -> tuple[str, Type]:
        name = self.tokens.word()
        return name, Type(kind.name, self._lengths() + kind.lengths)

    def _function_or_globals(self, line: int, layout: list, qualifiers: set[str]) -> None:
        kind = self._type()
        if self.tokens.ahead(1) == "(":
            self._function(line, kind)
            return
        while True:
            name, full = self._declarator(kind)
            value = self._assigned() if self.tokens.accept("=") else None
            self.globals.append(Global(line, frozenset(qualifiers), tuple(layout), Variable(name, full, value)))
            if not self.tokens.accept(","):
                break
        self.tokens.expect(";")

    def _function(self, line: int, result: Type) -> None:
        name = self.tokens.word()
        self.tokens.expect("(")
        parameters: list[Parameter] = []
        while not self.tokens.accept(")"):
            if self.tokens.text == "void" and self.tokens.ahead(1) == ")":
                self.tokens.take()
                continue
            qualifiers = self._qualifiers()
            direction = next((word for word in ("inout", "out") if word in qualifiers), "in")
            name_of, kind = self._declarator(self._type())
            parameters.append(Parameter(name_of, kind, direction))
            self.tokens.accept(",")
        if not self.tokens.accept(";"):
            self.functions.append(Function(line, name, result, tuple(parameters), self._braces()))

    def _braces(self) -> Block:
        line = self.tokens.line
        self.tokens.expect("{")
        body: list[Statement] = []
        while not self.tokens.accept("}"):
            if not self.tokens:
                raise self.tokens.unknown("misses a closing brace")
            body.append(self._statement())
        return Block(line, tuple(body))

    def _statement(self) -> Statement:
        tokens, line = self.tokens, self.tokens.line
        if tokens.text == "{":
            return self._braces()
        if tokens.accept(";"):
            return Block(line, ())
        if tokens.text in ("switch", "case", "default", "goto"):
            raise tokens.unknown(f"does not know {tokens.text!r}")
        found = {"if": self._if, "for": self._for, "while": self._while, "do": self._do}.get(tokens.text)
        if found:
            tokens.take()
            return found(line)
        if tokens.text in ("break", "continue", "discard", "return"):
            return self._jump(line)
        return self._simple()

    def _jump(self, line: int) -> Jump:
        word = self.tokens.take()
        value = None if self.tokens.text == ";" else self._expression()
        self.tokens.expect(";")
        return Jump(line, word, value)

    def _simple(self) -> Statement:
        """A declaration or an expression, with its semicolon."""
        line = self.tokens.line
        if self._declares():
            qualifiers = self._qualifiers()
            kind = self._type()
            variables = [self._variable(kind)]
            while self.tokens.accept(","):
                variables.append(self._variable(kind))
            self.tokens.expect(";")
            return Declaration(line, "const" in qualifiers, tuple(variables))
        if self.tokens.kind == "word" and self.tokens.found[self.tokens.at + 1][0] == "word":
            raise self.tokens.unknown(f"does not know the type {self.tokens.text!r}")
        expression = self._expression()
        self.tokens.expect(";")
        return Evaluate(line, expression)

    def _declares(self) -> bool:
        tokens = self.tokens
        if tokens.text in QUALIFIERS:
            return True
        if tokens.text not in self.types:
            return False
        at = 1
        while tokens.ahead(at) == "[":  # `float[3] x`, not `float[](…)`
            while tokens.ahead(at) != "]":
                at += 1
            at += 1
        return tokens.found[min(tokens.at + at, len(tokens.found) - 1)][0] == "word"

    def _variable(self, kind: Type) -> Variable:
        name, full = self._declarator(kind)
        return Variable(name, full, self._assigned() if self.tokens.accept("=") else None)

    def _if(self, line: int) -> If:
        condition = self._condition()
        then = self._statement()
        return If(line, condition, then, self._statement() if self.tokens.accept("else") else None)

    def _condition(self) -> Expression:
        self.tokens.expect("(")
        condition = self._expression()
        self.tokens.expect(")")
        return condition

    def _for(self, line: int) -> Loop:
        self.tokens.expect("(")
        start = None if self.tokens.accept(";") else self._simple()
        condition = None if self.tokens.text == ";" else self._expression()
        self.tokens.expect(";")
        step = None if self.tokens.text == ")" else self._expression()
        self.tokens.expect(")")
        return Loop(line, start, condition, step, self._statement())

    def _while(self, line: int) -> Loop:
        condition = self._condition()
        return Loop(line, None, condition, None, self._statement())

    def _do(self, line: int) -> Loop:
        body = self._statement()
        self.tokens.expect("while")
        condition = self._condition()
        self.tokens.expect(";")
        return Loop(line, None, condition, None, body, after=True)

    def _expression(self) -> Expression:
        left, line = self._assigned(), self.tokens.line
        while self.tokens.accept(","):
            left = Binary(line, ",", left, self._assigned())
        return left

    def _assigned(self) -> Expression:
        target, line = self._conditional(), self.tokens.line
        if self.tokens.text in ASSIGNMENTS:
            operator = self.tokens.take()
            return Assignment(line, operator, target, self._assigned())
        return target

    def _conditional(self) -> Expression:
        condition, line = self._binary(0), self.tokens.line
        if not self.tokens.accept("?"):
            return condition
        then = self._assigned()
        self.tokens.expect(":")
        return Choice(line, condition, then, self._assigned())

    def _binary(self, level: int) -> Expression:
        if level == len(LEVELS):
            return self._unary()
        left = self._binary(level + 1)
        while self.tokens.kind == "mark" and self.tokens.text in LEVELS[level]:
            line, operator = self.tokens.line, self.tokens.take()
            left = Binary(line, operator, left, self._binary(level + 1))
        return left

    def _unary(self) -> Expression:
        line = self.tokens.line
        if self.tokens.text in ("-", "+", "!", "~", "++", "--"):
            return Unary(line, self.tokens.take(), self._unary())
        return self._postfix(self._primary())

    def _postfix(self, base: Expression) -> Expression:
        tokens = self.tokens
        while True:
            line = tokens.line
            if tokens.accept("["):
                base = Index(line, base, self._expression())
                tokens.expect("]")
            elif tokens.accept("."):
                name = tokens.word()
                if name == "length" and tokens.accept("("):
                    tokens.expect(")")
                    base = Length(line, base)
                else:
                    base = Member(line, base, name)
            elif tokens.text in ("++", "--"):
                base = Unary(line, tokens.take(), base, postfix=True)
            else:
                return base

    def _primary(self) -> Expression:
        tokens, line = self.tokens, self.tokens.line
        if tokens.accept("("):
            inner = self._expression()
            tokens.expect(")")
            return inner
        if tokens.kind == "number":
            return Number(line, tokens.take())
        name = tokens.word()
        array = name in self.types and tokens.text == "["
        if array:
            self._lengths()
        if not tokens.accept("("):
            return Name(line, name)
        arguments: list[Expression] = []
        while not tokens.accept(")"):
            arguments.append(self._assigned())
            tokens.accept(",")
        return Call(line, name, tuple(arguments), array)
