#!/usr/bin/python3
"""Draws meshes, to be looked at: shaded by a lamp at the camera, and in the colours of their vertices. Needs python3-numpy.

    tests/accuracy/mesh_images.py MESH.ply [MESH.ply...] --out FOLDER [--trajectory trajectory.txt] [--views 6] [--crop X:Y:SIZE]

Views: some along the trajectory (TUM format, in the frame of the mesh), from within; one from above and four from aside, from without, in which
faces that are turned away are left out, so that one looks into a room. Without a trajectory: those from without alone. From within, the back of
a face is red: a flipped face, or the far side of a thin thing. Several meshes are drawn side by side, in the order they are named.
FOLDER/VIEW_shaded.png and FOLDER/VIEW_color.png, VIEW being path00..., above, aside0...
"""
import argparse
import math
import os
import sys

import numpy as np

from mesh_file import read_ply, read_trajectory, write_png

FIELD_OF_VIEW = 62.7  # degrees across, a Kinect's
BACKGROUND = np.array([40, 44, 52])
BACK_OF_FACE = np.array([200, 60, 50])
NEAREST_M = 0.05
MOST_PIXELS = 4_000_000  # of triangles, that are drawn at once


class Drawing:
    """One mesh, ready to be looked at from anywhere."""

    def __init__(self, path):
        mesh = read_ply(path)
        self.vertices, self.triangles = mesh.vertices, mesh.triangles
        if not len(self.triangles) or not np.isfinite(self.vertices).all():
            raise ValueError(f"{path} has no triangles, or vertices that are not finite")
        colors = mesh.colors if mesh.colors is not None else np.full((len(self.vertices), 3), 128.0)
        self.colors = colors[self.triangles].mean(1)  # of a face: they are as small as pixels

    def images(self, window, world_from_camera, without_backs):
        """Shaded and coloured, height x width x 3 each."""
        in_camera = (self.vertices - world_from_camera[:3, 3]) @ world_from_camera[:3, :3]
        chosen = self.triangles[(in_camera[self.triangles, 2] > NEAREST_M).all(1)]
        colors = self.colors[(in_camera[self.triangles, 2] > NEAREST_M).all(1)]
        corners = in_camera[chosen]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        middle = corners.mean(1)
        cosine = -(normal * middle).sum(1) / np.maximum(np.linalg.norm(normal, axis=1) * np.linalg.norm(middle, axis=1), 1e-20)
        nearest = first_triangles(corners, window, cosine > 0 if without_backs else np.ones(len(corners), bool))
        is_hit = nearest >= 0
        light = (0.15 + 0.85 * np.abs(cosine))[:, None]
        lit = np.where((cosine > 0)[:, None], 235.0, BACK_OF_FACE) * light
        images = []
        for of_face in (lit, colors):
            image = np.tile(BACKGROUND, (*nearest.shape, 1))
            image[is_hit] = of_face[nearest[is_hit]]
            images.append(image)
        return images


class Window:
    """Where in the image of a camera of focal length 1 the pixels of an image lie."""

    def __init__(self, width, height, crop=None):
        focal = width / 2 / math.tan(math.radians(FIELD_OF_VIEW / 2))
        left, top, scale = 0, 0, 1.0
        if crop:
            left, top, scale = crop[0], crop[1], height / crop[2]
            middle = (width - 1) / 2, (height - 1) / 2
            width = height
        else:
            middle = (width - 1) / 2, (height - 1) / 2
        self.width, self.height, self.focal = width, height, focal * scale
        self.middle = ((middle[0] - left) * scale, (middle[1] - top) * scale)


def first_triangles(corners, window, is_drawn):
    """Height x width: which of the triangles (in the camera) is the nearest in each pixel, -1 where there is none."""
    inverse = 1 / corners[:, :, 2]
    at = corners[:, :, :2] * inverse[:, :, None] * window.focal + np.array(window.middle)
    low = np.ceil(at.min(1)).astype(np.int64).clip(0, None)
    high = np.minimum(np.floor(at.max(1)).astype(np.int64), [window.width - 1, window.height - 1])
    size = high - low + 1
    which = np.nonzero(is_drawn & (size > 0).all(1))[0]
    best = np.zeros(window.width * window.height)  # inverse depth
    owner = np.full(len(best), -1, np.int64)
    pixels = size[which].prod(1)
    which = which[np.argsort(pixels, kind="stable")]
    ends = np.cumsum(np.sort(pixels, kind="stable"))
    start = 0
    while start < len(which):
        stop = max(start + 1, int(np.searchsorted(ends, (ends[start - 1] if start else 0) + MOST_PIXELS)))
        draw_batch(which[start:stop], (at, inverse, low, size), window, best, owner)
        start = stop
    return owner.reshape(window.height, window.width)


