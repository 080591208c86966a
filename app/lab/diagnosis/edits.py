"""Edits of a student's function that may make it right; the process that runs the function tries them.

An edit replaces nodes of the syntax tree. Edits with a cause (`causes.py`) come first. Then come typical slips in
writing a formula down: a part too much, a condition too much, another sign, operator, number, name or function.
"""

import ast
import contextlib
import copy
import itertools
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple, TypeAlias

from app.lab.diagnosis.explanation import says_repair
from app.lab.diagnosis.units import clashes

# Kinds of edits, the most likely first: a named cause, less text, a fixed condition, another text, more text.
CAUSE, SHORTER, CONDITION, OTHER, LONGER = range(5)

OPERATORS: dict[type[ast.operator], tuple[type[ast.operator], ...]] = {
    ast.Add: (ast.Sub, ast.Mult), ast.Sub: (ast.Add, ast.Div), ast.Mult: (ast.Div, ast.Add, ast.MatMult, ast.Pow),
    ast.Div: (ast.Mult, ast.Sub), ast.Pow: (ast.Mult,), ast.FloorDiv: (ast.Mult,), ast.Mod: (ast.Div,),
    ast.MatMult: (ast.Mult,),
}  # fmt: skip
COMPARISONS: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.LtE, ast.Gt), ast.Gt: (ast.GtE, ast.Lt), ast.LtE: (ast.Lt, ast.GtE), ast.GtE: (ast.Gt, ast.LtE),
    ast.Eq: (ast.NotEq, ast.LtE, ast.GtE), ast.NotEq: (ast.Eq,),
}  # fmt: skip
FUNCTIONS = (
    ("sin", "cos", "tan"), ("exp", "exp2"), ("log", "log10", "log2"), ("floor", "ceil", "round", "trunc"),
    ("max", "min"), ("maximum", "minimum"), ("sqrt", "cbrt", "square"), ("sum", "mean"), ("zeros", "ones"),
    ("dot", "cross"),
)  # fmt: skip
WRAPS = ("np.sqrt({})", "({})**2", "-({})", "1/({})", "2*({})", "({})/2", "({}) + 1", "({}) - 1")  # of any expression
FACTORS = ("np.pi", "(2*np.pi)", "1000", "3", "6", "9.81")
WHOLE_WRAPS = ("np.abs({})", "np.maximum({}, 0)", "np.exp({})", "np.log({})", "np.floor({})")  # of a whole side
SHORT = 5  # characters of an expression, below which the enclosing one is shown

Change: TypeAlias = Callable[[Any], ast.AST | None]  # of a node in a copy; None takes it out
Swap: TypeAlias = tuple[ast.AST, ast.AST | None]  # a node of a tree, and what replaces it; None takes a line out


class Candidate(NamedTuple):
    """An edit before it is compiled. cause: a sentence. condition: "always" or "never" where a condition is fixed."""

    swaps: tuple[Swap, ...]
    kind: int
    cause: str = ""
    condition: str = ""


class Replacement(NamedTuple):
    """One replacement in words: texts and line. after is "" if the text is taken out."""

    before: str
    after: str
    line: int


class EditWords(NamedTuple):
    """An edit in words. rank: sort key, likelier edits first."""

    rank: tuple[int, int, int]
    cause: str
    condition: str
    replacements: tuple[Replacement, ...]

    @property
    def is_clear(self) -> bool:
        """True if a sentence can name the change: each text is one line, or the cause says the repair."""
        return says_repair(self.cause) or not any(
            "\n" in text for one in self.replacements for text in (one.before, one.after)
        )


