"""Reads and writes the files that the mesh programs here exchange: binary PLY of triangles or points, trajectories, raw frames, PNG."""
import math
import struct
import zlib

import numpy as np

TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "<i2", "int16": "<i2", "ushort": "<u2", "uint16": "<u2",
         "int": "<i4", "int32": "<i4", "uint": "<u4", "uint32": "<u4", "float": "<f4", "float32": "<f4", "double": "<f8", "float64": "<f8"}


class Mesh:
    """vertices and normals N x 3, colors N x 3 from 0 to 255 (normals and colors None where the file has none), triangles M x 3."""

    def __init__(self, vertices, triangles, normals=None, colors=None):
        self.vertices, self.triangles, self.normals, self.colors = vertices, triangles, normals, colors


def read_ply(path):
    """ValueError in words: not binary little-endian, cut, faces that are no triangles."""
    with open(path, "rb") as file:
        data = file.read()
    end = data.find(b"end_header\n") + len(b"end_header\n")
    if not data.startswith(b"ply") or end < len(b"end_header\n"):
        raise ValueError(f"{path} is no PLY file")
    lines = [line.split() for line in data[:end].decode("ascii", "replace").splitlines()]
    if ["format", "binary_little_endian", "1.0"] not in lines:
        raise ValueError(f"{path} is not binary little-endian")
    found = {}
    for name, count, fields in elements_of(lines):
        dtype = np.dtype(fields)
        if len(data) < end + count * dtype.itemsize:
            raise ValueError(f"{path} is cut at its {name}")
        found[name] = np.frombuffer(data, dtype, count, end)
        end += count * dtype.itemsize

    def columns(*names):
        rows = found["vertex"]
        return np.stack([rows[name] for name in names], 1).astype(np.float64) if names[0] in rows.dtype.names else None

    triangles = np.zeros((0, 3), np.int64)
    if "face" in found and len(found["face"]):
        face = found["face"]
        if (face[face.dtype.names[0]] != 3).any():
            raise ValueError(f"{path} has faces that are no triangles")
        triangles = face["corners"].astype(np.int64)
    return Mesh(columns("x", "y", "z"), triangles, columns("nx", "ny", "nz"), columns("red", "green", "blue"))


def elements_of(header):
    """Name, count and the fields of a row; a list is taken to have three entries."""
    elements = []
    for words in header:
        if words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:2] == ["property", "list"]:
            elements[-1][2].extend([("count of " + words[4], TYPES[words[2]]), ("corners", TYPES[words[3]], 3)])
        elif words[:1] == ["property"]:
            elements[-1][2].append((words[2], TYPES[words[1]]))
    return elements


def write_ply(path, mesh):
    fields, columns = [(name, "<f4") for name in ("x", "y", "z")], [*mesh.vertices.T]
    if mesh.normals is not None:
        fields += [(name, "<f4") for name in ("nx", "ny", "nz")]
        columns += [*mesh.normals.T]
    if mesh.colors is not None:
        fields += [(name, "u1") for name in ("red", "green", "blue")]
        columns += [*np.clip(mesh.colors, 0, 255).astype(np.uint8).T]
    rows = np.zeros(len(mesh.vertices), np.dtype(fields))
    for (name, _), column in zip(fields, columns):
        rows[name] = column
    faces = np.zeros(len(mesh.triangles), np.dtype([("count", "u1"), ("corners", "<i4", 3)]))
    faces["count"], faces["corners"] = 3, mesh.triangles
    words = {"<f4": "float", "u1": "uchar"}
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(rows)}"]
    head += [f"property {words[kind]} {name}" for name, kind in fields]
    head += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header\n"]
    with open(path, "wb") as file:
        file.write("\n".join(head).encode() + rows.tobytes() + faces.tobytes())


def write_png(path, image):
    """`image`: height x width x 3, 0 to 255."""
    rows = np.ascontiguousarray(np.clip(image, 0, 255).astype(np.uint8))
    height, width = rows.shape[:2]

    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    filtered = np.concatenate([np.zeros((height, 1), np.uint8), rows.reshape(height, 3 * width)], 1).tobytes()
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(filtered, 6)) + chunk(b"IEND", b""))


def read_trajectory(path):
    """Times [s] and world_from_camera (4 x 4 each), of a file in the TUM format."""
    times_s, poses = [], []
    with open(path, encoding="utf-8") as text:
        for line in text:
            words = line.split()
            if line.startswith("#") or len(words) < 8:
                continue
            numbers = [float(word) for word in words]
            pose = np.eye(4)
            pose[:3, :3], pose[:3, 3] = rotation_of(*numbers[4:8]), numbers[1:4]
            times_s.append(numbers[0])
            poses.append(pose)
    return times_s, poses


def rotation_of(x, y, z, w):
    norm = math.sqrt(x * x + y * y + z * z + w * w)
    x, y, z, w = x / norm, y / norm, z / norm, w / norm
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
