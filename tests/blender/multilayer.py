# SPDX-License-Identifier: GPL-3.0-or-later
"""Rendering with passes, and reading every channel of the file that Blender wrote."""

from __future__ import annotations

import struct
import tempfile
import zlib
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

Channels = dict[str, NDArray[np.float32]]


def render(size: tuple[int, int], engine: str = "SFUMATO") -> Channels:
    """The scene through an engine: each channel (height, width) by its name, as 'ViewLayer.Depth.Z', row 0 at the bottom."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "frame.exr"
        settings = bpy.context.scene.render
        settings.resolution_x, settings.resolution_y = size
        settings.engine, settings.filepath = engine, str(path)
        ask_for_layers(settings)
        bpy.ops.render.render(write_still=True)
        return read(path)


def ask_for_layers(settings: Any) -> None:
    """Have Blender write all layers and passes into one file, uncompressed where it can."""
    images = settings.image_settings
    if hasattr(images, "media_type"):  # 5.0
        images.media_type = "MULTI_LAYER_IMAGE"
    images.file_format = "OPEN_EXR_MULTILAYER"
    images.color_depth, images.exr_codec = "32", "ZIP"


def read(path: Path) -> Channels:
    """An OpenEXR file of whole rows of single precision, compressed by ZIP, in one part or several."""
    data = path.read_bytes()
    version = struct.unpack_from("<I", data, 4)[0]
    several, at, parts = bool(version & 0x1000), 8, []
    while True:
        attributes, at = _header(data, at)
        if not attributes:
            break
        parts.append(attributes)
        if not several:
            break
    counts = []
    for part in parts:
        low, high = part["dataWindow"][1::2]
        counts.append(-(-(high - low + 1) // 16))
    at += 8 * sum(counts)  # offsets of chunks
    out: Channels = {}
    for part in parts:
        left, bottom, right, top = part["dataWindow"]
        for name in part["channels"]:
            out[_whole_name(part, name)] = np.empty((top - bottom + 1, right - left + 1), dtype=np.float32)
    for _ in range(sum(counts)):
        number = 0
        if several:
            number, at = struct.unpack_from("<i", data, at)[0], at + 4
        part = parts[number]
        left, bottom, right, top = part["dataWindow"]
        row, size = struct.unpack_from("<ii", data, at)
        rows, width = min(16, top - row + 1), right - left + 1
        whole = rows * width * 4 * len(part["channels"])
        block = data[at + 8 : at + 8 + size]
        values = np.frombuffer(block if size == whole else _unzip(block), dtype="<f4")
        values = values.reshape(rows, len(part["channels"]), width)
        for number, name in enumerate(part["channels"]):
            out[_whole_name(part, name)][row - bottom : row - bottom + rows] = values[:, number]
        at += 8 + size
    return {name: values[::-1] for name, values in out.items()}


def metadata(path: Path) -> dict[str, str]:
    """The texts in a file's first header."""
    return _header(path.read_bytes(), 8)[0]["texts"]


def _whole_name(part: dict[str, Any], channel: str) -> str:
    name = part["texts"].get("name", "")
    return channel if not name or channel.startswith(name) else f"{name}.{channel}"


def _header(data: bytes, at: int) -> tuple[dict[str, Any], int]:
    """The attributes that we read, and where the header ends; nothing for the one that ends all headers."""
    found: dict[str, Any] = {}
    texts: dict[str, str] = {}
    while data[at]:
        name, at = _text(data, at)
        kind, at = _text(data, at)
        size = struct.unpack_from("<i", data, at)[0]
        value, at = data[at + 4 : at + 4 + size], at + 4 + size
        if kind == "box2i":
            found[name] = struct.unpack("<4i", value)
        elif kind == "chlist":
            found[name], place = [], 0
            while value[place]:
                channel, place = _text(value, place)
                assert struct.unpack_from("<i", value, place)[0] == 2, f"{channel} is not in single precision"
                found[name].append(channel)
                place += 16
        elif kind == "string":
            texts[name] = value.decode()
    return (found | {"texts": texts} if found else {}), at + 1


def _text(data: bytes, at: int) -> tuple[str, int]:
    end = data.index(0, at)
    return data[at:end].decode(), end + 1


def _unzip(block: bytes) -> bytes:
    """OpenEXR's ZIP: differences of bytes, those of even and of odd places apart."""
    steps = np.frombuffer(zlib.decompress(block), dtype=np.uint8).astype(np.int64)
    steps[1:] -= 128
    whole = (np.cumsum(steps) % 256).astype(np.uint8)
    half = (len(whole) + 1) // 2
    out = np.empty_like(whole)
    out[0::2], out[1::2] = whole[:half], whole[half:]
    return out.tobytes()