def draw_batch(which, projected, window, best, owner):
    at, inverse, low, size = (array[which] for array in projected)
    counts = size.prod(1)
    row = np.repeat(np.arange(len(which)), counts)
    inside = np.arange(len(row)) - np.repeat(np.cumsum(counts) - counts, counts)
    x, y = low[row, 0] + inside % size[row, 0], low[row, 1] + inside // size[row, 0]
    a, b, c = at[row, 0], at[row, 1], at[row, 2]

    def cross(p, q):
        return (p[:, 0] - x) * (q[:, 1] - y) - (p[:, 1] - y) * (q[:, 0] - x)

    shares = np.stack([cross(b, c), cross(c, a), cross(a, b)], 1)
    area = shares.sum(1)
    is_in = ((shares >= 0).all(1) | (shares <= 0).all(1)) & (area != 0)
    row, pixel = row[is_in], (y * window.width + x)[is_in]
    nearness = (shares[is_in] * inverse[row]).sum(1) / area[is_in]  # inverse depth is linear over the image
    order = np.argsort(nearness, kind="stable")  # the nearest is written last
    order = order[nearness[order] > best[pixel[order]]]
    best[pixel[order]] = nearness[order]
    owner[pixel[order]] = which[row[order]]


def looking(eye, at, up):
    """world_from_camera of a camera at `eye` that looks at `at`."""
    forward = (at - eye) / np.linalg.norm(at - eye)
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = np.stack([right, np.cross(forward, right), forward], 1), eye
    return pose


def views_of(vertices, poses, count):
    """Name, world_from_camera, whether backs are left out."""
    if poses:
        for i, which in enumerate(np.linspace(0, len(poses) - 1, count).round().astype(int)):
            yield f"path{i:02}", poses[which], False
    up = -np.mean([pose[:3, 1] for pose in poses], 0) if poses else np.array([0, -1.0, 0])
    up = np.eye(3)[np.abs(up).argmax()] * np.sign(up[np.abs(up).argmax()])
    low, high = np.percentile(vertices, 1, 0), np.percentile(vertices, 99, 0)
    middle, reach = (low + high) / 2, np.linalg.norm(high - low)
    aside = np.eye(3)[(np.abs(up).argmax() + 1) % 3]
    yield "above", looking(middle + 0.9 * reach * up, middle, aside), True
    for i in range(4):
        turned = math.cos(i * math.pi / 2) * aside + math.sin(i * math.pi / 2) * np.cross(up, aside)
        yield f"aside{i}", looking(middle + reach * (0.75 * turned + 0.4 * up), middle, up), True


def draw_all(paths, out, poses=(), count=6, window=Window(640, 480)):
    drawings = [Drawing(path) for path in paths]
    os.makedirs(out, exist_ok=True)
    for name, pose, without_backs in views_of(drawings[0].vertices, list(poses), count):
        images = [drawing.images(window, pose, without_backs) for drawing in drawings]
        for kind, which in (("shaded", 0), ("color", 1)):
            write_png(os.path.join(out, f"{name}_{kind}.png"), np.concatenate([image[which] for image in images], 1))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", nargs="+", metavar="MESH.ply")
    parser.add_argument("--out", required=True, metavar="FOLDER")
    parser.add_argument("--trajectory", help="TUM format")
    parser.add_argument("--views", type=int, default=6, metavar="COUNT", help="along the trajectory (6)")
    parser.add_argument("--size", default="640x480", help="of one picture in pixels (640x480)")
    parser.add_argument("--crop", metavar="X:Y:SIZE", help="only this square of every picture, in its pixels, enlarged")
    arguments = parser.parse_args()
    size = tuple(int(word) for word in arguments.size.split("x"))
    crop = tuple(int(word) for word in arguments.crop.split(":")) if arguments.crop else None
    poses = read_trajectory(arguments.trajectory)[1] if arguments.trajectory else []
    try:
        draw_all(arguments.meshes, arguments.out, poses, arguments.views, Window(*size, crop))
    except ValueError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
