#!/usr/bin/python3
"""What a mesh of many surfels takes. A measurement, no test. Needs python3-numpy.

    mesh_memory.py path/to/hermite [--rooms 1 4 14]

Makes clouds of rooms of 4 x 4 x 2.5 m side by side, 720 000 surfels each, a centimetre apart, with bumps and a millimetre of noise; runs `hermite mesh`
on each and prints Markdown: points, triangles, bytes of the points' file, peak of resident memory, processor time, and the digest of the mesh, by which
two programs are compared.
"""
import argparse
import hashlib
import json
import os
import subprocess
import tempfile

import numpy as np

SPACING_M, WIDTH_M, HEIGHT_M, APART_M = 0.01, 4.0, 2.5, 5.0
FLOATS = ("confidence", "curvature_max", "curvature_min", "radius")
SURFEL = np.dtype([(name, "<f4") for name in ("x", "y", "z", "nx", "ny", "nz")] + [(name, "u1") for name in ("red", "green", "blue")] +
                  [(name, "<f4") for name in FLOATS] + [("submap", "<u4")])
TYPES = {"<f4": "float", "|u1": "uchar", "<u4": "uint"}


def side(corner, u, v, lengths, normal):
    a, b = (np.arange(SPACING_M / 2, length, SPACING_M) for length in lengths)
    a, b = (axis.ravel()[:, None] for axis in np.meshgrid(a, b))
    points = corner + a * u + b * v + 0.01 * np.sin(7 * a) * np.cos(5 * b) * normal
    return points, np.broadcast_to(normal, points.shape)


def room(corner, rng):
    x, y, z = np.eye(3)
    flat, upright = (WIDTH_M, WIDTH_M), (WIDTH_M, HEIGHT_M)
    sides = [side(corner, x, y, flat, z), side(corner + HEIGHT_M * z, x, y, flat, -z),
             side(corner, x, z, upright, y), side(corner + WIDTH_M * y, x, z, upright, -y),
             side(corner, y, z, upright, x), side(corner + WIDTH_M * x, y, z, upright, -x)]
    points, normals = (np.concatenate(part) for part in zip(*sides))
    points = points + rng.normal(0, 0.001, points.shape) + rng.uniform(-0.003, 0.003, points.shape) * (1 - abs(normals))
    surfels = np.zeros(len(points), SURFEL)
    for axis, name in enumerate("xyz"):
        surfels[name], surfels["n" + name] = points[:, axis], normals[:, axis]
    surfels["red"], surfels["green"], surfels["blue"], surfels["confidence"], surfels["radius"] = 128, 100, 90, 8, 0.02
    return surfels


def write_rooms(path, count):
    rng, across = np.random.default_rng(1), int(np.ceil(np.sqrt(count)))
    rooms = np.concatenate([room(np.array([APART_M * (i % across), APART_M * (i // across), 0]), rng) for i in range(count)])
    header = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(rooms)
    header += "".join("property %s %s\n" % (TYPES[SURFEL[name].str], name) for name in SURFEL.names) + "end_header\n"
    with open(path, "wb") as file:
        file.write(header.encode() + rooms.tobytes())


def measure(command):
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    said = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise SystemExit("%s ended with %d" % (" ".join(command), status))
    return json.loads(said), usage


def digest_of(path):
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()[:16]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("hermite")
    parser.add_argument("--rooms", type=int, nargs="+", default=[1, 4, 14])
    arguments = parser.parse_args()
    print("| surfels | triangles | surfels.ply, MiB | peak, MiB | processor, s | mesh |\n|---|---|---|---|---|---|")
    for count in arguments.rooms:
        with tempfile.TemporaryDirectory() as folder:
            points, mesh = os.path.join(folder, "surfels.ply"), os.path.join(folder, "mesh.ply")
            write_rooms(points, count)
            made, usage = measure([arguments.hermite, "mesh", points, "--out", mesh])
            print("| %d | %d | %d | %d | %.0f | %s |" % (made["points"], made["triangles"], os.path.getsize(points) >> 20, usage.ru_maxrss >> 10,
                                                       usage.ru_utime + usage.ru_stime, digest_of(mesh)), flush=True)


if __name__ == "__main__":
    main()
