"""Edits of a student's function that have a cause, such as a bracket left out: each with a sentence that names it.

An edit is said only if it makes the function right; so a cause is said only of a function that it makes wrong.
"""

import ast
import copy
import itertools
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from app.lab.diagnosis.edits import (
    CAUSE,
    OTHER,
    Candidate,
    Swap,
    Tree,
    call_of,
    expression,
    is_number,
    is_range,
    source_of,
)

PRECEDENCE: dict[type[ast.operator], int] = {
    ast.Add: 1, ast.Sub: 1, ast.Mult: 2, ast.Div: 2, ast.FloorDiv: 2, ast.Mod: 2, ast.MatMult: 2, ast.Pow: 3,
    ast.BitXor: 0,
}  # fmt: skip
SIGNS: dict[type[ast.operator], str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.FloorDiv: "//", ast.Mod: "%", ast.MatMult: "@",
    ast.Pow: "**", ast.BitXor: "^",
}  # fmt: skip
ROUNDED = {
    "0.3": "1 / 3", "0.33": "1 / 3", "0.333": "1 / 3", "0.67": "2 / 3", "0.66": "2 / 3", "0.667": "2 / 3",
    "0.17": "1 / 6", "0.167": "1 / 6", "0.16": "1 / 6", "3.14": "np.pi", "3.142": "np.pi", "3.1416": "np.pi",
    "6.28": "2 * np.pi", "6.283": "2 * np.pi", "1.41": "np.sqrt(2)", "1.414": "np.sqrt(2)", "10": "9.81", "9.8": "9.81",
    "9.82": "9.81",
}  # fmt: skip
COARSE = ("float16", "half", "float32", "single")
WHOLE = ("int", "np.int64", "np.int32", "np.int_", "'int'", "'i'", "int32", "int64")
ROUNDING = ("round", "around", "rint", "floor", "ceil", "trunc", "fix", "int")
DEGREES = ("radians", "deg2rad", "degrees", "rad2deg")
MAKERS = (
    "array",
    "full",
    "zeros_like",
    "ones_like",
    "full_like",
    "empty_like",
)  # arrays whose kind follows from what they get
REDUCTIONS = ("norm", "sum", "mean")
OF_NUMBERS = (
    "sqrt", "cbrt", "exp", "log", "sin", "cos", "tan", "arcsin", "arccos", "arctan", "floor", "norm", "sum",
    "tanh", "square",
)  # fmt: skip
FINER = 10  # by which a step is divided
PLAIN_NUMBERS = (0.5, 1, 2, 3, 4, 6)  # factors of laws


def traps(tree: Tree) -> Iterator[Candidate]:
    """Edits of code that Python reads in another way than mathematics."""
    for find in (carets, floor_divisions, whole_numbers, repeated_lists, coarse_numbers):
        yield from find(tree)


def causes(tree: Tree) -> Iterator[Candidate]:
    """Further edits with a cause."""
    for find in (
        brackets, powers_of_products, missing_stars, moved_brackets, roundings, limits, rounded_constants,
        fixed_numbers, degrees, early_returns, overwritten_arguments, shared_arrays, reductions, rolls,
        missing_components, components_of_lengths, means_of_arrays, fixed_entries, squares_of_sums, whole_comparisons,
        turns,
    ):  # fmt: skip
        yield from (candidate for candidate in find(tree) if not tree.is_test(candidate))


def late_causes(tree: Tree) -> Iterator[Candidate]:
    """Edits with a cause that are less likely than a condition too much, or another sign."""
    for candidate in (*brackets(tree), *moved_brackets(tree), *limits(tree), *fixed_numbers(tree)):
        if tree.is_test(candidate):
            yield candidate._replace(kind=OTHER)
    yield from roots_and_squares(tree)


def name_of(node: ast.AST) -> str:
    """The last name of a called function, or of a name."""
    if isinstance(node, ast.Call):
        node = node.func
    return node.attr if isinstance(node, ast.Attribute) else getattr(node, "id", "")