class Tree:
    """The function of a student and those of the file that it calls, with the place of every node."""

    def __init__(self, source: bytes, name: str, known: Mapping[str, Any], course: Sequence[str]) -> None:
        """source: of the file. known: names of its module. course: functions of the course, which stay as they are.

        Raises LookupError if the file has no such function at its top level.
        """
        definitions = {node.name: node for node in ast.parse(source).body if isinstance(node, ast.FunctionDef)}
        used = [name]
        for user in used:
            loads = (node.id for node in ast.walk(definitions[user]) if isinstance(node, ast.Name))
            used += [other for other in loads if other in definitions and other not in (*used, *course)]
        body = [node for node in definitions.values() if node.name in used]
        for node in body:
            node.decorator_list = []
        self.name, self.known = name, known
        self.module = ast.Module(body, [])  # type: ignore[arg-type]
        self.definition = definitions[name]
        self.arguments = [argument.arg for argument in self.definition.args.args]
        self.nodes = [node for node in ast.walk(self.module) if node is not self.module and node not in body]
        self.places = {
            child: (parent, field, i)
            for parent in ast.walk(self.module)
            for field, value in ast.iter_fields(parent)
            for i, child in enumerate(value if isinstance(value, list) else [value])
            if isinstance(child, ast.AST)
        }
        stored = (node.id for node in self.nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store))
        self.names = list(dict.fromkeys((*self.arguments, *stored)))
        self.tests = {part for node in self.of(ast.If, ast.IfExp, ast.While) for part in ast.walk(node.test)}
        self.texts = Counter(
            (getattr(node, "lineno", 0), source_of(node)) for node in self.nodes if isinstance(node, ast.expr)
        )

    def parent(self, node: ast.AST) -> ast.AST:
        """The node that holds another one."""
        return self.places[node][0]

    def is_test(self, candidate: Candidate) -> bool:
        """True if an edit changes a condition."""
        return any(node in self.tests for node, _ in candidate.swaps)

    def statement(self, node: ast.AST) -> ast.AST:
        """The statement of a node."""
        while not isinstance(node, ast.stmt):
            node = self.parent(node)
        return node

    def of(self, *kinds: type[ast.AST]) -> list[Any]:
        """The nodes of these kinds."""
        return [node for node in self.nodes if isinstance(node, kinds)]

    def put(self, node: ast.AST, new: ast.AST | None) -> None:
        """Put another node into the place of one; None takes a line out."""
        parent, field, i = self.places[node]
        value = getattr(parent, field)
        if isinstance(value, list):
            value[i] = ast.Pass() if new is None else new
        else:
            setattr(parent, field, new)

    @contextlib.contextmanager
    def changed(self, swaps: Sequence[Swap]) -> Iterator[None]:
        """The tree with these swaps in a `with` block."""
        for node, new in swaps:
            self.put(node, new)
            if new is not None:
                place(new, node)
        try:
            yield
        finally:
            for node, _ in swaps:
                self.put(node, node)

    def function(self, candidate: Candidate) -> Callable[..., Any] | None:
        """A candidate as a function, with the names that its module knows; None if it is no Python."""
        inside = dict(self.known)
        try:
            with self.changed(candidate.swaps), warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of Python's parser
                exec(compile(self.module, "<edit>", "exec"), inside)
        except (SyntaxError, ValueError, TypeError):
            return None
        return inside[self.name]

    def clashes(self, candidate: Candidate, units: Mapping[str, str]) -> int:
        """Number of places of an edited function that join quantities of different units. units: of its arguments."""
        with self.changed(candidate.swaps):
            return clashes(self.definition, units)

    def words(self, candidate: Candidate) -> EditWords:
        """A candidate in words."""
        owners = [self.shown_node(node) for node, _ in candidate.swaps]
        before = [source_of(owner) for owner in owners]
        with self.changed(candidate.swaps):
            pairs = zip(owners, candidate.swaps, strict=True)
            after = [source_of(new) if owner is node else source_of(owner) for owner, (node, new) in pairs]
        inner = {child for owner in owners for child in ast.walk(owner) if child is not owner}
        replacements = tuple(dict.fromkeys(
            Replacement(text, new, getattr(owner, "lineno", 0))
            for owner, text, new in zip(owners, before, after, strict=True) if owner not in inner
        ))  # fmt: skip
        length = sum(abs(len(one.after) - len(one.before)) for one in replacements)
        return EditWords(
            (candidate.kind, len(replacements), length), candidate.cause, candidate.condition, replacements
        )

    def shown_node(self, node: ast.AST) -> ast.AST:
        """The expression or statement that shows a replacement: long enough, and the only such one in its line."""
        part = node
        while not isinstance(part, ast.stmt):
            outer = self.outer(part)
            is_clear = isinstance(part, ast.expr) and not self.is_double(part)
            if is_clear and (isinstance(outer, ast.stmt) or not (len(source_of(part)) < SHORT or is_sliced(part))):
                break
            part = outer
        return part

    def outer(self, node: ast.AST) -> ast.AST:
        """The expression or statement around a node, past keywords and loops inside of brackets."""
        parent = self.parent(node)
        while not isinstance(parent, ast.expr | ast.stmt):
            parent = self.parent(parent)
        return parent

    def is_double(self, node: ast.AST) -> bool:
        """True if the line of an expression holds its text twice."""
        return self.texts[getattr(node, "lineno", 0), source_of(node)] > 1


