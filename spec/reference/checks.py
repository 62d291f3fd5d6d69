"""The checks of this folder's decoder, left out one at a time (`mutants.py --checks`).

A check is a `require(…)`, each of its bounds, a `raise Refused(…)`, or what the list WEAKENED of misreadings.py has besides; and
where a rule is checked in several places, all of them together. Its name is `rule: what is left out`.
"""

import ast
import copy
from pathlib import Path

HERE = Path(__file__).resolve().parent
MODULES = ("bits", "range_coder", "intra", "deformation", "motion", "syntax", "kn_decode")


class Check:
    def __init__(self, rule, what, trees):
        self.name = f"{rule}: {what}"
        self.rule = rule
        self.trees = trees  # of the modules that differ, by name


def magnitude(part):
    """Of abs(x) or max(map(abs, x)): what is left of it where only what is above 0, or below it, is bounded."""
    if ast.unparse(part.func) == "abs":
        return [part.args[0], ast.UnaryOp(ast.USub(), part.args[0])]
    if ast.unparse(part).startswith("max(map(abs, "):
        inner = part.args[0].args[1]
        lowest = ast.Call(ast.Name("min", ast.Load()), [inner], [])
        return [ast.Call(part.func, [inner], []), ast.UnaryOp(ast.USub(), lowest)]
    return []


def weaker(condition):
    """The condition without one of its bounds: (what is left out, what is left)."""
    if isinstance(condition, ast.BoolOp) and isinstance(condition.op, ast.And):
        for at, part in enumerate(condition.values):
            others = condition.values[:at], condition.values[at + 1 :]
            yield ast.unparse(part), ast.BoolOp(ast.And(), [*others[0], *others[1], ast.Constant(True)])
            for what, left in weaker(part):
                yield what, ast.BoolOp(ast.And(), [*others[0], left, *others[1]])
    if isinstance(condition, ast.Compare) and len(condition.ops) == 2:
        (low, middle, high), (first, second) = [condition.left, *condition.comparators], condition.ops
        yield ast.unparse(ast.Compare(low, [first], [middle])), ast.Compare(middle, [second], [high])
        yield ast.unparse(ast.Compare(middle, [second], [high])), ast.Compare(low, [first], [middle])
    if isinstance(condition, ast.Compare) and isinstance(condition.left, ast.Call):
        sides = magnitude(condition.left)
        for side, other in zip(sides, reversed(sides)):
            left = ast.Compare(other, condition.ops, condition.comparators)
            yield ast.unparse(ast.Compare(side, condition.ops, condition.comparators)), left


def sites(tree):
    """Every check: its rule, and the call of require or the raise."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
            if ast.unparse(node.value.func) == "require":
                yield node.value.args[1].value, node
        if isinstance(node, ast.Raise) and ast.unparse(node.exc).startswith("Refused('"):
            yield node.exc.args[0].value, node


def left_out(tree, statements):
    """The tree with nothing but the conditions, which may read, in the place of requires."""

    class Drop(ast.NodeTransformer):
        def visit(self, node):
            if node not in statements:
                return super().generic_visit(node)
            rest = ast.Pass() if isinstance(node, ast.Raise) else ast.Expr(node.value.args[0])
            return ast.copy_location(rest, node)

    # Nodes are told apart by identity, and a transformer changes its tree: it gets one of its own.
    places = [at for at, node in enumerate(ast.walk(tree)) if node in statements]
    tree = copy.deepcopy(tree)
    nodes = list(ast.walk(tree))
    statements = [nodes[at] for at in places]
    return ast.fix_missing_locations(Drop().visit(tree))


def with_condition(tree, statement, condition):
    call = statement.value
    whole, call.args[0] = call.args[0], condition
    changed = ast.fix_missing_locations(copy.deepcopy(tree))
    call.args[0] = whole
    return changed


def checks(weakened):
    """All of them; `weakened` is WEAKENED, which says of some how they are left out."""
    sources = {module: (HERE / f"{module}.py").read_text() for module in MODULES}
    trees = {module: ast.parse(source) for module, source in sources.items()}
    found = {}

    def add(rule, what, changed):
        check = Check(rule, what, changed)
        while check.name in found:
            check.name += " (again)"
        found[check.name] = check

    by_rule = {}
    for module, tree in trees.items():
        for rule, statement in sites(tree):
            by_rule.setdefault(rule, {}).setdefault(module, []).append(statement)
            if isinstance(statement, ast.Raise):
                add(rule, "raise", {module: left_out(tree, [statement])})
                continue
            condition = statement.value.args[0]
            add(rule, ast.unparse(condition), {module: left_out(tree, [statement])})
            for what, left in weaker(condition):
                add(rule, what, {module: with_condition(tree, statement, left)})
    for rule, places in by_rule.items():
        if sum(map(len, places.values())) > 1:
            add(rule, "all", {module: left_out(trees[module], its) for module, its in places.items()})
    for name, pieces in weakened.items():
        changed = {}
        for module, text, instead in pieces:
            source = changed.get(module, sources[module])
            if source.count(text) != 1:
                raise ValueError(f"{name}: {module}.py has {source.count(text)} times: {text}")
            changed[module] = source.replace(text, instead)
        found[name] = Check(*name.split(": ", 1), {module: ast.parse(source) for module, source in changed.items()})
    return found