def together(swaps: Iterable[Swap], cause: str) -> Iterator[Candidate]:
    """Each edit alone, and all of them, if there are several."""
    every = tuple(swaps)
    for swap in every:
        yield Candidate((swap,), CAUSE, cause)
    if len(every) > 1:
        yield Candidate(every, CAUSE, cause)


# ----- brackets


class OperandChain:
    """Operands and operators of an expression in the order of the text; an operand in brackets is one."""

    def __init__(self, node: ast.BinOp) -> None:
        self.node = node
        self.inner: list[ast.BinOp] = []  # operations within, without brackets
        self.operands: list[ast.expr] = []
        self.signs: list[type[ast.operator]] = []
        self.add(node)

    def add(self, node: ast.BinOp) -> None:
        """Take the operands of an operation, and of those on its sides that need no brackets."""
        own = PRECEDENCE.get(type(node.op), 0)
        is_power = isinstance(node.op, ast.Pow)
        for side, is_left in ((node.left, True), (node.right, False)):
            inner = PRECEDENCE.get(type(side.op), 0) if isinstance(side, ast.BinOp) else 9
            if isinstance(side, ast.BinOp) and (inner > own or (inner == own and is_left != is_power)):
                self.inner.append(side)
                self.add(side)
            else:
                self.operands.append(side)
            if is_left:
                self.signs.append(type(node.op))

    def text(self, first: int = -1, last: int = -1, before: str = "", after: str = "", *, bare: int = -1) -> str:
        """The expression with brackets around some operands, with a text before or after them.

        bare: the operand that loses its own brackets.
        """
        parts = []
        for i, operand in enumerate(self.operands):
            text = ast.unparse(operand)
            has_brackets = isinstance(operand, ast.BinOp | ast.IfExp | ast.Compare | ast.BoolOp | ast.Lambda)
            if (has_brackets and i != bare) or (isinstance(operand, ast.UnaryOp) and self.before_power(i)):
                text = f"({text})"
            text = f"{before}(" * (i == first) + text + f"){after}" * (i == last)
            parts += [text, SIGNS[self.signs[i]]] if i < len(self.signs) else [text]
        return " ".join(parts)

    def before_power(self, i: int) -> bool:
        """True if an operand is raised to a power."""
        return i < len(self.signs) and self.signs[i] is ast.Pow


def brackets(tree: Tree) -> Iterator[Candidate]:
    """Every other bracketing of the operations, also in all expressions of the same form."""
    chains: list[OperandChain] = []
    inner: list[ast.BinOp] = []
    for node in tree.of(ast.BinOp):  # outer ones first
        if node not in inner:
            chain = OperandChain(node)
            inner += chain.inner
            if all(sign in SIGNS for sign in chain.signs):
                chains.append(chain)
    alike: dict[tuple[Any, ...], list[Swap]] = {}
    for chain in chains:
        signs, count = tuple(chain.signs), len(chain.operands)
        texts = {(first, last): chain.text(first, last) for first, last in itertools.combinations(range(count), 2)}
        bare = (i for i, operand in enumerate(chain.operands) if isinstance(operand, ast.BinOp))
        texts |= {(i, i): chain.text(bare=i) for i in bare}
        for place, text in texts.items():
            new = expression(text)
            if ast.dump(new) != ast.dump(chain.node):
                alike.setdefault((signs, place), []).append((chain.node, new))
    for (_, (first, last)), swaps in alike.items():
        yield from together(swaps, "Brackets are missing." if first < last else "Brackets are wrong.")


def missing_stars(tree: Tree) -> Iterator[Candidate]:
    """a * 2 for a ** 2."""
    for node in tree.of(ast.BinOp):
        chain = OperandChain(node)
        if isinstance(tree.parent(node), ast.BinOp) or not all(sign in SIGNS for sign in chain.signs):
            continue
        for i, sign in enumerate(chain.signs):
            if sign is ast.Mult and is_number(chain.operands[i + 1]):
                other = OperandChain(node)
                other.signs[i] = ast.Pow
                yield Candidate(((node, expression(other.text())),), CAUSE, "A power is written with two stars.")


