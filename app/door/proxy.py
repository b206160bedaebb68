"""Carries messages between a page's web socket and viser's, one way through the guard."""

import asyncio
from collections.abc import Callable
from contextlib import suppress

from starlette.websockets import WebSocket, WebSocketDisconnect
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake
from websockets.typing import Subprotocol

from app.door.guard import Guard
from app.door.hidden_viser import TICKET, HiddenViser, Visit

RECHECK_S = 5.0
"""How soon a page is closed whose pass has run out or whose person was removed."""
NORMAL, POLICY_VIOLATION, TRY_AGAIN_LATER = 1000, 1008, 1013


async def carry(page: WebSocket, visit: Visit, hidden: HiddenViser, guard: Guard, may_stay: Callable[[], bool]) -> None:
    """Accept the page's web socket and carry messages until one side closes, or the visitor may not stay."""
    try:
        upstream = await connect(
            hidden.uri,
            additional_headers={TICKET: visit.ticket},
            subprotocols=[Subprotocol(name) for name in page.scope["subprotocols"]],
            compression=None,
            max_size=None,
            proxy=None,
        )
    except BaseException as error:
        hidden.forget(visit)
        if not isinstance(error, OSError | InvalidHandshake):
            raise
        await page.close(TRY_AGAIN_LATER)
        return
    async with upstream:
        await page.accept(upstream.subprotocol)
        both = (_to_viser(page, upstream, visit, guard), _to_page(page, upstream), _stay(may_stay))
        tasks = [asyncio.create_task(way) for way in both]
        try:
            done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
            code = done.pop().result()
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
        with suppress(RuntimeError, WebSocketDisconnect):  # the page was the one that closed
            await page.close(code)


async def _to_viser(page: WebSocket, upstream: ClientConnection, visit: Visit, guard: Guard) -> int:
    with suppress(WebSocketDisconnect, ConnectionClosed):
        while True:
            message = await page.receive()
            if message["type"] == "websocket.disconnect":
                break
            data = message.get("bytes")
            passed = guard.passed(visit, message.get("text") or "" if data is None else data)
            if passed is not None:
                await upstream.send(passed)
    return NORMAL


async def _to_page(page: WebSocket, upstream: ClientConnection) -> int:
    with suppress(WebSocketDisconnect, ConnectionClosed):
        async for batch in upstream:
            await page.send_bytes(batch if isinstance(batch, bytes) else batch.encode())
    return upstream.close_code or NORMAL


async def _stay(may_stay: Callable[[], bool]) -> int:
    while may_stay():
        await asyncio.sleep(RECHECK_S)
    return POLICY_VIOLATION
