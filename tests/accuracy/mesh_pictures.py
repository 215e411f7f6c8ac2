#!/usr/bin/python3
"""Draws meshes, to be looked at: shaded by a lamp at the camera, and in the colours of their vertices. Needs python3-open3d.

    tests/accuracy/mesh_pictures.py MESH.ply [MESH.ply...] --out FOLDER [--trajectory trajectory.txt] [--views 6] [--crop X:Y:SIZE]

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

FIELD_OF_VIEW = 62.7  # degrees across, a Kinect's
BACKGROUND = np.array([40, 44, 52], dtype=np.float32)
BACK_OF_FACE = np.array([200, 60, 50], dtype=np.float32)
MOST_LAYERS = 6  # faces turned away that a ray is let through
PAST_M = 1e-4


class Drawing:
    """One mesh, ready to be looked at from anywhere."""

    def __init__(self, path):
        import open3d as o3d  # pylint: disable=import-outside-toplevel
        mesh = o3d.io.read_triangle_mesh(path)
        self.vertices = np.asarray(mesh.vertices, dtype=np.float32)
        self.triangles = np.asarray(mesh.triangles, dtype=np.uint32)
        if not len(self.triangles) or not np.isfinite(self.vertices).all():
            raise ValueError(f"{path} has no triangles, or vertices that are not finite")
        self.colors = np.asarray(mesh.vertex_colors, dtype=np.float32) * 255
        self.tensor = o3d.core.Tensor
        self.scene = o3d.t.geometry.RaycastingScene()
        self.scene.add_triangles(self.tensor(self.vertices), self.tensor(self.triangles))

    def cast(self, rays):
        """Distance, triangle, place in it, and normal of the face that each of the rays (N x 6) meets."""
        hit = self.scene.cast_rays(self.tensor(np.ascontiguousarray(rays, dtype=np.float32)))
        return [hit[key].numpy() for key in ("t_hit", "primitive_ids", "primitive_uvs", "primitive_normals")]

    def images(self, rays, through_backs):
        """Shaded and coloured, N x 3 each. `through_backs`: faces that are turned away are left out."""
        rays = rays.astype(np.float32).copy()
        shaded, colored = (np.tile(BACKGROUND, (len(rays), 1)) for _ in range(2))
        left = np.arange(len(rays))
        for _ in range(MOST_LAYERS if through_backs else 1):
            distance, triangle, place, normal = self.cast(rays[left])
            hit = np.isfinite(distance)
            left, distance, triangle, place, normal = left[hit], distance[hit], triangle[hit], place[hit], normal[hit]
            direction = rays[left, 3:]
            normal = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
            cosine = -(normal * direction).sum(1) / np.linalg.norm(direction, axis=1)
            front = cosine > 0
            draw = front if through_backs else np.ones_like(front)
            light = (0.15 + 0.85 * np.abs(cosine))[:, None]
            base = np.where(front[:, None], np.float32(235), BACK_OF_FACE)
            shaded[left[draw]] = (base * light)[draw]
            colored[left[draw]] = self.color_at(triangle, place)[draw]
            if not through_backs or front.all():
                break
            rays[left[~front], :3] += (distance[~front] + PAST_M)[:, None] * rays[left[~front], 3:]
            left = left[~front]
        return shaded, colored

    def color_at(self, triangle, place):
        if len(self.colors) != len(self.vertices):
            return np.full((len(triangle), 3), 128, dtype=np.float32)
        corners = self.colors[self.triangles[triangle]]
        weights = np.stack([1 - place.sum(1), place[:, 0], place[:, 1]], 1)
        return (weights[:, :, None] * corners).sum(1)


def rays_of(width, height, world_from_camera):
    """N x 6, row by row; the camera is x right, y down, z forward."""
    focal = width / 2 / math.tan(math.radians(FIELD_OF_VIEW / 2))
    x, y = np.meshgrid((np.arange(width) - (width - 1) / 2) / focal, (np.arange(height) - (height - 1) / 2) / focal)
    directions = np.stack([x.ravel(), y.ravel(), np.ones(width * height)], 1) @ world_from_camera[:3, :3].T
    return np.concatenate([np.broadcast_to(world_from_camera[:3, 3], directions.shape), directions], 1)


def read_trajectory(path):
    """world_from_camera, 4 x 4 each."""
    poses = []
    with open(path, encoding="utf-8") as text:
        for line in text:
            words = line.split()
            if line.startswith("#") or len(words) < 8:
                continue
            numbers = [float(word) for word in words[1:8]]
            pose = np.eye(4)
            pose[:3, :3], pose[:3, 3] = rotation_of(*numbers[3:]), numbers[:3]
            poses.append(pose)
    return poses


def rotation_of(x, y, z, w):
    norm = math.sqrt(x * x + y * y + z * z + w * w)
    x, y, z, w = x / norm, y / norm, z / norm, w / norm
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


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


def write_image(path, rows):
    import open3d as o3d  # pylint: disable=import-outside-toplevel
    if not o3d.io.write_image(path, o3d.geometry.Image(np.ascontiguousarray(rows.clip(0, 255).astype(np.uint8)))):
        sys.exit(f"{path} cannot be written")


def draw_all(paths, out, poses=(), count=6, size=(640, 480), crop=None):
    """`crop`: x, y and side of a square of the image that alone is drawn, as large as the image is high."""
    drawings = [Drawing(path) for path in paths]
    os.makedirs(out, exist_ok=True)
    for name, pose, through_backs in views_of(drawings[0].vertices, list(poses), count):
        rays = rays_of(*size, pose)
        shape = (size[1], size[0])
        if crop:
            x, y, side = crop
            scale = size[1] // side
            large = rays_of(size[0] * scale, size[1] * scale, pose).reshape(size[1] * scale, size[0] * scale, 6)
            part = large[y * scale:(y + side) * scale, x * scale:(x + side) * scale]
            rays, shape = part.reshape(-1, 6), part.shape[:2]
        pictures = [drawing.images(rays, through_backs) for drawing in drawings]
        for kind, which in (("shaded", 0), ("color", 1)):
            write_image(os.path.join(out, f"{name}_{kind}.png"), np.concatenate([p[which].reshape(*shape, 3) for p in pictures], 1))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", nargs="+", metavar="MESH.ply")
    parser.add_argument("--out", required=True, metavar="FOLDER")
    parser.add_argument("--trajectory", help="TUM format")
    parser.add_argument("--views", type=int, default=6, metavar="COUNT", help="along the trajectory (6)")
    parser.add_argument("--size", default="640x480", help="of one picture in pixels (640x480)")
    parser.add_argument("--crop", metavar="X:Y:SIZE", help="only this square of every picture, in its pixels, enlarged")
    arguments = parser.parse_args()
    try:
        import open3d  # pylint: disable=import-outside-toplevel,unused-import
    except ImportError:
        parser.error("open3d is missing: install python3-open3d, and run with Debian's own /usr/bin/python3")
    size = tuple(int(word) for word in arguments.size.split("x"))
    crop = tuple(int(word) for word in arguments.crop.split(":")) if arguments.crop else None
    poses = read_trajectory(arguments.trajectory) if arguments.trajectory else []
    try:
        draw_all(arguments.meshes, arguments.out, poses, arguments.views, size, crop)
    except ValueError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