def place(new: ast.AST, old: ast.AST) -> None:
    """Give new nodes the line of the one that they replace."""
    for node in ast.walk(new):
        if not hasattr(node, "lineno"):
            ast.copy_location(node, old)


def slips(tree: Tree, names: Sequence[str], conditions: Sequence[str]) -> Iterator[Candidate]:
    """Edits of single nodes, the likelier ones, and of the order of lines.

    names: the arguments as the reference has them. conditions: of the reference, in these.
    """
    for node in tree.nodes:
        parent, is_test = tree.parent(node), node in tree.tests
        if isinstance(node, ast.If | ast.IfExp):
            for holds in (True, False):
                fixed = ast.Constant(holds)
                yield Candidate(((node.test, fixed),), CONDITION, "", "always" if holds else "never")
        if not isinstance(parent, ast.Expr):
            yield from (candidate(node, change, OTHER if is_test else SHORTER) for change in shorter(node))
        yield from (candidate(node, change, OTHER) for change in changes_of(node, parent, tree.names))
    yield from other_orders(tree)
    own_names = dict(zip(names, tree.arguments, strict=False))
    for node in tree.of(ast.If, ast.IfExp):
        yield from (
            Candidate(((node.test, renamed(text, own_names)),), OTHER, "The condition is another one.")
            for text in conditions
        )


def other_orders(tree: Tree) -> Iterator[Candidate]:
    """Two lines in the other order."""
    for block in (getattr(node, "body", None) for node in [tree.definition, *tree.nodes]):
        for one, other in itertools.pairwise(block if isinstance(block, list) else []):
            if not (isinstance(other, ast.Return) or hasattr(one, "body") or hasattr(other, "body")):
                cause = f"With line {other.lineno} before line {one.lineno} it is right."
                yield Candidate(((one, other), (other, one)), OTHER, cause)


def candidate(node: ast.AST, change: Change, kind: int, cause: str = "") -> Candidate:
    """A candidate with one change; it leaves the node as it is if the change is no Python."""
    try:
        return Candidate(((node, change(copy.deepcopy(node))),), kind, cause)
    except SyntaxError:  # of a formula around something that is no value
        return Candidate(((node, node),), kind, cause)


def shorter(node: ast.AST) -> Iterator[Change]:
    """Changes that take something out of a node, or take it out."""
    if isinstance(node, ast.BinOp):
        yield lambda node: node.left
        yield lambda node: node.right
    elif isinstance(node, ast.Call) and node.args and not is_range(node):
        yield lambda node: node.args[0]
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
        yield lambda node: node.func.value
    elif isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Load):
        yield lambda node: node.value
    elif isinstance(node, ast.BoolOp):
        yield lambda node: node.values[0]
        yield lambda node: node.values[-1]
    elif isinstance(node, ast.AugAssign | ast.Expr) or (
        isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Subscript)
    ):
        yield lambda _: None


