"""What of a user's code enters the key of a block."""

from __future__ import annotations

import importlib
import inspect
import sys
from hashlib import blake2b

import pytest

from owtsweep.sweep.source import UNKNOWN, describe_source, explain_doubt


@pytest.fixture
def load(tmp_path, monkeypatch):
    """Write modules and import the class `Mine` of the first, afresh each time."""
    monkeypatch.syspath_prepend(str(tmp_path))

    def write_and_load(**modules: str) -> type:
        for name, text in modules.items():
            path = tmp_path / f"{name}.py"
            path.parent.mkdir(exist_ok=True)
            path.write_text(text)
        for name in [n for n in sys.modules if n.partition(".")[0].startswith("users")]:
            del sys.modules[name]
        importlib.invalidate_caches()
        name = next(iter(modules)).replace("/", ".")
        return importlib.import_module(name).Mine

    yield write_and_load
    for name in [n for n in sys.modules if n.partition(".")[0].startswith("users")]:
        del sys.modules[name]


ALONE = "import numpy as np\nimport owtsweep\n\nclass Mine:\n    pass\n"


def test_one_readable_module_is_its_source_alone(load):
    mine = load(users_alone=ALONE)
    digest = blake2b(inspect.getsource(sys.modules["users_alone"]).encode(), digest_size=8)
    assert describe_source(mine) == {"source": digest.hexdigest()}
    assert explain_doubt(mine) == ""


@pytest.mark.parametrize(
    "leaning",
    [
        "import users_helper\n\nclass Mine:\n    pass\n",
        "class Mine:\n    def start(self):\n        from users_helper import gain\n",
        "import users_between\n\nclass Mine:\n    pass\n",
    ],
)
def test_an_edit_of_a_module_behind_it_shows(load, leaning):
    others = {"users_between": "from users_helper import gain\n"}
    before = describe_source(load(users_mine=leaning, users_helper="gain = 1\n", **others))
    after = describe_source(load(users_mine=leaning, users_helper="gain = 2\n", **others))
    assert before["source"] == after["source"]
    assert before["modules"]["users_helper"] != after["modules"]["users_helper"]


def test_relative_imports_within_a_package_show(load):
    text = "from . import helper\nfrom .other import gain\n\nclass Mine:\n    pass\n"
    package = {"users/helper": "", "users/other": "gain = 1\n", "users/__init__": ""}
    described = describe_source(load(**{"users/mine": text}, **package))
    assert set(described["modules"]) == {"users", "users.helper", "users.other"}


def test_circles_end(load):
    described = describe_source(
        load(users_a="import users_b\n\nclass Mine:\n    pass\n", users_b="import users_a\n")
    )
    assert set(described["modules"]) == {"users_b"}


def test_what_cannot_be_read_is_doubted_unless_it_has_a_version():
    class_of_a_notebook = type("Mine", (), {"__module__": "a_notebook"})
    assert describe_source(class_of_a_notebook) == {"source": UNKNOWN}
    assert "version = ..." in explain_doubt(class_of_a_notebook)
    assert describe_source(class_of_a_notebook, 2) == {"source": UNKNOWN, "version": "2"}
    assert explain_doubt(class_of_a_notebook, 2) == ""
