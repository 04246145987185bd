"""The robot for programs with asyncio.

::

    async with rsapien.aio.Robot.virtual() as robot:
        await robot.init()
        outcome = await robot.play("walk-forward")

Each call runs in a thread of its own and leaves the event loop free; cancelling the task that waits for it
stops the motors first.
"""

from __future__ import annotations

import asyncio
from types import TracebackType
from typing import Any, AsyncIterator, Callable, Optional

from rsapien import _rsapien

__all__ = ["Robot"]


class Robot:
    """A robot whose requests are awaited. Made by :meth:`open` or :meth:`virtual`."""

    def __init__(self, robot: _rsapien.Robot) -> None:
        self._robot = robot

    @staticmethod
    def open(link: str = "auto", **options: Any) -> _Opening:
        """As ``rsapien.Robot.open``; await it, or use it in ``async with``."""
        return _Opening(lambda: _rsapien.Robot.open(link, **options))

    @staticmethod
    def virtual(**options: Any) -> _Opening:
        """As ``rsapien.Robot.virtual``; await it, or use it in ``async with``."""
        return _Opening(lambda: _rsapien.Robot.virtual(**options))

    def record(self, path: Any, *, force: bool = False) -> _rsapien.Recorder:
        """As ``rsapien.Robot.record``; in a plain ``with``."""
        return self._robot.record(path, force=force)

    async def init(self) -> None:
        """Robot initialisation."""
        await self._run(self._robot.init)

    async def play(self, action: Any, **options: Any) -> _rsapien.Outcome:
        """As ``rsapien.Robot.play``. ``on_progress`` and ``on_admission`` are called in the event loop."""
        for name in ("on_progress", "on_admission"):
            if options.get(name) is not None:
                options[name] = _in_loop(options[name])
        return await self._run(lambda: self._robot.play(action, **options))

    async def do(self, *steps: str, **options: Any) -> _rsapien.Outcome:
        """As ``rsapien.Robot.do``."""
        return await self._run(lambda: self._robot.do(*steps, **options))

    def pause(self) -> None:
        """Pauses what is played at the end of a step, until :meth:`resume`."""
        self._robot.pause()

    def resume(self) -> None:
        """Lets what is paused go on."""
        self._robot.resume()

    async def look(self, pan: float, tilt: float, *, speed: int = 0) -> tuple[float, float]:
        """As ``rsapien.Robot.look``."""
        return await self._run(lambda: self._robot.look(pan, tilt, speed=speed))

    async def state(self) -> Any:
        """As ``rsapien.Robot.state``."""
        return await asyncio.to_thread(self._robot.state)

    async def states(self, every_ms: int = 100) -> AsyncIterator[Any]:
        """The state, again and again, until the loop over it ends."""
        while True:
            yield await self.state()
            await asyncio.to_thread(self._robot.sleep, every_ms)

    async def sleep(self, ms: int) -> None:
        """Waits on the robot's clock."""
        await asyncio.to_thread(self._robot.sleep, ms)

    async def stop(self) -> None:
        """All motors off, now."""
        await asyncio.to_thread(self._robot.stop)

    async def close(self) -> None:
        """Stops the motors and lets go."""
        await asyncio.to_thread(self._robot.close)

    async def __aenter__(self) -> Robot:
        return self

    async def __aexit__(
        self,
        kind: Optional[type[BaseException]],
        error: Optional[BaseException],
        traceback: Optional[TracebackType],
    ) -> None:
        await self.close()

    async def _run(self, work: Callable[[], Any]) -> Any:
        running = asyncio.ensure_future(asyncio.to_thread(work))
        try:
            return await asyncio.shield(running)
        except asyncio.CancelledError:
            await asyncio.to_thread(self._robot.stop)
            # The call ends by itself now that the robot has stopped; what it tells has no reader.
            await asyncio.wait([running])
            running.exception()
            raise


class _Opening:
    def __init__(self, make: Callable[[], _rsapien.Robot]) -> None:
        self._make = make
        self._robot: Optional[Robot] = None

    def __await__(self) -> Any:
        return self._open().__await__()

    async def _open(self) -> Robot:
        return Robot(await asyncio.to_thread(self._make))

    async def __aenter__(self) -> Robot:
        self._robot = await self._open()
        return self._robot

    async def __aexit__(self, *error: Any) -> None:
        if self._robot is not None:
            await self._robot.close()


def _in_loop(callback: Callable[..., object]) -> Callable[..., None]:
    loop = asyncio.get_running_loop()

    def tell(*progress: Any) -> None:
        loop.call_soon_threadsafe(callback, *progress)

    return tell