def changes_of(node: ast.AST, parent: ast.AST, names: Sequence[str]) -> Iterator[Change]:
    """The nodes that may replace one, as functions of it in a copy. names: of values."""
    is_index = isinstance(parent, ast.Subscript) and node is parent.slice
    if isinstance(node, ast.BinOp):
        yield from (changed("op", other()) for other in OPERATORS.get(type(node.op), ()))
        if isinstance(node.op, ast.Pow) and isinstance(node.left, ast.Constant):
            yield lambda node: call_of("np.exp", node.right)
        if isinstance(node.op, ast.Mult):
            yield lambda node: expression(f"(({ast.unparse(node.left)}) + ({ast.unparse(node.right)})) / 2")
    elif isinstance(node, ast.Compare) and len(node.ops) == 1:
        yield from (changed("ops", [other()]) for other in COMPARISONS.get(type(node.ops[0]), ()))
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield lambda node: node.operand
        if is_index:
            yield lambda _: ast.Constant(0)
    elif is_number(node):
        yield from map(replaced_by, values_near(node, parent))
    elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id in names:
        yield from (changed("id", other) for other in names if other != node.id)
    elif isinstance(node, ast.Call) and node.args:
        name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        key = "attr" if isinstance(node.func, ast.Attribute) else "id"
        for alike in FUNCTIONS:
            if name in alike:
                yield from (in_function(key, other) for other in alike if other != name)
    elif isinstance(node, ast.AugAssign):
        yield from (changed("op", other()) for other in OPERATORS.get(type(node.op), ()))
        yield lambda node: ast.Assign([node.target], node.value)
    elif isinstance(node, ast.BoolOp):
        yield changed("op", ast.Or() if isinstance(node.op, ast.And) else ast.And())
    if is_index and isinstance(node, ast.BinOp):
        yield from (replaced(name) for name in names)


def values_near(node: Any, parent: ast.AST) -> Iterator[int | float]:
    """Numbers that may stand in place of one."""
    value = node.value
    is_index = isinstance(parent, ast.Subscript | ast.Slice) or is_range(parent)
    is_power = isinstance(parent, ast.BinOp) and isinstance(parent.op, ast.Pow)
    is_negated = isinstance(parent, ast.UnaryOp)
    for other in dict.fromkeys((2 * value, value / 2, value + 1, value - 1, -value)):
        is_idle = (other == 1 and is_power) or (other == 0 and is_negated)
        if other != value and not is_idle and (other >= 0 or not (is_index or is_negated)):
            yield int(other) if float(other).is_integer() else other


def is_number(node: ast.AST) -> bool:
    """True for a number in the text."""
    return isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool)


def is_sliced(node: ast.AST) -> bool:
    """True for an index with a colon, which is no expression without its array."""
    return isinstance(node, ast.Slice) or any(isinstance(part, ast.Slice) for part in getattr(node, "elts", ()))


def is_range(node: ast.AST) -> bool:
    """True for a call of range."""
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "range"


def more_slips(tree: Tree) -> Iterator[Candidate]:
    """Further edits: another name throughout a statement, something around an expression, other indices."""
    for statement in tree.of(ast.Assign, ast.AugAssign, ast.Return, ast.Expr):
        loads = [n for n in ast.walk(statement) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load)]
        for name in {node.id for node in loads if node.id in tree.names}:
            own = [node for node in loads if node.id == name]
            for other in tree.names if len(own) > 1 else ():
                if other != name:
                    yield Candidate(tuple((node, ast.Name(other, ast.Load())) for node in own), OTHER)
    for node in tree.nodes:
        yield from (candidate(node, change, LONGER) for change in more_changes(node, tree.parent(node), tree.names))


