"""The stubs say what the module has."""

import ast
import inspect
from pathlib import Path

import rsapien
from rsapien import _rsapien


def test_stubs_and_module_have_the_same_names():
    folder = Path(rsapien.__file__).parent
    assert (folder / "py.typed").exists()
    tree = ast.parse((folder / "_rsapien.pyi").read_text())
    typed_dicts = {
        node.name
        for node in tree.body
        if isinstance(node, ast.ClassDef) and any(getattr(base, "id", "") in ("TypedDict", "Protocol") for base in node.bases)
    }
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    compiled = {name for name in dir(_rsapien) if not name.startswith("_")}
    assert compiled == (set(classes) - typed_dicts) | functions
    for name in set(classes) - typed_dicts:
        found = getattr(_rsapien, name)
        if issubclass(found, BaseException):
            continue
        stub = {node.name for node in classes[name].body if isinstance(node, ast.FunctionDef)}
        has = {member for member, _ in inspect.getmembers(found) if not member.startswith("__")}
        assert has == {member for member in stub if not member.startswith("__")}, name
    assert set(rsapien.__all__) - {"__version__", "pose", "aio", "Action"} <= compiled
    assert set(rsapien.pose.__all__) <= compiled
