"""RoboRegistry from Python."""

import sqlite3

import pytest

import rsapien

NOD = """# Yes.
action nod(rounds = 2) {
    description "To the left and twice to the right."
    tags test
    do tilt-left for 500ms
    repeat rounds { do tilt-right for 700ms }
}"""


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
    assert registry.check(NOD) == []
    assert registry.import_text(NOD)["added"] == ["nod"]
    assert registry.steps("nod") == [(["tilt-left"], 500), (["tilt-right"], 700), (["tilt-right"], 700)]
    assert len(registry.steps("nod", arguments={"rounds": 5})) == 6
    assert registry.text("nod") == NOD
    with pytest.raises(rsapien.RegistryError, match="nod"):
        registry.import_text(NOD.replace("500", "600"))
    registry.import_text(NOD.replace("500", "600"), replace=True)
    assert [version["version"] for version in registry.history("nod")] == [1, 2]
    assert registry.restore("nod", 1) == 3
    assert registry.text("nod") == NOD
    other = rsapien.Registry(tmp_path / "other.sqlite")
    other.import_text(registry.export_text("nod"))
    assert other.steps("nod") == registry.steps("nod")
    other.remove("nod")
    with pytest.raises(rsapien.UnknownAction):
        other.steps("nod")
    registry.backup(tmp_path / "copy.sqlite")
    assert rsapien.Registry(tmp_path / "copy.sqlite").text("nod") == NOD
    assert registry.verify() == []


def test_search(registry):
    assert registry.search("wave left")[0]["name"] == "wave-left"
    assert {found["name"] for found in registry.search(tags=["hands"], longest_ms=475)} == {
        "grip-left",
        "grip-right",
        "release-left",
        "release-right",
    }
    (found,) = registry.search("bow", joints=["left-leg"])
    assert registry.text("#" + found["content_hash"][:12]).startswith("action bow")
    with pytest.raises(ValueError, match="right-arm"):
        registry.search(joints=["head"])


def test_what_is_wrong_is_named(registry):
    wrong = NOD.replace("do tilt-left", "do tilt-left + tilt-right")
    (finding,) = registry.check(wrong)
    assert (finding.severity, finding.rule, finding.line) == ("error", "joint-two-ways", 5)
    assert finding.action == "nod" and "two steps" in finding.help
    assert "^^^^" in str(finding)
    with pytest.raises(rsapien.ActionRefused, match="joint-two-ways"):
        registry.import_text(wrong)
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


def test_bundles_go_from_registry_to_registry_and_conflicts_are_told(tmp_path):
    mine, other = (rsapien.Registry(tmp_path / name) for name in ("mine.sqlite", "other.sqlite"))
    mine.save("action greet { do right-arm-up for 1s play stand }")
    path = tmp_path / "greet.rsapien"
    assert sorted(mine.export_bundle(path, "greet")) == ["greet", "stand"]
    plan = other.plan_bundle(path)
    assert plan["added"] == ["greet"] and plan["unchanged"] == ["stand"]
    assert "greet" not in [action["name"] for action in other.actions()]
    assert other.import_bundle(path)["added"] == ["greet"]
    other.save("action greet { do left-arm-up for 1s }", replace=True)
    with pytest.raises(rsapien.RegistryError, match="greet"):
        other.import_bundle(path)
    assert other.import_bundle(path, on_conflict="keep-mine")["conflicts"] == ["greet"]
    assert other.import_bundle(path, on_conflict="rename")["renamed"][0][0] == "greet"
    with pytest.raises(ValueError, match="take-theirs"):
        other.import_bundle(path, on_conflict="merge")
    with pytest.raises(OSError, match="nothing.rsapien"):
        other.import_bundle(tmp_path / "nothing.rsapien")