def powers_of_products(tree: Tree) -> Iterator[Candidate]:
    """(a b)² for a² b and a b², and the other way round."""
    for node in tree.of(ast.BinOp):
        if not isinstance(node.op, ast.Pow) or not isinstance(node.left, ast.BinOp):
            continue
        if isinstance(node.left.op, ast.Mult | ast.Div):
            left, right, op, power = node.left.left, node.left.right, node.left.op, node.right
            for new in (
                ast.BinOp(ast.BinOp(left, ast.Pow(), power), op, right),
                ast.BinOp(left, op, ast.BinOp(right, ast.Pow(), power)),
            ):
                yield Candidate(((node, new),), CAUSE, "The power is that of one factor only.")


def roots_and_squares(tree: Tree) -> Iterator[Candidate]:
    """A root or a square around a part of a product or sum."""
    for node in tree.of(ast.BinOp):
        chain = OperandChain(node)
        count = len(chain.operands)
        if isinstance(tree.parent(node), ast.BinOp) or not all(sign in SIGNS for sign in chain.signs):
            continue
        for first, last in itertools.combinations_with_replacement(range(count), 2):
            for before, after, words in (("np.sqrt", "", "A root"), ("", " ** 2", "A square")):
                text = chain.text(first, last, before, after)
                if last == count - 1 or not chain.before_power(last):
                    yield Candidate(((node, expression(text)),), OTHER, f"{words} is missing.")


def moved_brackets(tree: Tree) -> Iterator[Candidate]:
    """A closing or opening bracket of a call at another place: f(a) b for f(a b), f(a b) for f(a) b."""
    cause = "A bracket is at the wrong place."
    for node in tree.of(ast.Call):
        if name_of(node) not in OF_NUMBERS or len(node.args) != 1 or node.keywords:
            continue
        parent, inner = tree.parent(node), node.args[0]
        if isinstance(inner, ast.BinOp):
            for top in chain_splits(inner):
                left, op, right = top
                yield Candidate(((node, ast.BinOp(with_argument(node, left), op, right)),), CAUSE, cause)
                yield Candidate(((node, ast.BinOp(left, op, with_argument(node, right))),), CAUSE, cause)
        if isinstance(parent, ast.BinOp):
            if node is parent.left:
                other: ast.expr = parent.right
                new = with_argument(node, ast.BinOp(inner, parent.op, other))
                yield Candidate(((parent, new),), CAUSE, cause)
                if isinstance(other, ast.Call) and source_of(other.func) == source_of(node.func) and other.args:
                    both = with_argument(node, ast.BinOp(inner, parent.op, other.args[0]))
                    yield Candidate(((parent, both),), CAUSE, f"{source_of(node.func)} belongs around the whole.")
            else:
                yield Candidate(
                    ((parent, with_argument(node, ast.BinOp(parent.left, parent.op, inner))),), CAUSE, cause
                )
                if isinstance(parent.left, ast.BinOp):
                    left = parent.left
                    new = ast.BinOp(left.left, left.op, with_argument(node, ast.BinOp(left.right, parent.op, inner)))
                    yield Candidate(((parent, new),), CAUSE, cause)


def chain_splits(node: ast.BinOp) -> Iterator[tuple[ast.expr, ast.operator, ast.expr]]:
    """The two parts of an operation, cut at each of its operators in the order of the text."""
    chain = OperandChain(node)
    pieces = [f"({ast.unparse(operand)})" for operand in chain.operands]
    for cut in range(1, len(pieces)):

        def joined(part: Sequence[str], signs: Sequence[type[ast.operator]]) -> ast.expr:
            words = [part[0], *itertools.chain(*((SIGNS[s], p) for s, p in zip(signs, part[1:], strict=True)))]
            return expression(" ".join(words))

        if all(sign in SIGNS for sign in chain.signs):
            left = joined(pieces[:cut], chain.signs[: cut - 1])
            yield left, chain.signs[cut - 1](), joined(pieces[cut:], chain.signs[cut:])


def with_argument(call: ast.Call, argument: ast.expr) -> ast.Call:
    """A call with another argument."""
    return ast.Call(call.func, [argument], [])


# ----- operators and numbers


