#!/usr/bin/python3
"""What our meshes are compared with, by Open3D (python3-open3d).

    tests/accuracy/mesh_baselines.py poisson CLOUD.ply MESH.ply [--cell 0.01] [--trim 0.02]
    tests/accuracy/mesh_baselines.py tsdf FRAMES.raw TRAJECTORY.txt MESH.ply [--cell 0.01]

poisson: screened Poisson of a cloud with normals, as deep as the cell asks for; the share `trim` of its vertices that has the least density is cut away.
tsdf: a truncated signed distance, four cells to each side, of all frames of FRAMES.raw (`hermite convert SEQUENCE FRAMES.raw --to raw`) at the poses of
the trajectory (TUM), by marching cubes.
"""
import argparse
import math
import struct
import sys

import numpy as np

from mesh_file import Mesh, read_ply, read_trajectory, write_ply

FARTHEST_M = 5.0  # the noise of a Kinect ends there too
TRUNCATION_CELLS = 4
DEEPEST = 11


def poisson(arguments, o3d):
    read = read_ply(arguments.cloud)
    if read.normals is None or not len(read.vertices):
        sys.exit(f"{arguments.cloud} has no points with normals")
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(read.vertices))
    cloud.normals = o3d.utility.Vector3dVector(read.normals)
    if read.colors is not None:
        cloud.colors = o3d.utility.Vector3dVector(read.colors / 255)
    # The solver's cube is larger than the cloud by this factor.
    side_m = 1.1 * (read.vertices.max(0) - read.vertices.min(0)).max()
    depth = min(DEEPEST, math.ceil(math.log2(side_m / arguments.cell)))
    mesh, density = o3d.geometry.TriangleMesh.create_from_point_cloud_poisson(cloud, depth=depth, n_threads=2)
    mesh.remove_vertices_by_mask(np.asarray(density) < np.quantile(np.asarray(density), arguments.trim))
    return mesh


def tsdf(arguments, o3d):
    volume = o3d.pipelines.integration.ScalableTSDFVolume(arguments.cell, TRUNCATION_CELLS * arguments.cell,
                                                          o3d.pipelines.integration.TSDFVolumeColorType.RGB8)
    times_s, poses = read_trajectory(arguments.trajectory)
    poses = dict(zip(np.round(times_s, 4), poses))
    used = 0
    with open(arguments.frames, "rb") as file:
        (width, height, count), camera, units_per_m = read_head(file)
        intrinsic = o3d.camera.PinholeCameraIntrinsic(width, height, *camera)
        for _ in range(count):
            time_s = struct.unpack("<d", file.read(8))[0]
            depth = np.frombuffer(file.read(2 * width * height), "<u2").reshape(height, width)
            color = np.frombuffer(file.read(3 * width * height), "u1").reshape(height, width, 3)
            pose = poses.get(np.round(time_s, 4))
            if pose is None:  # lost
                continue
            image = o3d.geometry.RGBDImage.create_from_color_and_depth(o3d.geometry.Image(color), o3d.geometry.Image(depth), units_per_m, FARTHEST_M,
                                                                       convert_rgb_to_intensity=False)
            volume.integrate(image, intrinsic, np.linalg.inv(pose))
            used += 1
    if not used:
        sys.exit(f"no frame of {arguments.frames} has a pose in {arguments.trajectory}")
    return volume.extract_triangle_mesh()


def read_head(file):
    """Of core/raw/raw_frames.h: (width, height, count), (fx, fy, cx, cy), depth units per metre."""
    magic, version, width, height, count = struct.unpack("<8sIIII", file.read(24))
    if magic != b"HRMFRAME" or version != 1:
        sys.exit("the frames are no raw frames of version 1, with depth registered to colour")
    numbers = struct.unpack("<10d", file.read(80))
    if any(numbers[5:]):
        sys.exit("the frames have a lens that is not straight")
    return (width, height, count), numbers[:4], numbers[4]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    methods = parser.add_subparsers(required=True)
    of_cloud = methods.add_parser("poisson")
    of_cloud.add_argument("cloud")
    of_cloud.add_argument("--trim", type=float, default=0.02)
    of_cloud.set_defaults(method=poisson)
    of_depth = methods.add_parser("tsdf")
    of_depth.add_argument("frames")
    of_depth.add_argument("trajectory")
    of_depth.set_defaults(method=tsdf)
    for method in (of_cloud, of_depth):
        method.add_argument("mesh")
        method.add_argument("--cell", type=float, default=0.01, help="metres (0.01)")
    arguments = parser.parse_args()
    import open3d as o3d  # pylint: disable=import-outside-toplevel
    mesh = arguments.method(arguments, o3d)
    mesh.compute_vertex_normals()
    write_ply(arguments.mesh, Mesh(np.asarray(mesh.vertices), np.asarray(mesh.triangles), np.asarray(mesh.vertex_normals),
                                   255 * np.asarray(mesh.vertex_colors) if mesh.has_vertex_colors() else None))


if __name__ == "__main__":
    main()
