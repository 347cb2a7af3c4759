"""Public functions of arrays say in their docstrings what a stranger needs to call them.

A docstring must name a shape, a unit, or by `name` the place where they stand. This is a test of
words: it notices a docstring that says nothing of them, not one that says something wrong.
"""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

SOURCE = Path(__file__).parents[2] / "src" / "owtsweep"

#: The types whose shape and unit a caller must know.
ARRAYS = {"Array", "Complex", "NDArray", "npt.NDArray"}

_ITEM = r"(?:\.\.\.|\w+(?: ?[-+*/] ?\w+| [a-z]+)*)"
SHAPE = re.compile(rf"\({_ITEM},(?: {_ITEM}(?:, {_ITEM})*)?\)|\bshapes?\b")
UNITS = "m s Hz rad deg degrees N kN MN Nm Pa kg dB step steps sample samples seconds metres"
# what has no unit: counts, indices, truth values and shares
UNITS += " unit units number numbers index indices whether share per cent"
UNIT = re.compile(rf"(?<!['\w])(?:{'|'.join(UNITS.split())})(?!\w)")
POINTER = re.compile(r"`[A-Za-z_.]+`")

#: Functions that still say neither; nobody may join them.
SILENT = {
    "studies/floater/schemes/printed.py: output_noise",
    "studies/tower/schemes/mde.py: Bands.integrate",
    "studies/tower/truth.py: find_damping",
    "verdicts/judge.py: Task.ratio",
    "verdicts/judge.py: Task.transform",
}


def is_array(type_: ast.expr | None) -> bool:
    """Whether a type is an array, perhaps None, or a tuple with arrays."""
    if isinstance(type_, ast.BinOp):
        return is_array(type_.left) or is_array(type_.right)
    if isinstance(type_, ast.Subscript):
        if ast.unparse(type_.value) == "tuple":
            inner = type_.slice
            return any(map(is_array, inner.elts if isinstance(inner, ast.Tuple) else [inner]))
        return ast.unparse(type_.value) in ARRAYS
    return type_ is not None and ast.unparse(type_) in ARRAYS


def takes_or_returns_arrays(function: ast.FunctionDef) -> bool:
    arguments = function.args
    given = [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs]
    return is_array(function.returns) or any(is_array(each.annotation) for each in given)


def says_enough(docstring: str) -> bool:
    return any(pattern.search(docstring) for pattern in (SHAPE, UNIT, POINTER))


def list_functions(node: ast.AST, prefix: str = "") -> Iterator[tuple[str, ast.FunctionDef]]:
    """Yield the public functions and methods of a module, with the names of their classes."""
    for each in ast.iter_child_nodes(node):
        if isinstance(each, ast.ClassDef) and not each.name.startswith("_"):
            yield from list_functions(each, f"{prefix}{each.name}.")
        elif isinstance(each, ast.FunctionDef) and not each.name.startswith("_"):
            yield prefix + each.name, each


def list_all() -> dict[str, ast.FunctionDef]:
    """Return "path: name" -> function, of those with arrays."""
    return {
        f"{path.relative_to(SOURCE).as_posix()}: {name}": function
        for path in sorted(SOURCE.rglob("*.py"))
        for name, function in list_functions(ast.parse(path.read_text(encoding="utf-8")))
        if takes_or_returns_arrays(function)
    }


def test_public_functions_of_arrays_say_a_shape_or_a_unit_or_where_they_stand():
    texts = {name: ast.get_docstring(function) for name, function in list_all().items()}
    silent = {name for name, text in texts.items() if text and not says_enough(text)}
    assert silent - SILENT == set()


def test_only_methods_that_another_class_describes_have_no_docstring():
    functions = list_all()
    described = {
        function.name
        for name, function in functions.items()
        if "." in name.split(": ")[1] and ast.get_docstring(function)
    }
    bare = {name for name, function in functions.items() if not ast.get_docstring(function)}
    assert {
        name
        for name in bare
        if "." not in name.split(": ")[1] or functions[name].name not in described
    } == set()


def test_the_rule_tells_what_says_enough_from_what_does_not():
    for text in (
        "Return the states, shape (steps, 2).",
        "Return the gain (n,).",
        "Return the matrices (samples, 3, 3).",
        "Return the position in m.",
        "Return the speed, m/s.",
        "Do as `find_pose` does.",
    ):
        assert says_enough(text)
    for text in (
        "Return the sensor's error.",
        "Solve the problem (Eq. 28) of Simpson et al. (2025).",
        "Return what a filter finds (Kalman 1960).",
    ):
        assert not says_enough(text)


def test_functions_with_arrays_are_found():
    found = list_all()
    assert len(found) > 300
    assert "estimation/wahba.py: find_pose" in found
    assert "estimation/lagged.py: Lagged.run" in found
