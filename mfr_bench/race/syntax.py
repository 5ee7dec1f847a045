"""The syntax tree of the part of GLSL that shaders here use. Every node knows the encoded line that it stands on."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Type:
    """A type by its name, with the lengths of its arrays as expressions; an empty length is a run-time array."""

    name: str
    lengths: tuple[Expression | None, ...] = ()


@dataclass(frozen=True)
class Expression:
    line: int


@dataclass(frozen=True)
class Name(Expression):
    name: str


@dataclass(frozen=True)
class Number(Expression):
    text: str


@dataclass(frozen=True)
class Call(Expression):
    """A function, or the constructor of a type."""

    name: str
    arguments: tuple[Expression, ...]
    array: bool = False  # a constructor `T[](…)`


@dataclass(frozen=True)
class Index(Expression):
    base: Expression
    index: Expression


@dataclass(frozen=True)
class Member(Expression):
    base: Expression
    name: str


@dataclass(frozen=True)
class Length(Expression):
    base: Expression


@dataclass(frozen=True)
class Unary(Expression):
    operator: str
    operand: Expression
    postfix: bool = False


@dataclass(frozen=True)
class Binary(Expression):
    operator: str
    left: Expression
    right: Expression


@dataclass(frozen=True)
class Choice(Expression):
    condition: Expression
    then: Expression
    otherwise: Expression


@dataclass(frozen=True)
class Assignment(Expression):
    operator: str
    target: Expression
    value: Expression


@dataclass(frozen=True)
class Statement:
    line: int


@dataclass(frozen=True)
class Block(Statement):
    body: tuple[Statement, ...]


@dataclass(frozen=True)
class Variable:
    name: str
    type: Type
    value: Expression | None


@dataclass(frozen=True)
class Declaration(Statement):
    constant: bool
    variables: tuple[Variable, ...]


@dataclass(frozen=True)
class Evaluate(Statement):
    expression: Expression


@dataclass(frozen=True)
class If(Statement):
    condition: Expression
    then: Statement
    otherwise: Statement | None


@dataclass(frozen=True)
class Loop(Statement):
    """for, while, and with `after` do … while."""

    start: Statement | None
    condition: Expression | None
    step: Expression | None
    body: Statement
    after: bool = False


@dataclass(frozen=True)
class Jump(Statement):
    """break, continue, discard, or return with a value or without."""

    word: str
    value: Expression | None = None


@dataclass(frozen=True)
class Parameter:
    name: str
    type: Type
    direction: str  # in, out or inout


@dataclass(frozen=True)
class Function:
    line: int
    name: str
    result: Type
    parameters: tuple[Parameter, ...]
    body: Block


@dataclass(frozen=True)
class Struct:
    name: str
    members: tuple[tuple[str, Type], ...]


@dataclass(frozen=True)
class Storage:
    """A storage block or a uniform block: its members, and its qualifiers."""

    kind: str  # buffer or uniform
    binding: int | None
    qualifiers: frozenset[str]
    members: tuple[tuple[str, Type], ...]


@dataclass(frozen=True)
class Global:
    """A variable outside functions; `qualifiers` may hold in, out, uniform, shared, const."""

    line: int
    qualifiers: frozenset[str]
    layout: tuple[tuple[str, Expression | None], ...]
    variable: Variable


@dataclass(frozen=True)
class Shader:
    """One stage: what it declares, and the layout qualifiers of its inputs."""

    structs: tuple[Struct, ...]
    blocks: tuple[Storage, ...]
    globals: tuple[Global, ...]
    functions: tuple[Function, ...]
    inputs: tuple[tuple[str, Expression | None], ...]  # of `layout(…) in;`
