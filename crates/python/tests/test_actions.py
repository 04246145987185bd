"""Actions built in code, seen, checked and played."""

import asyncio
import threading
from xml.dom import minidom

import pytest

import rsapien
from rsapien import Action


def greet():
    action = Action("greet", description='Says "hello".', tags=["greeting", "test"])
    action.parameter("rounds", 2).parameter("hold", 300, ms=True)
    action.on("feet", then="end")
    action.do("right-arm-up", "right-hand-open")
    action.label("waving")
    with action.repeat("rounds"):
        action.do("right-arm-front", ms=650).do("right-arm-up", ms=700)
    with action.together():
        with action.track():
            action.do("tilt-left").do("tilt-mid", ms=300)
        with action.track():
            action.wait("hold").do("left-arm-up")
    with action.mirror(), action.speed(0.5):
        action.do("left-leg-front")
    action.wait_for("right-hand", at_most_ms=500)
    action.play("wave", rounds=1, mirrored=True, speed=0.8, times=1)
    return action.play("stand")


def test_an_action_built_in_code_is_the_text_one_would_write():
    action = greet()
    assert [finding.rule for finding in action.check()] == ["needs-the-pc"]
    assert action.allow("needs-the-pc", "a test").check() == []
    assert action.text.startswith("action greet(rounds = 2, hold = 300ms) {")
    again = Action.parse(action.text)
    assert (again.name, again.text) == ("greet", action.text)
    with pytest.raises(ValueError, match="read from a text"):
        again.wait(5)
    with pytest.raises(rsapien.ActionRefused):
        Action.parse("action one { wait 1s } action two { wait 1s }")


def test_findings_have_a_place():
    turns = Action("turns").play("pivot-left", times=3, arguments={"times": 2})
    assert "play pivot-left(times = 2) times 3" in turns.text
    assert [finding.rule for finding in turns.check()] == ["needs-the-pc"]
    (finding,) = Action("nod").do("tilt-left", ms=300).do("tilt-right").check()
    assert (finding.rule, finding.line, finding.severity) == ("too-short", 2, "error")
    assert "200 ms more" in finding.help


def test_a_timeline_is_a_picture_and_numbers():
    timeline = greet().timeline(rounds=3)
    document = minidom.parseString(timeline.svg(title="A & B", description="<what>"))
    assert document.documentElement.tagName == "svg"
    assert minidom.parseString(greet()._repr_svg_())
    assert Action("nonsense").do("no-such")._repr_svg_() is None
    assert "right-arm" in str(timeline) and "waving" in timeline.text(80)
    movements = [it for it in timeline.movements() if it["joint"] == "right-arm"]
    assert movements[0]["to_place"] == 0.0 and movements[0]["target"] == "up"
    assert timeline.duration_ms > 3 * 1350
    assert timeline.labels == [(1150, "waving")]


def test_an_action_is_played_with_arguments_and_from_a_label(tmp_path):
    registry = rsapien.Registry(tmp_path / "registry.sqlite")
    action = greet().allow("needs-the-pc", "a test")
    told = []
    with rsapien.Robot.virtual(fast=True) as robot:
        robot.init()
        outcome = robot.play(action, arguments={"rounds": 1, "hold": "0.2s"}, on_progress=lambda *it: told.append(it))
        assert outcome and outcome.steps_ended == outcome.steps_total == told[-1][0]
        assert outcome.reached is None and outcome.instead is None
        assert registry.save(action)["added"] == ["greet"]
        later = robot.play("greet", registry=registry, from_label="waving")
        assert later.steps_total == 4 + 4 + 1 + 4 + 1
        vain = robot.play(Action("patience").wait_for("any", at_most_ms=100, otherwise="play stand"))
        assert not vain and vain.kind == "interrupted" and vain.instead
        assert vain.reached == ("patience", 1)
        with pytest.raises(rsapien.ActionRefused, match="round"):
            robot.play("wave", arguments={"round": 1})
        states = robot.states(every_ms=50)
        first, second = next(states), next(states)
        assert first.keys() == second.keys()


def test_asyncio_plays_tells_progress_in_the_loop_and_stops_when_cancelled():
    async def play():
        threads = []
        async with rsapien.aio.Robot.virtual(fast=True) as robot:
            await robot.init()
            outcome = await robot.play("wave", on_progress=lambda *_: threads.append(threading.get_ident()))
            assert outcome
            assert set(threads) == {threading.get_ident()}
            async for state in robot.states(every_ms=10):
                assert state["mode"] == "idle"
                break
        async with rsapien.aio.Robot.virtual() as robot:
            await robot.init()
            dancing = asyncio.ensure_future(robot.play("dance"))
            await asyncio.sleep(0.5)
            dancing.cancel()
            with pytest.raises(asyncio.CancelledError):
                await dancing
            state = await robot.state()
            assert state["mode"] == "stopped", state

    asyncio.run(play())