def more_changes(node: ast.AST, parent: ast.AST, names: Sequence[str]) -> Iterator[Change]:
    """The changes of `more_slips` of one node."""
    is_value = isinstance(node, ast.expr) and isinstance(getattr(node, "ctx", ast.Load()), ast.Load)
    is_value = is_value and not isinstance(
        node, ast.Tuple | ast.Slice | ast.Constant | ast.Lambda | ast.Starred | ast.List | ast.ListComp
    )
    is_side = isinstance(parent, ast.Assign | ast.AugAssign | ast.Return) and node is parent.value
    is_part = isinstance(parent, ast.BinOp) and isinstance(parent.op, ast.Add | ast.Sub)
    is_called = isinstance(parent, ast.Attribute) or (isinstance(parent, ast.Call) and node is parent.func)
    if is_value and not is_called:
        yield from (wrapped(wrap) for wrap in WRAPS)
        if is_side or is_part or isinstance(parent, ast.Call | ast.Tuple):
            factors = (*names, *FACTORS)
            yield from (wrapped(f"({{}})*{factor}") for factor in factors)
            yield from (wrapped(f"({{}})/{factor}") for factor in factors)
        if is_side or isinstance(parent, ast.Tuple):
            yield from (wrapped(wrap) for wrap in WHOLE_WRAPS)
            for name in names:
                yield wrapped(f"({{}}) + {name}")
                yield wrapped(f"({{}}) - {name}")
    if is_number(node):
        yield from (replaced_by(value) for value in (0, 0.5, 3, 4) if value != getattr(node, "value", None))
        if isinstance(parent, ast.Subscript | ast.Slice):
            yield from (replaced(name) for name in names)
    elif isinstance(node, ast.Tuple | ast.Call):
        field = "elts" if isinstance(node, ast.Tuple) else "args"
        for i in range(len(getattr(node, field)) - 1):
            yield exchanged(field, i)
        if isinstance(node, ast.Call) and len(node.args) > 1:
            yield lambda node: ast.Call(node.func, node.args[1:], node.keywords)
    elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Subscript):
        yield lambda node: ast.AugAssign(node.targets[0], ast.Add(), node.value)
        yield lambda node: ast.AugAssign(node.targets[0], ast.Sub(), node.value)


def wrapped(text: str) -> Change:
    """An expression put into the {} of a formula."""
    return lambda node: expression(text.format(ast.unparse(node)))


def expression(text: str) -> ast.expr:
    """An expression from its text. Raises SyntaxError."""
    return ast.parse(text, mode="eval").body


def replaced(name: str) -> Change:
    """A name instead of a node."""
    return lambda _: ast.Name(name, ast.Load())


def replaced_by(value: float) -> Change:
    """A number instead of a node."""
    return lambda _: ast.Constant(value)


def call_of(function: str, *arguments: ast.expr) -> ast.expr:
    """A call of a function, such as "np.exp"."""
    return ast.Call(expression(function), list(arguments), [])


def exchanged(field: str, i: int) -> Change:
    """Two swapped entries of a list."""

    def change(node: Any) -> ast.AST:
        entries = getattr(node, field)
        entries[i], entries[i + 1] = entries[i + 1], entries[i]
        return node

    return change


def changed(field: str, value: Any) -> Callable[[Any], ast.AST]:
    """A node with another value of one field."""

    def change(node: Any) -> ast.AST:
        setattr(node, field, value)
        return node

    return change


def in_function(key: str, name: str) -> Callable[[Any], ast.AST]:
    """A call of another function."""

    def change(node: Any) -> ast.AST:
        setattr(node.func, key, name)
        return node

    return change


def source_of(node: ast.AST | None) -> str:
    """An expression or a line as Python; "" for a line that is taken out."""
    return "" if node is None else ast.unparse(node)


def renamed(text: str, names: Mapping[str, str]) -> ast.expr:
    """A condition with other names of its arguments."""
    tree = ast.parse(text, mode="eval").body
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            node.id = names.get(node.id, node.id)
    return tree
