"""RoboRegistry from Python."""

import sqlite3

import pytest

import rsapien

NOD = """
[[action]]
name = "nod"
description = "Twice to the left and right."
tags = ["test"]
steps = [
    { do = "tilt-left", ms = 500 },
    { do = "tilt-right", ms = 700, times = 2 },
]
"""


@pytest.fixture
def registry(tmp_path):
    return rsapien.Registry(tmp_path / "registry.sqlite")


def test_primitives_are_those_of_table_1():
    names = rsapien.Registry.primitives()
    assert len(names) == 21 and names[0] == "right-arm-up" and names[20] == "left-leg-back"


def test_the_seed_library_is_there(registry):
    names = {action["name"] for action in registry.actions()}
    assert {"stand", "walk-forward", "turn-left", "wave", "pick-up", "throw", "dance"} <= names
    assert registry.steps("wave", times=2) == registry.steps("wave") * 2


def test_import_export_and_versions(registry, tmp_path):
    assert registry.check_toml(NOD) == []
    assert registry.import_toml(NOD)["added"] == ["nod"]
    assert registry.steps("nod") == [(["tilt-left"], 500), (["tilt-right"], 700), (["tilt-right"], 700)]
    with pytest.raises(rsapien.RegistryError, match="nod"):
        registry.import_toml(NOD.replace("500", "600"))
    registry.import_toml(NOD.replace("500", "600"), replace=True)
    assert [version["version"] for version in registry.history("nod")] in ([1, 2], [2, 1])
    other = rsapien.Registry(tmp_path / "other.sqlite")
    other.import_toml(registry.export_toml("nod"))
    assert other.steps("nod") == registry.steps("nod")
    other.remove("nod")
    with pytest.raises(rsapien.UnknownAction):
        other.steps("nod")


def test_what_is_wrong_is_named(registry):
    wrong = NOD.replace('"tilt-left"', '["tilt-left", "tilt-right"]')
    (finding,) = registry.check_toml(wrong)
    assert "nod" in finding and "tilt-left" in finding
    with pytest.raises(rsapien.ActionRefused, match="tilt-left"):
        registry.import_toml(wrong)
    assert "nod" not in {action["name"] for action in registry.actions()}


def test_a_newer_file_and_a_broken_one(tmp_path):
    path = tmp_path / "registry.sqlite"
    rsapien.Registry(path)
    with sqlite3.connect(path) as database:
        database.execute("PRAGMA user_version = 999")
    with pytest.raises(rsapien.RegistryTooNew, match="999"):
        rsapien.Registry(path)
    broken = tmp_path / "broken.sqlite"
    broken.write_bytes(b"not a database" * 500)
    with pytest.raises(rsapien.RegistryError, match="broken.sqlite"):
        rsapien.Registry(broken)