def carets(tree: Tree) -> Iterator[Candidate]:
    """^ for **."""
    own = [node for node in tree.of(ast.BinOp) if isinstance(node.op, ast.BitXor)]
    # The sign binds less than + and *, so that the text is parsed anew.
    tops = [node for node in own if not isinstance(tree.parent(node), ast.BinOp)]
    swaps = [(node, expression(ast.unparse(node).replace("^", "**"))) for node in tops]
    yield from together(swaps, "In Python ^ is no power: write **.")


def floor_divisions(tree: Tree) -> Iterator[Candidate]:
    """// for /."""
    own = [node for node in tree.of(ast.BinOp) if isinstance(node.op, ast.FloorDiv)]
    swaps = [(node, expression(ast.unparse(node).replace("//", "/"))) for node in own]
    yield from together(swaps, "The sign // rounds the quotient down: write /.")
    if len(own) > 1:
        yield from statement_swaps(
            tree, own, lambda text: text.replace("//", "/"), "The sign // rounds the quotient down: write /."
        )


def statement_swaps(tree: Tree, nodes: Sequence[ast.AST], change: Any, cause: str) -> Iterator[Candidate]:
    """One edit of all statements that hold some nodes, by a change of their text."""
    statements = list(dict.fromkeys(tree.statement(node) for node in nodes))
    if any(hasattr(statement, "body") for statement in statements):
        return
    yield Candidate(
        tuple((one, ast.parse(change(ast.unparse(one))).body[0]) for one in statements if not is_return(one))
        + tuple((one.value, expression(change(ast.unparse(one.value)))) for one in statements if is_return(one)),  # type: ignore[attr-defined]
        CAUSE, cause,
    )  # fmt: skip


def is_return(node: ast.AST) -> bool:
    """True for a return, whose text alone is no program."""
    return isinstance(node, ast.Return) and node.value is not None


def whole_numbers(tree: Tree) -> Iterator[Candidate]:
    """Arrays of whole numbers, in which decimals are cut off."""
    swaps: list[Swap] = []
    for call in tree.of(ast.Call):
        name, new = name_of(call), copy.deepcopy(call)
        keywords = [key for key in new.keywords if not (key.arg == "dtype" and source_of(key.value) in WHOLE)]
        if len(keywords) < len(call.keywords):
            new.keywords = keywords
            swaps.append((call, new))
        elif len(call.args) > 1 and source_of(call.args[-1]) in WHOLE:
            new.args.pop()
            swaps.append((call, new))
        elif (
            name == "astype" and isinstance(call.func, ast.Attribute) and call.args and source_of(call.args[0]) in WHOLE
        ):
            swaps.append((call, call.func.value))
        elif name in MAKERS and not any(key.arg == "dtype" for key in call.keywords):
            new.keywords = [*new.keywords, ast.keyword("dtype", ast.Name("float", ast.Load()))]
            swaps.append((call, new))
    yield from together(swaps, "This array holds whole numbers, so that decimals are cut off.")


def repeated_lists(tree: Tree) -> Iterator[Candidate]:
    """[array] * n, which is one array with n names."""
    for node in tree.of(ast.BinOp):
        if not isinstance(node.op, ast.Mult):
            continue
        for items, count in ((node.left, node.right), (node.right, node.left)):
            if isinstance(items, ast.List) and len(items.elts) == 1:
                new = expression(f"[{ast.unparse(items.elts[0])} for _ in range({ast.unparse(count)})]")
                yield Candidate(((node, new),), CAUSE, "All entries of this list are one and the same object.")


def roundings(tree: Tree) -> Iterator[Candidate]:
    """A value that is rounded."""
    own = [call for call in tree.of(ast.Call) if name_of(call) in ROUNDING and call.args]
    method = [call for call in tree.of(ast.Call) if name_of(call) == "round" and isinstance(call.func, ast.Attribute)
              and getattr(call.func.value, "id", "") != "np"]  # fmt: skip
    swaps = [(call, call.func.value if call in method else call.args[0]) for call in dict.fromkeys((*own, *method))]
    yield from together(swaps, "Do not round.")


