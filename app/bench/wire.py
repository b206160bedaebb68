"""A page without a browser: sends what a real one would over viser's web socket, and sees when answers left."""

import msgspec
import viser
import zstandard
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from app.object_drawing import Pixel
from rotrecon.camera import transform
from rotrecon.frame import Frame

PICTURE = "/view/picture"
CANVAS_PX = (1280, 720)
LARGEST_MESSAGE = 64 * 2**20
HEADER_BYTES = 16
"""Before each batch: sizes of its message part, expanded and compressed."""


class WirePage:
    """One page on a console that shows a frame."""

    def __init__(self, address: str, client_id: int, frame: Frame) -> None:
        self._frame, self._owner, self.client_id = frame, str(client_id), client_id
        self._socket: ClientConnection = connect(
            address.replace("http", "ws", 1),
            subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
            max_size=LARGEST_MESSAGE,
            compression=None,
        )
        self._send_camera()

    def close(self) -> None:
        """Leave the console."""
        self._socket.close()

    def drag(self, phase: str, start: Pixel, end: Pixel, *, shift: bool = False) -> None:
        """One step of a drag on the picture: start, update or end."""
        self._send(drag_message(self._frame, self._owner, phase, start, end, shift=shift))

    def last_departure_s(self, quiet_s: float) -> float | None:
        """When the last batch left the server, by its performance counter; waits until nothing comes any more."""
        departure: float | None = None
        while True:
            try:
                batch = self._socket.recv(quiet_s)
            except (TimeoutError, ConnectionClosed):
                return departure
            assert isinstance(batch, bytes)
            departure = _departure_s(batch)

    def _send_camera(self) -> None:
        self._send(camera_message())

    def _send(self, message: dict[str, object]) -> None:
        self._socket.send(msgspec.msgpack.encode(message))


def camera_message() -> dict[str, object]:
    """What a page says first."""
    width, height = CANVAS_PX
    return {
        "type": "ViewerCameraMessage",
        "wxyz": (1.0, 0.0, 0.0, 0.0),
        "position": (0.0, 0.0, 0.0),
        "fov": 1.0,
        "near": 0.01,
        "far": 100.0,
        "image_height": height,
        "image_width": width,
        "look_at": (0.0, 0.0, 1.0),
        "up_direction": (0.0, -1.0, 0.0),
    }


def drag_message(
    frame: Frame, owner: str, phase: str, start: Pixel, end: Pixel, *, shift: bool = False
) -> dict[str, object]:
    """One step of a drag on the picture of a page: start, update or end."""
    return {
        "type": "SceneNodeDragMessage",
        "phase": phase,
        "name": PICTURE,
        "instance_index": None,
        "start_position": _point(frame, start),
        "start_screen_pos": (0.0, 0.0),
        "end_position": _point(frame, end),
        "end_screen_pos": (0.0, 0.0),
        "button": "left",
        "modifier": "shift" if shift else None,
        "owner": owner,
    }


def _point(frame: Frame, pixel: Pixel) -> tuple[float, ...]:
    """A point of a pixel's sight line, in base coordinates."""
    return tuple(transform(frame.T_base_camera, frame.camera.unproject(pixel, 1.0)).tolist())


def _departure_s(batch: bytes) -> float:
    compressed = int.from_bytes(batch[8:HEADER_BYTES], "little")
    inner = zstandard.ZstdDecompressor().decompress(batch[HEADER_BYTES : HEADER_BYTES + compressed])
    return float(msgspec.msgpack.decode(inner)["timestampSec"])
