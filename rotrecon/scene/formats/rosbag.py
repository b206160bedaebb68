"""ROS 1 bag files and ROS 2 bag folders: the first PointCloud2 of a topic, and the camera it belongs to."""

from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.highlevel import AnyReader
from rosbags.interfaces import Connection
from rosbags.typesys import Stores, get_typestore

from rotrecon.arrays import Floats
from rotrecon.errors import SceneError
from rotrecon.scene.formats.cloud import RawCloud, make_cloud, unpack_rgb
from rotrecon.scene.formats.source import SourceFile

_CLOUD = "sensor_msgs/msg/PointCloud2"
_CAMERA = "sensor_msgs/msg/CameraInfo"
_POINT_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
"""sensor_msgs/PointField's numbers of types."""


@dataclass(frozen=True, eq=False)
class BagCloud:
    """A cloud out of a bag, and what the bag says of the camera that saw it."""

    cloud: RawCloud
    topic: str
    frame_id: str
    captured_at: datetime | None
    camera_matrices: tuple[Floats, ...]
    """(3, 3) of every camera_info of the cloud's coordinate frame and size: rectified first, then raw."""


def read_bag(source: SourceFile, topic: str | None) -> BagCloud:
    """Read the first cloud of `topic`, which may be None when a single topic has clouds; raises SceneError."""
    if not source.exists:
        raise source.error("names a bag that does not exist", "correct its name")
    try:
        # Bags older than ROS 2 Iron do not carry the definitions of their messages.
        with AnyReader([source.path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
            connection = _choose(source, reader.connections, topic)
            message = _first(reader, connection)
            if message is None:
                raise source.error(f"has no message on {connection.topic}", "name another topic, or record it again")
            cameras = _camera_matrices(reader, message)
        return _arrange(source, connection.topic, message, cameras)
    except SceneError:
        raise
    except Exception as failure:
        raise source.error(
            "is a truncated or damaged bag, or none",
            "give a ROS 1 .bag file or the folder of a ROS 2 bag with its metadata.yaml, or record it again",
        ) from failure


def _choose(source: SourceFile, connections: list[Connection], topic: str | None) -> Connection:
    clouds = {connection.topic: connection for connection in connections if connection.msgtype == _CLOUD}
    known = ", ".join(sorted(clouds))
    if not clouds:
        raise source.error("has no sensor_msgs/PointCloud2", "record the camera's point cloud topic")
    if topic is None and len(clouds) > 1:
        raise source.error(f"has clouds on {known}", "name one of these topics")
    if topic is not None and topic not in clouds:
        raise source.error(f"has no cloud on topic {topic}", f"name one of {known}")
    return clouds[topic] if topic is not None else next(iter(clouds.values()))


def _first(reader: AnyReader, connection: Connection) -> Any:
    for _, _, content in reader.messages(connections=[connection]):
        return reader.deserialize(content, connection.msgtype)
    return None


def _camera_matrices(reader: AnyReader, cloud: Any) -> tuple[Floats, ...]:
    matrices: list[Floats] = []
    for connection in reader.connections:
        camera = _first(reader, connection) if connection.msgtype == _CAMERA else None
        if camera is None or (camera.header.frame_id, camera.height, camera.width) != (
            cloud.header.frame_id,
            cloud.height,
            cloud.width,
        ):
            continue
        # ROS 1 writes the names of these two in capitals.
        rectified = camera.P if hasattr(camera, "P") else camera.p
        raw = camera.K if hasattr(camera, "K") else camera.k
        matrices.append(np.array(rectified, np.float64).reshape(3, 4)[:, :3])
        matrices.append(np.array(raw, np.float64).reshape(3, 3))
    return tuple(matrices)


def _arrange(source: SourceFile, topic: str, message: Any, cameras: tuple[Floats, ...]) -> BagCloud:
    points, colors = _decode(source, message)
    if message.height == 1:
        points, colors = points[0], None if colors is None else colors[0]
    stamp = message.header.stamp
    moment = datetime.fromtimestamp(stamp.sec + stamp.nanosec * 1e-9, UTC) if stamp.sec > 0 else None
    return BagCloud(make_cloud(source, points, colors), topic, message.header.frame_id, moment, cameras)


def _decode(source: SourceFile, message: Any) -> tuple[NDArray[Any], NDArray[Any] | None]:
    """Points (height, width, 3) and colours of a PointCloud2, whose rows and points may be padded."""
    fields = {field.name: field for field in message.fields}
    if not {"x", "y", "z"} <= set(fields):
        raise source.error(f"has a cloud with the fields {', '.join(fields)}", "record one with x, y and z")
    source.check_count(message.height * message.width, "points")
    order = ">" if message.is_bigendian else "<"
    color = next((name for name in ("rgb", "rgba") if name in fields), None)
    # Colours are packed bits, whether the field calls them a float or an integer.
    formats = {name: order + _POINT_TYPES[fields[name].datatype] for name in ("x", "y", "z")}
    if color is not None:
        formats[color] = order + "u4"
    offsets = [fields[name].offset for name in formats]
    layout = np.dtype(
        {
            "names": list(formats),
            "formats": list(formats.values()),
            "offsets": offsets,
            "itemsize": message.point_step,
        }
    )
    rows = message.data[: message.height * message.row_step].reshape(message.height, message.row_step)
    stored = np.ascontiguousarray(rows[:, : message.width * message.point_step]).view(layout)
    points = np.stack([stored["x"], stored["y"], stored["z"]], axis=-1)
    return points, None if color is None else unpack_rgb(stored[color])
