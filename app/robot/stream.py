"""The decision as a stream: the state now, and again whenever it has become another one."""

import asyncio
from collections.abc import Callable
from contextlib import suppress

from starlette.websockets import WebSocket, WebSocketDisconnect

from app.decision import DecisionSource
from app.robot.models import decision_model

RECHECK_S = 5.0
"""How soon a stream ends whose user was removed."""
POLICY_VIOLATION = 1008


async def stream_decision(socket: WebSocket, source: DecisionSource, may_stay: Callable[[], bool]) -> None:
    """Send the decision until the other side leaves or may not stay; whatever it sends is not listened to."""
    changed, loop = asyncio.Event(), asyncio.get_running_loop()
    end = source.subscribe(lambda: loop.call_soon_threadsafe(changed.set))
    leaving = asyncio.create_task(_left(socket))
    sent: str | None = None
    try:
        while not leaving.done() and may_stay():
            changed.clear()
            now = decision_model(await asyncio.to_thread(source.decision)).model_dump_json()
            if now != sent:
                await socket.send_text(now)
                sent = now
            waiting = asyncio.create_task(changed.wait())
            await asyncio.wait({leaving, waiting}, timeout=RECHECK_S, return_when=asyncio.FIRST_COMPLETED)
            waiting.cancel()
        if not leaving.done():
            await socket.close(POLICY_VIOLATION)
    except WebSocketDisconnect:
        pass
    finally:
        end()
        leaving.cancel()
        with suppress(asyncio.CancelledError):
            await leaving


async def _left(socket: WebSocket) -> None:
    while (await socket.receive())["type"] != "websocket.disconnect":
        pass
