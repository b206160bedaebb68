"""Many pages in a process of their own, of which the first draws; told by its standard input what to send.

Each line is a JSON list of messages, base64: the moves of a drag, and its release; or an empty one, to ask again when
all that has come of it is on its way. The answer to it is a line with a JSON object: seconds from the release to the
last message that any page has got, and how many bytes all have got.
"""

import asyncio
import json
import sys
import time
from base64 import b64decode

import msgspec
import viser
from websockets.asyncio.client import ClientConnection, connect
from websockets.typing import Subprotocol

from app.bench.wire import camera_message

MOVE_S = 1 / 60
QUIET_S = 0.4
"""Nothing got by any page for so long: there is nothing more to come."""


class Crowd:
    """Open pages, and when the last message came."""

    def __init__(self) -> None:
        self.pages: list[ClientConnection] = []
        self.released_s = self.last_s = time.perf_counter()
        self.bytes = self.before = 0

    async def listen(self, page: ClientConnection) -> None:
        async for batch in page:
            self.last_s, self.bytes = time.perf_counter(), self.bytes + len(batch)

    async def quiet(self) -> None:
        """Return when nothing has come for a while."""
        while (left_s := self.last_s + QUIET_S - time.perf_counter()) > 0:
            await asyncio.sleep(left_s)

    async def drag(self, *moves: bytes, release: bytes) -> None:
        """Move the pointer and let go when nothing comes any more."""
        for move in moves:
            await self.pages[0].send(move)
            await asyncio.sleep(MOVE_S)
        await self.quiet()
        self.before = self.bytes
        self.released_s = self.last_s = time.perf_counter()
        await self.pages[0].send(release)


async def main(address: str, cookie: str, count: int) -> None:
    """Open the pages one after the other, say so, and drag as told until the input ends."""
    crowd = Crowd()
    for _ in range(count):
        page = await connect(
            address.replace("http", "ws", 1),
            additional_headers={"Cookie": cookie, "Origin": address},
            subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
            compression=None,
            max_size=None,
            proxy=None,
        )
        crowd.pages.append(page)
        await page.send(msgspec.msgpack.encode(camera_message()))
    listening = [asyncio.create_task(crowd.listen(page)) for page in crowd.pages]
    _say("open")
    while line := await asyncio.to_thread(sys.stdin.readline):
        messages = [b64decode(message) for message in json.loads(line)]
        if messages:
            await crowd.drag(*messages[:-1], release=messages[-1])
        await crowd.quiet()
        _say({"seconds": crowd.last_s - crowd.released_s, "bytes": crowd.bytes - crowd.before})
    for page in crowd.pages:
        await page.close()
    await asyncio.gather(*listening)


def _say(what: object) -> None:
    sys.stdout.write(json.dumps(what) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1], sys.argv[2], int(sys.argv[3])))
