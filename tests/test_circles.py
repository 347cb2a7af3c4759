"""No package imports itself through what it holds; import-linter's contract sees siblings only."""

from __future__ import annotations

import grimp


def test_no_package_is_in_a_circle_of_imports() -> None:
    graph = grimp.build_graph("owtsweep", cache_dir=None)
    packages = [module for module in graph.modules if graph.find_children(module)]
    circles = [
        f"{package} -> {imported}"
        for package in packages
        for imported in graph.find_modules_directly_imported_by(package)
        if graph.chain_exists(importer=imported, imported=package)
    ]
    assert circles == []