def limits(tree: Tree) -> Iterator[Candidate]:
    """A value that is limited."""
    swaps: list[Swap] = []
    for call in tree.of(ast.Call):
        if name_of(call) in ("clip", "nan_to_num") and call.args:
            is_method = isinstance(call.func, ast.Attribute) and getattr(call.func.value, "id", "") not in (
                "np",
                "numpy",
            )
            swaps.append((call, call.func.value if is_method else call.args[0]))  # type: ignore[attr-defined]
        elif name_of(call) in ("min", "max", "minimum", "maximum") and len(call.args) == 2:
            fixed = [source_of(part).lstrip("-").replace(".", "").isdigit() for part in call.args]
            if any(fixed) and not all(fixed):
                swaps.append((call, call.args[fixed.index(False)]))
    yield from together(swaps, "The value is limited.")


def coarse_numbers(tree: Tree) -> Iterator[Candidate]:
    """Numbers of few digits."""
    swaps: list[Swap] = []
    for call in tree.of(ast.Call):
        if name_of(call) in COARSE and call.args:
            swaps.append((call, call.args[0]))
        elif name_of(call) == "astype" and call.args and name_of(call.args[0]) in COARSE:
            swaps.append((call, call.func.value))  # type: ignore[attr-defined]
        elif any(key.arg == "dtype" and name_of(key.value) in COARSE for key in call.keywords):
            new = copy.deepcopy(call)
            new.keywords = [key for key in new.keywords if key.arg != "dtype"]
            swaps.append((call, new))
    yield from together(swaps, "These numbers have too few digits.")


def rounded_constants(tree: Tree) -> Iterator[Candidate]:
    """0.33 for 1/3, 3.14 for pi."""
    for node in tree.of(ast.Constant):
        if is_number(node) and repr(node.value) in ROUNDED:
            yield from together([(node, expression(ROUNDED[repr(node.value)]))], "The number is rounded.")


def fixed_numbers(tree: Tree) -> Iterator[Candidate]:
    """A number in place of an argument, or of the number of points."""
    for node in tree.of(ast.Constant):
        is_compared = isinstance(tree.parent(node), ast.Compare | ast.Subscript)
        if not is_number(node) or node.value == 0 or node.value in PLAIN_NUMBERS or is_compared:
            continue
        for name in tree.arguments:
            yield Candidate(((node, ast.Name(name, ast.Load())),), CAUSE, f"A fixed number stands in place of {name}.")
            if isinstance(node.value, int) and node.value > 2:
                yield Candidate(
                    ((node, expression(f"len({name})")),), CAUSE, "The number of points is not always the same."
                )


def degrees(tree: Tree) -> Iterator[Candidate]:
    """Degrees and radians mixed up."""
    own = [call for call in tree.of(ast.Call) if name_of(call) in DEGREES and call.args]
    yield from together([(call, call.args[0]) for call in own], "Angles are in radians.")


# ----- lines


def early_returns(tree: Tree) -> Iterator[Candidate]:
    """A return inside a loop, which ends the function in the first turn."""
    for loop in tree.of(ast.For, ast.While):
        if isinstance(loop.body[-1], ast.Return) and len(loop.body) > 1:
            new = copy.copy(loop)
            new.body = loop.body[:-1]
            both = ast.If(ast.Constant(True), [new, loop.body[-1]], [])
            line = loop.body[-1].lineno
            yield Candidate(
                ((loop, both),), CAUSE,
                f"The return in line {line} stands inside the loop, which therefore ends in its first turn. "
                "Behind the loop it is right.",
            )  # fmt: skip


def turns(tree: Tree) -> Iterator[Candidate]:
    """A loop with one turn too few or too many."""
    for call in tree.of(ast.Call):
        if is_range(call):
            last, first = call.args[-1], call.args[:-1] or [ast.Constant(0)]
            less, more = (ast.BinOp(last, op, ast.Constant(1)) for op in (ast.Sub(), ast.Add()))
            if isinstance(last, ast.Constant) and isinstance(last.value, int):
                less, more = (ast.Constant(last.value + step) for step in (-1, 1))  # type: ignore[assignment]
            ends: list[tuple[str, list[ast.expr]]] = [("many", [*call.args[:-1], less])]
            if isinstance(last, ast.BinOp) and isinstance(last.op, ast.Sub) and is_number(last.right):
                left, less_off = last.left, getattr(last.right, "value", 1) - 1
                longer = ast.BinOp(left, ast.Sub(), ast.Constant(less_off)) if less_off > 0 else left
                ends.append(("few", [*call.args[:-1], longer]))
            ends.append(("few", [*call.args[:-1], more]))
            if len(call.args) == 1:
                ends.append(("many", [ast.Constant(1), last]))
            elif len(call.args) == 2 and source_of(first[0]) != "0":
                ends.append(("few", [last]))
            for word, arguments in ends:
                yield Candidate(((call, call_of("range", *arguments)),), CAUSE, f"The loop has too {word} turns.")


