"""What modules remember: a census of their names that may change, by their syntax trees."""

import ast
from dataclasses import dataclass

# Constructors of what is made to be changed.
CHANGEABLE = {
    *("list", "dict", "set", "bytearray", "OrderedDict", "defaultdict", "Counter", "deque"),
    *("ChainMap", "WeakValueDictionary", "WeakKeyDictionary", "WeakSet", "count", "cycle", "iter"),
    *("SimpleQueue", "Queue", "LifoQueue", "PriorityQueue", "Lock", "RLock", "Event", "Condition"),
    *("Semaphore", "BoundedSemaphore", "Barrier", "Thread", "local", "ContextVar", "BytesIO"),
    *("StringIO", "SimpleNamespace", "default_rng", "RandomState"),
}
MEMOS = {"cache", "lru_cache"}
# Methods that change what they are called on.
CHANGES = {
    *("append", "appendleft", "extend", "insert", "remove", "pop", "popleft", "popitem", "clear"),
    *("add", "discard", "update", "setdefault", "move_to_end", "sort", "reverse", "put", "fill"),
    *("difference_update", "intersection_update", "symmetric_difference_update", "setflags"),
}
DISPLAYS = (ast.List, ast.Dict, ast.Set, ast.ListComp, ast.DictComp, ast.SetComp)
FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)
# What cannot be changed, and functions that make such things, whatever the name they are bound to.
UNCHANGEABLE = {
    *("bool", "int", "float", "str", "bytes", "tuple", "frozenset", "range"),
    *("register_classes_factory", "whole_number"),
}
# Classes that are no frozen dataclasses, and whose objects do not change once they are made.
UNCHANGING_CLASSES = {"UniformStruct", "Air"}


@dataclass(frozen=True)
class State:
    """Something that a module remembers.

    Parameters
    ----------
    name : str
        ``module.name``, or ``module.Class.name``.
    line : int
    why : str
        How it is seen.
    memo : bool
        It is a memo of `functools`.
    """

    name: str
    line: int
    why: str
    memo: bool = False


def census(trees):
    """Return what modules remember.

    Parameters
    ----------
    trees : dict of str to ast.Module
        By the modules' names.

    Returns
    -------
    dict of str to State
        By `State.name`.
    """
    classes = {
        node.name: _is_frozen(node)
        for tree in trees.values()
        for node in ast.walk(tree)
        if isinstance(node, ast.ClassDef)
    }
    found = {}
    for module, tree in trees.items():
        modules = {name.rpartition(".")[2] for name in trees}
        for state in (*_of_module(module, tree, classes), *_changed_in(module, tree, modules)):
            found.setdefault(state.name, state)
    return found


def _of_module(module, tree, classes):
    for statement in _outside_functions(tree.body):
        if isinstance(statement, ast.ClassDef):
            yield from _of_class(f"{module}.{statement.name}", statement, classes)
        elif isinstance(statement, FUNCTIONS):
            yield from _memo(module, statement)
        for target, value in _assignments(statement):
            why = _why(target, value, classes)
            if why:
                yield State(f"{module}.{target}", statement.lineno, why, why == "is a memo")


def _outside_functions(body):
    """Yield the statements of a module, also those in its conditions and loops."""
    for statement in body:
        yield statement
        if isinstance(statement, (ast.ClassDef, *FUNCTIONS)):
            continue
        for field in ("body", "orelse", "finalbody"):
            yield from _outside_functions(getattr(statement, field, []))
        for handler in getattr(statement, "handlers", []):
            yield from _outside_functions(handler.body)


def _of_class(name, node, classes):
    for statement in _outside_functions(node.body):
        if isinstance(statement, FUNCTIONS):
            yield from _memo(name, statement)
        for target, value in _assignments(statement):
            # Blender's own words for its classes are sets and dicts that it reads once.
            if (
                target.startswith("bl_")
                or isinstance(value, ast.Call)
                and _callee(value) == "field"
            ):
                continue
            why = _why(target, value, classes)
            if why:
                yield State(f"{name}.{target}", statement.lineno, why, why == "is a memo")


def _memo(owner, function):
    for decorator in function.decorator_list:
        if _last_name(decorator) in MEMOS:
            yield State(f"{owner}.{function.name}", decorator.lineno, "is a memo", True)


def _assignments(statement):
    """Yield the names that a statement binds with the value of each."""
    if isinstance(statement, ast.Assign):
        targets, value = statement.targets, statement.value
    elif isinstance(statement, ast.AnnAssign) and statement.value is not None:
        targets, value = [statement.target], statement.value
    else:
        return
    for target in targets:
        if isinstance(target, ast.Name):
            yield target.id, value
        elif isinstance(target, ast.Tuple):
            parts = target.elts
            values = value.elts if isinstance(value, ast.Tuple) else [value] * len(parts)
            yield from ((p.id, v) for p, v in zip(parts, values, strict=True))


