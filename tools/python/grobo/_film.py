# SPDX-License-Identifier: MIT
"""Films of a body: animated PNG and strips of frames without any other package; or ffmpeg."""

import importlib
import os
import shutil
import struct
import subprocess
import zlib
from typing import Any, List, Optional

SIGNATURE = b"\x89PNG\r\n\x1a\n"
RATE_HZ = 25
STRIP = 6  # frames


def _chunk(kind: bytes, data: bytes) -> bytes:
    sum_ = zlib.crc32(kind + data)
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", sum_)


def _header(image: Any) -> bytes:
    height, width = image.shape[:2]
    return SIGNATURE + _chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))


def _pixels(image: Any) -> bytes:
    """Rows, each filtered by what is above it."""
    numpy: Any = importlib.import_module("numpy")
    rows = image.reshape(image.shape[0], -1)
    above = numpy.vstack([numpy.zeros_like(rows[:1]), rows[:-1]])
    filtered = (rows.astype(numpy.int16) - above).astype(numpy.uint8)
    marked = numpy.hstack([numpy.full((len(rows), 1), 2, numpy.uint8), filtered])
    return zlib.compress(marked.tobytes(), 9)


def png(image: Any) -> bytes:
    """A picture: rows of pixels of three bytes."""
    return _header(image) + _chunk(b"IDAT", _pixels(image)) + _chunk(b"IEND", b"")


def animated(frames: List[Any], rate_hz: int) -> bytes:
    """An animated PNG, which browsers play."""
    height, width = frames[0].shape[:2]
    out, order = _header(frames[0]) + _chunk(b"acTL", struct.pack(">II", len(frames), 0)), 0
    for n, frame in enumerate(frames):
        control = struct.pack(">IIIIIHHBB", order, width, height, 0, 0, 1, rate_hz, 0, 0)
        out, order = out + _chunk(b"fcTL", control), order + 1
        if n == 0:
            out += _chunk(b"IDAT", _pixels(frame))
        else:
            out, order = out + _chunk(b"fdAT", struct.pack(">I", order) + _pixels(frame)), order + 1
    return out + _chunk(b"IEND", b"")


class Film:
    """What a camera that follows the base has seen, RATE_HZ frames a second of its time."""

    def __init__(self, body: Any, width: int = 240, height: int = 240) -> None:
        mujoco = body.mujoco
        self.frames: List[Any] = []
        self._next = 0.0
        try:
            body.model.vis.headlight.ambient[:] = 0.35
            body.model.vis.headlight.diffuse[:] = 0.6
            self._renderer = mujoco.Renderer(body.model, height, width)
        except Exception as bad:  # of OpenGL, whatever it is called there
            raise RuntimeError(f"no pictures: {bad}; try MUJOCO_GL=egl or MUJOCO_GL=osmesa") from bad
        self._camera = mujoco.MjvCamera()
        self._camera.type = mujoco.mjtCamera.mjCAMERA_FREE
        size = float(body.model.stat.extent)
        self._camera.distance = 0.6 if body.base >= 0 else 1.5 * size
        self._camera.azimuth, self._camera.elevation = 150, -18

    def look(self, body: Any) -> None:
        """Takes a frame where one is due."""
        if body.data.time < self._next:
            return
        self._next = body.data.time + 1 / RATE_HZ
        at = body.base if body.base >= 0 else body.model.nbody - 1
        self._camera.lookat[:] = body.data.xpos[at]
        self._camera.lookat[2] = max(0.08, min(0.14, self._camera.lookat[2]))
        self._renderer.update_scene(body.data, self._camera)
        self.frames.append(self._renderer.render().copy())

    def save(self, video: Optional[str], strip: Optional[str]) -> None:
        if not self.frames:
            raise RuntimeError("no pictures: nothing happened")
        if strip:
            self._save_strip(strip)
        if video and video.endswith(".png"):
            with open(video, "wb") as file:
                file.write(animated(self.frames, RATE_HZ))
        elif video:
            self._encode(video)

    def _save_strip(self, path: str) -> None:
        numpy: Any = importlib.import_module("numpy")
        last = len(self.frames) - 1
        chosen = [self.frames[round(n * last / (STRIP - 1))] for n in range(STRIP)]
        with open(path, "wb") as file:
            file.write(png(numpy.hstack(chosen)))

    def _encode(self, path: str) -> None:
        program = shutil.which("ffmpeg")
        if not program:
            raise RuntimeError(f"{os.path.basename(path)}: ffmpeg is missing; .png needs nothing")
        height, width = self.frames[0].shape[:2]
        command = [program, "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24",
                   "-s", f"{width}x{height}", "-r", str(RATE_HZ), "-i", "-", "-pix_fmt", "yuv420p",
                   path]
        data = b"".join(frame.tobytes() for frame in self.frames)
        if subprocess.run(command, input=data, check=False).returncode != 0:
            raise RuntimeError(f"{path}: ffmpeg could not write it")