def finer_steps(tree: Tree) -> Iterator[Candidate]:
    """A tenth of a number below 1 in a loop, or of a name that a loop uses: it may be the length of the steps."""
    turned = {part for loop in tree.of(ast.For, ast.While) for line in loop.body for part in ast.walk(line)}
    used = {part.id for part in turned if isinstance(part, ast.Name)}
    for node in tree.of(ast.Constant):
        parent = tree.parent(node)
        names = {getattr(target, "id", "") for target in getattr(parent, "targets", ())}
        if is_number(node) and 0 < node.value < 1 and (node in turned or names & used):
            yield Candidate(((node, ast.Constant(node.value / FINER)),), OTHER)


def overwritten_arguments(tree: Tree) -> Iterator[Candidate]:
    """An argument that is set to a number."""
    for node in tree.of(ast.Assign):
        name = getattr(node.targets[0], "id", "")
        if name in tree.arguments and not any(isinstance(part, ast.Name) for part in ast.walk(node.value)):
            yield Candidate(((node, None),), CAUSE, f"Line {node.lineno} overwrites the argument {name}.")


def shared_arrays(tree: Tree) -> Iterator[Candidate]:
    """Two names of one array."""
    for node in tree.of(ast.Assign):
        if len(node.targets) > 1:
            each: list[ast.stmt] = [
                ast.Assign([target], copy.deepcopy(node.value), lineno=node.lineno) for target in node.targets
            ]
            both = ast.If(ast.Constant(True), each, [])
            names = " and ".join(source_of(target) for target in node.targets)
            same = f"In line {node.lineno} {names} are names of one and the same array."
            cause = f"{same} With an array for each it is right."
            yield Candidate(((node, both),), CAUSE, cause)
        elif isinstance(node.value, ast.Name) and isinstance(node.targets[0], ast.Name):
            new = expression(f"np.copy({node.value.id})")
            cause = f"{node.targets[0].id} and {node.value.id} are names of one and the same array."
            yield Candidate(((node.value, new),), CAUSE, cause)


# ----- arrays


def reductions(tree: Tree) -> Iterator[Candidate]:
    """A norm or sum over all points, or along the wrong axis."""
    swaps: list[Swap] = []
    for call in tree.of(ast.Call):
        if name_of(call) not in REDUCTIONS or not isinstance(call.func, ast.Attribute):
            continue
        new = copy.deepcopy(call)
        keywords = [key for key in new.keywords if key.arg not in ("axis", "keepdims")]
        new.keywords = [*keywords, ast.keyword("axis", ast.Constant(1)), ast.keyword("keepdims", ast.Constant(True))]
        swaps.append((call, new))
    yield from together(swaps, "A row of the array is a point: give each row its own value.")


def rolls(tree: Tree) -> Iterator[Candidate]:
    """np.roll without an axis, which runs through all numbers of an array."""
    swaps: list[Swap] = []
    for call in tree.of(ast.Call):
        if name_of(call) in ("roll", "diff", "cumsum", "flip") and not any(key.arg == "axis" for key in call.keywords):
            new = copy.deepcopy(call)
            new.keywords = [*new.keywords, ast.keyword("axis", ast.Constant(0))]
            swaps.append((call, new))
    if swaps:
        yield from together(swaps, "This runs along single numbers, not along points: it needs an axis.")


