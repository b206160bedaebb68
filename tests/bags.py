"""A small cloud with its known camera, and ROS bags that hold it."""

from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

from rotrecon.camera import PinholeCamera
from rotrecon.scene.intrinsics import Intrinsics

TRUTH = Intrinsics(50.0, 52.0, 15.25, 11.5)
CAMERA = PinholeCamera(32, 24, TRUTH.K)
TOPIC = "/camera/points"


def depth() -> np.ndarray:
    z = np.random.default_rng(5).uniform(0.5, 1.5, (24, 32)).astype(np.float32)
    z[:3, :5] = np.nan
    return z


def colors() -> np.ndarray:
    return np.random.default_rng(6).integers(0, 256, (24, 32, 3), dtype=np.uint8)


def cloud_message(store: Any, points: np.ndarray, big_endian: bool, frame: str) -> Any:
    """A PointCloud2 with padding between its points and after its rows, as drivers make them."""
    order = ">" if big_endian else "<"
    layout = np.dtype(
        {
            "names": ["x", "y", "z", "rgb"],
            "formats": [f"{order}f4"] * 3 + [f"{order}u4"],
            "offsets": [0, 4, 8, 16],
            "itemsize": 32,
        }
    )
    height, width = points.shape[:2]
    rows = np.zeros((height, width * 32 + 8), np.uint8)
    stored = np.zeros((height, width), layout)
    stored["x"], stored["y"], stored["z"] = np.moveaxis(points, -1, 0)
    red, green, blue = np.moveaxis(colors().astype(np.uint32), -1, 0)
    stored["rgb"] = (np.uint32(255) << np.uint32(24) | red << 16 | green << 8 | blue).reshape(height, width)
    rows[:, : width * 32] = stored.view(np.uint8).reshape(height, width * 32)
    field = store.types["sensor_msgs/msg/PointField"]
    names = [field("x", 0, 7, 1), field("y", 4, 7, 1), field("z", 8, 7, 1), field("rgb", 16, 7, 1)]
    message = store.types["sensor_msgs/msg/PointCloud2"]
    return message(header(store, frame), height, width, names, big_endian, 32, width * 32 + 8, rows.reshape(-1), False)


def header(store: Any, frame: str) -> Any:
    stamp = store.types["builtin_interfaces/msg/Time"](1_700_000_000, 500_000_000)
    kind = store.types["std_msgs/msg/Header"]
    return kind(7, stamp, frame) if "seq" in kind.__dataclass_fields__ else kind(stamp, frame)


def camera_message(store: Any, camera: Intrinsics) -> Any:
    roi = store.types["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, False)
    projection = np.column_stack([camera.K, np.zeros(3)]).reshape(-1)
    raw = Intrinsics(40.0, 40.0, 16.0, 12.0).K.reshape(-1)
    fixed = (np.zeros(5), raw, np.eye(3).reshape(-1), projection)
    return store.types["sensor_msgs/msg/CameraInfo"](header(store, "optical"), 24, 32, "plumb_bob", *fixed, 0, 0, roi)


def write_bag(path: Path, ros: int, points: np.ndarray, *, camera: Intrinsics | None = None, **how: Any) -> Path:
    store = get_typestore(Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_JAZZY)
    pack = store.serialize_ros1 if ros == 1 else store.serialize_cdr
    messages = {
        topic: cloud_message(store, points, how.get("big_endian", False), how.get("frame", "optical"))
        for topic in how.get("topics", (TOPIC,))
    }
    if camera is not None:
        messages["/camera/camera_info"] = camera_message(store, camera)
    storage = how.get("storage", StoragePlugin.SQLITE3)
    with Writer1(path) if ros == 1 else Writer2(path, version=9, storage_plugin=storage) as writer:
        for topic, message in messages.items():
            connection = writer.add_connection(topic, message.__msgtype__, typestore=store)
            writer.write(connection, 1_700_000_000_000_000_000, pack(message, message.__msgtype__))
    return path
