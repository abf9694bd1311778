# SPDX-License-Identifier: MIT
"""Motions and traces of the line as MCAP files, for Foxglove, PlotJuggler and rosbag's tools.

    python -m grobo.mcap walk.pseq walk.mcap
    python -m grobo.mcap --robot so101 wave.yaml session.pcapng wave.mcap

It needs the package mcap (`pip install mcap`). Messages are JSON with a schema:

- `/joints`, `grobo.JointAngles`: each posture of a motion at the time when it is reached, from 0 on;
  `angles` are radians by joint, without those that the posture does not set.
- `/line`, `grobo.LineBytes`: each packet of a trace (`--trace`, docs/guide/trace.md) at its time by
  the clock on the wall; `direction` is "sent" or "received", `hex` its bytes.
"""

import argparse
import json
import os
import struct
from dataclasses import dataclass
from typing import Any, Dict, Iterator, List, Tuple, Union

from grobo._lib import version
from grobo.description import Description
from grobo.motion import Motion

Path = Union[str, "os.PathLike[str]"]

JOINT_ANGLES = {
    "title": "grobo.JointAngles",
    "type": "object",
    "properties": {
        "angles": {"type": "object", "additionalProperties": {"type": "number"}},
    },
    "required": ["angles"],
}
LINE_BYTES = {
    "title": "grobo.LineBytes",
    "type": "object",
    "properties": {
        "direction": {"type": "string", "enum": ["sent", "received"]},
        "hex": {"type": "string"},
    },
    "required": ["direction", "hex"],
}

# Of pcapng: draft-ietf-opsawg-pcapng, sections 4.1 to 4.3.
SECTION, INTERFACE, PACKET = 0x0A0D0D0A, 1, 6
BYTE_ORDER = 0x1A2B3C4D
OPTION_FLAGS, OPTION_TSRESOL = 2, 9
OUTBOUND = 2
MOST_BLOCK = 1 << 24


@dataclass
class LinePacket:
    """Bytes of the line, `time` in nanoseconds since 1970."""

    time: int
    sent: bool
    data: bytes


def _options(data: bytes, order: str) -> Dict[int, bytes]:
    found: Dict[int, bytes] = {}
    while len(data) >= 4:
        code, size = struct.unpack_from(order + "HH", data)
        if code == 0 or size > len(data) - 4:
            break
        found[code] = data[4 : 4 + size]
        data = data[4 + (size + 3) // 4 * 4 :]
    return found


def _blocks(data: bytes) -> Iterator[Tuple[int, bytes, str]]:
    order = "<"
    while len(data) >= 12:
        if struct.unpack_from("<I", data)[0] == SECTION:
            order = "<" if struct.unpack_from("<I", data, 8)[0] == BYTE_ORDER else ">"
        kind, size = struct.unpack_from(order + "II", data)
        if size < 12 or size % 4 or size > min(len(data), MOST_BLOCK):
            return  # cut short: a program was killed while it wrote
        yield kind, data[8 : size - 4], order
        data = data[size:]


def packets(path: Path) -> List[LinePacket]:
    """The packets of a trace, pcapng. Raises ValueError where the file is none; one that ends in
    the middle of a packet ends before it."""
    with open(path, "rb") as file:
        data = file.read()
    if data[:4] != struct.pack("<I", SECTION):
        raise ValueError(f"{os.fspath(path)}: is not a pcapng file")
    found: List[LinePacket] = []
    unit = 1000  # nanoseconds of a tick
    for kind, body, order in _blocks(data):
        if kind == INTERFACE and len(body) >= 8:
            resolution = _options(body[8:], order).get(OPTION_TSRESOL, b"\x06")[0]
            unit = 10 ** (9 - resolution) if resolution <= 9 else 1
        elif kind == PACKET and len(body) >= 20:
            _, high, low, size, _ = struct.unpack_from(order + "IIIII", body)
            if size > len(body) - 20:
                return found
            flags = _options(body[20 + (size + 3) // 4 * 4 :], order).get(OPTION_FLAGS, b"\0\0\0\0")
            sent = struct.unpack(order + "I", flags[:4])[0] & 3 == OUTBOUND
            found.append(LinePacket((high << 32 | low) * unit, sent, body[20 : 20 + size]))
    return found


class Writer:
    """An MCAP file that is being written: a context. Each source is a channel of its own."""

    def __init__(self, path: Path) -> None:
        from mcap.writer import Writer as Mcap

        self._file = open(path, "wb")
        self._writer: Any = Mcap(self._file)
        self._writer.start(profile="", library=f"libgrobo {version()}")

    def __enter__(self) -> "Writer":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def close(self) -> None:
        """Writes index and end of the file."""
        if not self._file.closed:
            self._writer.finish()
            self._file.close()

    def _channel(self, topic: str, schema: Dict[str, Any]) -> int:
        number = self._writer.register_schema(
            name=schema["title"], encoding="jsonschema", data=json.dumps(schema).encode()
        )
        return int(
            self._writer.register_channel(topic=topic, message_encoding="json", schema_id=number)
        )

    def _message(self, channel: int, time: int, content: Dict[str, Any]) -> None:
        data = json.dumps(content, allow_nan=False).encode()
        self._writer.add_message(channel_id=channel, log_time=time, publish_time=time, data=data)

    def motion(self, motion: Motion, topic: str = "/joints") -> None:
        """Each posture of a motion, radians by joint, at the time when it is reached."""
        channel = self._channel(topic, JOINT_ANGLES)
        for time, posture in zip(motion.times, motion):
            self._message(channel, round(float(time) * 1e9), {"angles": dict(posture)})

    def trace(self, path: Path, topic: str = "/line") -> None:
        """Each packet of a trace of the line."""
        found = packets(path)
        channel = self._channel(topic, LINE_BYTES)
        for one in found:
            content = {"direction": "sent" if one.sent else "received", "hex": one.data.hex(" ")}
            self._message(channel, one.time, content)


def convert(sources: List[Path], target: Path, robot: Union[str, Description] = "gr001") -> None:
    """Motion files and traces (.pcapng) in one MCAP file. `robot`: whose joints the motions name."""
    described = Description(robot) if not isinstance(robot, Description) else robot
    with Writer(target) as writer:
        for source in sources:
            if os.fspath(source).endswith(".pcapng"):
                writer.trace(source)
            else:
                writer.motion(Motion.load(source, described))


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m grobo.mcap", description=__doc__.split("\n")[0])
    parser.add_argument("sources", nargs="+", metavar="SOURCE", help="motion files, traces (.pcapng)")
    parser.add_argument("target", metavar="TARGET.mcap", help="the file that is written")
    parser.add_argument("--robot", default="gr001", help="a robot's name or file (gr001)")
    given = parser.parse_args()
    convert(given.sources, given.target, given.robot)


if __name__ == "__main__":
    main()