def missing_components(tree: Tree) -> Iterator[Candidate]:
    """A length of two components of three."""
    for node in tree.of(ast.Call, ast.BinOp):
        is_root = (isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow)) or name_of(node) in ("sqrt", "hypot")
        indexed = [part for part in ast.walk(node) if isinstance(part, ast.Subscript)]
        owners = {source_of(part.value) for part in indexed}
        if is_root and len(indexed) > 1 and len(owners) == 1:
            new = expression(f"np.linalg.norm({owners.pop()})")
            yield Candidate(((node, new),), CAUSE, "The length needs all components.")


def components_of_lengths(tree: Tree) -> Iterator[Candidate]:
    """The length of a vector in place of a component, at each place that has it."""
    calls = [call for call in tree.of(ast.Call) if name_of(call) == "norm" and len(call.args) == 1]
    for text in {source_of(call) for call in calls}:
        own = [call for call in calls if source_of(call) == text]
        for i in range(3):
            new = expression(f"{source_of(own[0].args[0])}[{i}]")
            swaps = tuple((call, copy.deepcopy(new)) for call in own)
            yield Candidate(swaps, CAUSE, "This is the length of the vector, not a component.")
    for node in tree.of(ast.BinOp, ast.Call):
        sides = [node.left, node.right] if isinstance(node, ast.BinOp) else node.args
        is_square = (
            isinstance(node.op, ast.MatMult) if isinstance(node, ast.BinOp) else name_of(node) in ("dot", "inner")
        )
        if is_square and len(sides) == 2 and source_of(sides[0]) == source_of(sides[1]):
            for i in range(3):
                new = expression(f"{source_of(sides[0])}[{i}] ** 2")
                yield Candidate(((node, new),), CAUSE, "This is the square of the whole vector, not of a component.")


def means_of_arrays(tree: Tree) -> Iterator[Candidate]:
    """The mean or sum of an array in place of an entry."""
    stored = [n.id for loop in tree.of(ast.For) for n in ast.walk(loop.target) if isinstance(n, ast.Name)]
    for call in tree.of(ast.Call):
        if name_of(call) not in ("mean", "sum", "max", "min", "median", "average"):
            continue
        is_method = isinstance(call.func, ast.Attribute) and getattr(call.func.value, "id", "") not in ("np", "numpy")
        if not is_method and len(call.args) != 1:
            continue
        own = call.func.value if is_method else call.args[0]  # type: ignore[attr-defined]
        for name in dict.fromkeys(stored):
            new = expression(f"{source_of(own)}[{name}]")
            yield Candidate(((call, new),), CAUSE, "This is one number of all entries, not that of this turn.")


def fixed_entries(tree: Tree) -> Iterator[Candidate]:
    """The same entry of an array in each turn of a loop."""
    stored = [n.id for loop in tree.of(ast.For) for n in ast.walk(loop.target) if isinstance(n, ast.Name)]
    for node in tree.of(ast.Subscript):
        if is_number(node.slice):
            for name in dict.fromkeys(stored):
                new = ast.Name(name, ast.Load())
                yield Candidate(((node.slice, new),), CAUSE, "This is the same entry in each turn of the loop.")


def squares_of_sums(tree: Tree) -> Iterator[Candidate]:
    """The root of a sum without squares."""
    for call in tree.of(ast.Call):
        if name_of(call) == "sqrt" and len(call.args) == 1 and isinstance(call.args[0], ast.BinOp):
            inner = call.args[0]
            if isinstance(inner.op, ast.Add):
                left, right = (ast.BinOp(side, ast.Pow(), ast.Constant(2)) for side in (inner.left, inner.right))
                new = ast.BinOp(left, ast.Add(), right)
                yield Candidate(((inner, new),), CAUSE, "The squares are missing below the root.")


def whole_comparisons(tree: Tree) -> Iterator[Candidate]:
    """A comparison of arrays in a condition."""
    for node in tree.of(ast.Compare):
        if isinstance(tree.parent(node), ast.If | ast.IfExp | ast.BoolOp | ast.While):
            for how in ("all", "any"):
                new = call_of(f"np.{how}", copy.deepcopy(node))
                yield Candidate(((node, new),), CAUSE, "A condition needs one answer, not one for each entry.")