def _why(name, value, classes):
    """Return how the value of a name is seen to be state; None if it is none."""
    constant = name.strip("_").isupper() or name.startswith("__")
    if isinstance(value, DISPLAYS):
        # One with the name of a constant must not be changed, which is looked for elsewhere.
        return None if constant else "is bound to what can be changed; a constant is in CAPITALS"
    if not isinstance(value, ast.Call):
        return None
    callee = _callee(value)
    if callee in MEMOS or isinstance(value.func, ast.Call) and _callee(value.func) in MEMOS:
        return "is a memo"
    if callee in CHANGEABLE and not (constant and callee in {"list", "dict", "set"}):
        return f"is a {callee}"
    if callee in classes and not classes[callee] and callee not in UNCHANGING_CLASSES:
        return f"is a {callee}, which is no frozen dataclass"
    if not constant and callee not in UNCHANGEABLE and not classes.get(callee):
        return f"is what {callee} made; a constant is in CAPITALS"
    return None


def _changed_in(module, tree, modules):
    """Yield the names of a module that its functions change.

    `modules` are last names of our own: a call of one's function ``add`` changes nothing.
    """
    lines, imported = {}, set()
    for statement in _outside_functions(tree.body):
        own, theirs = _bound(statement)
        lines |= dict.fromkeys(own, statement.lineno)
        imported |= theirs & modules
    for function, owner in _functions(tree):
        local = _local_names(function)
        body = function.body if isinstance(function.body, list) else [function.body]
        for node in (inner for part in body for inner in ast.walk(part)):
            for name in node.names if isinstance(node, ast.Global) else ():
                yield State(f"{module}.{name}", lines.get(name, node.lineno), "is bound anew")
            for path in _changed(node):
                first, dot, rest = path.partition(".")
                why = f"is changed in line {node.lineno}"
                if first == "cls" and owner:
                    yield State(f"{module}.{owner}{dot}{rest}", node.lineno, why)
                elif first in lines and first not in local and (dot or first not in imported):
                    yield State(f"{module}.{path}", lines[first], why)


def _functions(tree):
    """Yield all functions of a module, each with the name of the class whose method it is."""
    methods = {
        function: node.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ClassDef)
        for function in node.body
    }
    for node in ast.walk(tree):
        if isinstance(node, FUNCTIONS):
            yield node, methods.get(node)


def _changed(node):
    """Yield what a statement or call changes, as dotted names."""
    targets = []
    if isinstance(node, ast.Assign | ast.Delete):
        targets = node.targets
    elif isinstance(node, ast.AugAssign | ast.AnnAssign):
        targets = [node.target]
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
        if node.func.attr in CHANGES and (path := _path(node.func.value)):
            yield path
        return
    elif isinstance(node, ast.Call) and _callee(node) in {"setattr", "delattr"}:
        if path := _path(node.args[0]):
            name = node.args[1]
            yield f"{path}.{name.value if isinstance(name, ast.Constant) else '*'}"
        return
    for target in targets:
        for part in target.elts if isinstance(target, ast.Tuple | ast.List) else [target]:
            if isinstance(part, ast.Subscript | ast.Attribute):
                inner = part.value if isinstance(part, ast.Subscript) else part
                if path := _path(inner):
                    yield path


def _path(node):
    """Return ``a.b.c`` of names and attributes, subscripts left out; None of anything else."""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Subscript):
        return _path(node.value)
    if isinstance(node, ast.Attribute):
        inner = _path(node.value)
        return inner and f"{inner}.{node.attr}"
    return None


def _local_names(function):
    """Return the names that are a function's own, or those of a function in it."""
    found = set()
    for node in ast.walk(function):
        if isinstance(node, ast.arg):
            found.add(node.arg)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            found.add(node.id)
    for node in ast.walk(function):
        if isinstance(node, ast.Global):
            found -= set(node.names)
    return found


def _bound(statement):
    """Return the names that a statement of a module binds, and those that it takes from our own.

    What is imported from elsewhere is not ours: Blender's handlers, `sys.path`.
    """
    if isinstance(statement, ast.ImportFrom) and statement.level:
        names = {alias.asname or alias.name for alias in statement.names}
        return names, names
    if isinstance(statement, ast.ClassDef | ast.FunctionDef):
        return {statement.name}, set()
    return {name for name, _ in _assignments(statement)}, set()


def _callee(call):
    return _last_name(call.func)


def _last_name(node):
    if isinstance(node, ast.Call):
        return _last_name(node.func)
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ""


def _is_frozen(node):
    """Whether a class is a frozen dataclass, a named tuple or an enumeration."""
    for decorator in node.decorator_list:
        if isinstance(decorator, ast.Call) and _callee(decorator) == "dataclass":
            return any(
                word.arg == "frozen" and isinstance(word.value, ast.Constant) and word.value.value
                for word in decorator.keywords
            )
    return bool({_last_name(base) for base in node.bases} & {"NamedTuple", "Enum", "Flag"})
