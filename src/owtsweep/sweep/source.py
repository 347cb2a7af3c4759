"""Hashes the source of a user's code, so that stored results can name the code that made them."""

from __future__ import annotations

import ast
import importlib.util
import inspect
import sys
import sysconfig
from collections.abc import Iterator
from hashlib import blake2b
from pathlib import Path
from types import ModuleType

#: The stand-in for the hash of a source that cannot be read, e.g. of a class in a notebook.
UNKNOWN = "unknown"


def describe_source(code: type, version: object = None) -> dict[str, object]:
    """Return what identifies the code of a user's class, as a part of a block's content.

    Returns: the entry `source` is the hash of the source of the class's module, or `UNKNOWN`. The
        entry `modules` maps names to hashes, for each other module of the user that the class's
        module imports, directly or indirectly; it is absent if there is no such module. The entry
        `version` is the argument as text; it is absent if the argument is None.
    """
    own, others = _hash_sources(code)
    entry: dict[str, object] = {"source": own}
    if others:
        entry["modules"] = others
    if version is not None:
        entry["version"] = str(version)
    return entry


def explain_doubt(code: type, version: object = None) -> str:
    """Return in one line why stored results of a user's class may be out of date.

    The reason is a source that cannot be read, so that a change of this source goes unnoticed.
    Return "" if the class states a version, or all sources can be read.
    """
    if version is not None:
        return ""
    own, others = _hash_sources(code)
    unread = [name for name, digest in others.items() if digest == UNKNOWN]
    if own == UNKNOWN:
        unread.insert(0, code.__name__)
    if not unread:
        return ""
    return (
        f"the source of {', '.join(unread)} cannot be read, so stored results may be those of "
        f"another version; give {code.__name__} a class attribute version = ... to keep them"
    )


def _hash_sources(code: type) -> tuple[str, dict[str, str]]:
    """Return the hash of the module of a class, and name -> hash of what the module imports."""
    module = inspect.getmodule(code)
    if module is None:
        return _read_source(code), {}
    return _read_source(module), dict(sorted(_hash_imports(module).items()))


def _read_source(code: ModuleType | type) -> str:
    try:
        source = inspect.getsource(code)
    except (OSError, TypeError):
        return UNKNOWN
    return blake2b(source.encode(), digest_size=8).hexdigest()


def _hash_imports(module: ModuleType) -> dict[str, str]:
    """Return name -> hash of each module of the user that `module` imports, also indirectly."""
    hashes: dict[str, str] = {}
    waiting = [(module.__name__, _file_of(module.__name__))]
    package = module.__name__.partition(".")[0]
    while waiting:
        importer, file = waiting.pop()
        for name in _find_imports(importer, file):
            imported = _file_of(name)
            if name in hashes or name == module.__name__ or not _is_users(name, imported, package):
                continue
            hashes[name] = _hash_file(imported)
            waiting.append((name, imported))
    return hashes


def _find_imports(name: str, file: Path | None) -> Iterator[str]:
    """Yield the names of the modules that a source file imports, also inside functions.

    `name` is the name of the module that the file defines. Some of the yielded names may belong to
    functions or classes. No name is yielded if the file is None or no readable Python source.
    """
    if file is None or file.suffix != ".py":
        return
    try:
        tree = ast.parse(file.read_bytes())
    except (OSError, SyntaxError, ValueError):
        return
    package = name if file.name == "__init__.py" else name.rpartition(".")[0]
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            parts = package.split(".")[: 1 - node.level or None] if node.level else []
            base = ".".join([*parts, *([node.module] if node.module else [])])
            yield base
            # `from package import name`: the name may be a module
            yield from (f"{base}.{alias.name}" for alias in node.names)


def _file_of(name: str) -> Path | None:
    """Return the file of the module `name`; None if there is no such module, or it has no file."""
    try:
        spec = importlib.util.find_spec(name)
    except (ImportError, AttributeError, ValueError):
        return None
    return Path(spec.origin) if spec is not None and spec.has_location and spec.origin else None


def _is_users(name: str, file: Path | None, package: str) -> bool:
    """Return whether the module `name`, defined in `file`, is the user's own code.

    A module in the top-level package `package` is the user's, and so is a module that is not
    installed. Modules of Python's standard library, modules of owtsweep, and modules without a file
    are never the user's.
    """
    top = name.partition(".")[0]
    if file is None or top in sys.stdlib_module_names or top == "owtsweep":
        return False
    installed = [Path(sysconfig.get_path(kind)) for kind in ("purelib", "platlib")]
    return top == package or not any(file.is_relative_to(folder) for folder in installed)


def _hash_file(file: Path | None) -> str:
    try:
        return blake2b(file.read_bytes(), digest_size=8).hexdigest() if file else UNKNOWN
    except OSError:
        return UNKNOWN
