#!/usr/bin/python3
"""What `hermite export` makes of a result, read back by nothing but the formats' own rules, and what it says of results that are none.

    export_test.py path/to/hermite
"""
import json
import os
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

HERMITE = sys.argv[1]
RECORDING = "synthetic:frames=4,width=64,height=64"
CLOUD = (("x", "y", "z", "nx", "ny", "nz"), ("confidence", "curvature_max", "curvature_min", "radius"))
POINTS = [(0.01 * i, -0.02 * i, 1 + 0.001 * i) for i in range(40)]
ALL = "glb glb-draco obj ply stl points-ply las points-glb splats tum kitti log colmap nerfstudio".split()


def cloud_ply(points, normals=None):
    header = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(points)
    header += "".join("property float %s\n" % name for name in CLOUD[0])
    header += "".join("property uchar %s\n" % name for name in ("red", "green", "blue"))
    header += "".join("property float %s\n" % name for name in CLOUD[1]) + "property uint submap\nend_header\n"
    return header.encode() + b"".join(struct.pack("<6f3B4fI", *p, *n, 10, 20, 255, 12.5, 40, -3, 0.004, 7)
                                      for p, n in zip(points, normals or [(0.0, 0.6, -0.8)] * len(points)))


def room_ply(width, depth, height, step=0.02):
    """A room in the axes of the first camera: y down, the floor one and a half metres below it."""
    def steps(length):
        return [step * (i + 0.5) for i in range(round(length / step))]
    surface = [((x, 1.5 - h, z), (0, 0, n)) for h in steps(height) for z, n in ((0, 1), (depth, -1)) for x in steps(width)]
    surface += [((x, 1.5 - h, z), (n, 0, 0)) for h in steps(height) for x, n in ((0, 1), (width, -1)) for z in steps(depth)]
    surface += [((x, y, z), (0, n, 0)) for y, n in ((1.5, -1), (1.5 - height, 1)) for x in steps(width) for z in steps(depth)]
    return cloud_ply([point for point, _ in surface], [normal for _, normal in surface])


def mesh_ply(points, faces):
    header = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(points)
    header += "".join("property float %s\n" % name for name in CLOUD[0])
    header += "".join("property uchar %s\n" % name for name in ("red", "green", "blue"))
    header += "element face %d\nproperty list uchar int vertex_indices\nend_header\n" % len(faces)
    return (header.encode() + b"".join(struct.pack("<6f3B", *p, 0, 0, -1, 255, 128, 0) for p in points) +
            b"".join(struct.pack("<B3i", 3, *face) for face in faces))


def trajectory(count):
    return "".join("%.6f %.9f 0 0 0 0 0 1\n" % (i / 30, 0.2 * i) for i in range(count))


def write(path, content):
    with open(path, "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())


def read(path):
    with open(path, "rb") as file:
        return file.read()


class Export(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="hermite export ")
        self.addCleanup(self.folder.cleanup)
        self.result = os.path.join(self.folder.name, "a result")
        self.out = os.path.join(self.folder.name, "out")
        os.mkdir(self.result)
        os.mkdir(self.out)
        write(self.path("cloud.ply"), cloud_ply(POINTS))
        write(self.path("mesh.ply"), mesh_ply([(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], [(0, 2, 1), (0, 3, 2)]))
        write(self.path("trajectory.txt"), trajectory(4))

    def path(self, name):
        return os.path.join(self.result, name)

    def run_export(self, name, *more, result=None, out=None):
        out = out or os.path.join(self.out, name)
        command = [HERMITE, "export", result or self.result, "--format", name, "--out", out, *more]
        process = subprocess.run(command, capture_output=True, text=True, timeout=300)
        return process, out

    def export(self, name, *more, **options):
        process, out = self.run_export(name, *more, **options)
        self.assertEqual(process.returncode, 0, process.stderr)
        return out

    def refused(self, status, message, name, *more, **options):
        process, out = self.run_export(name, *more, **options)
        self.assertEqual(process.returncode, status, process.stderr)
        self.assertIn(message, process.stderr)
        self.assertEqual(len(process.stderr.strip().splitlines()), 1, process.stderr)
        self.assertFalse(os.path.exists(os.path.join(self.out, name)))
        self.assertEqual([entry for entry in os.listdir(self.out) if entry.endswith(".tmp")], [])

    def test_every_format_twice_with_the_same_bytes(self):
        for name in ALL:
            for turn in ("once", "again"):
                os.makedirs(os.path.join(self.out, turn), exist_ok=True)
                photos = ("--sequence", RECORDING) if name in ("colmap", "nerfstudio") else ()
                self.export(name, *photos, out=os.path.join(self.out, turn, name))
        for folder, _, files in os.walk(os.path.join(self.out, "once")):
            self.assertNotIn(".tmp", folder + "".join(files))
            for file in files:
                first = os.path.join(folder, file)
                self.assertEqual(read(first), read(first.replace("/once/", "/again/", 1)), first)

    def test_floor_plans(self):
        self.refused(2, "the scan shows no floor", "plan-svg")
        write(self.path("cloud.ply"), room_ply(3, 2, 2.4))
        with open(self.export("plan-json")) as file:
            room, = json.load(file)["rooms"]
        self.assertAlmostEqual(room["area_m2"], 6, delta=0.02)
        self.assertAlmostEqual(room["height_m"], 2.4, delta=0.005)
        self.assertIsNone(room["area_half_width_m2"], "without a report nothing is known of the poses")
        self.assertEqual(sorted(round(wall["length_m"], 2) for wall in room["outlines"][0]), [2, 2, 3, 3])
        drawing = xml.etree.ElementTree.parse(self.export("plan-svg")).getroot()
        texts = [node.text for node in drawing.iter("{http://www.w3.org/2000/svg}text")]
        self.assertIn("Room 1", texts)
        self.assertIn("1:10, lengths in metres", texts)
        self.assertTrue(read(self.export("plan-dxf")).endswith(b"  0\r\nEOF\r\n"))

    def test_las_by_its_specification(self):
        las = read(self.export("las"))
        self.assertEqual(las[:4], b"LASF")
        offset, records = struct.unpack_from("<II", las, 96)
        point_format, length = struct.unpack_from("<BH", las, 104)
        scale, shift = struct.unpack_from("<3d", las, 131), struct.unpack_from("<3d", las, 155)
        count, = struct.unpack_from("<Q", las, 247)
        self.assertEqual((records, point_format, length, count), (2, 7, 68, len(POINTS)))
        self.assertEqual(len(las), offset + count * length)
        for i, (x, y, z) in enumerate(POINTS):
            steps = struct.unpack_from("<3i", las, offset + i * length)
            for found, true in zip((s * k + o for s, k, o in zip(steps, scale, shift)), (x, z, -y)):
                self.assertAlmostEqual(found, true, delta=0.6e-4)
            red, green, blue = struct.unpack_from("<3H", las, offset + i * length + 30)
            self.assertEqual((red, green, blue), (2570, 5140, 65535))
            self.assertEqual(struct.unpack_from("<I", las, offset + i * length + 64), (7,))

    def test_other_programs_ply_without_columns(self):
        bare = os.path.join(self.folder.name, "bare.ply")
        write(bare, "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
                    "0 0 1\n0 1 1\n")
        self.assertGreater(len(read(self.export("las", result=bare))), 375)
        self.refused(2, "no normal (nx, ny, nz)", "splats", result=bare)
        self.refused(1, "there are no faces, only points", "glb", result=bare)
        self.refused(2, "give the folder of a result", "tum", result=bare)

    def test_trajectories(self):
        self.assertEqual(len(read(self.export("kitti")).splitlines()), 4)
        write(self.path("trajectory.txt"), trajectory(3) + "0.1 0.4 0 0 0 0 0 1\n0.133333 2 0 0 0 0 0 1\n")
        lines = read(self.export("log")).decode().splitlines()
        self.assertEqual([lines[i] for i in range(0, 20, 5)], ["0 0 1", "1 1 2", "2 2 3", "4 4 5"], "frame 3 was lost")

    def test_the_camera_is_the_reports(self):
        camera = {"width": 64, "height": 64, "fx": 71, "fy": 72, "cx": 31, "cy": 32, "depth_units_per_metre": 1000}
        write(self.path("report.json"), json.dumps({"corrected_camera": camera}))
        out = self.export("nerfstudio", "--sequence", RECORDING)
        with open(os.path.join(out, "transforms.json")) as file:
            transforms = json.load(file)
        self.assertEqual((transforms["fl_x"], transforms["fl_y"], transforms["cx"], transforms["cy"]), (71, 72, 31.5, 32.5))
        write(self.path("report.json"), json.dumps({"corrected_camera": dict(camera, width=80)}))
        self.refused(2, "another size", "colmap", "--sequence", RECORDING)
        write(self.path("report.json"), json.dumps({"corrected_camera": dict(camera, fx=-1)}))
        self.refused(2, "fx", "colmap", "--sequence", RECORDING)

    def test_what_is_missing_is_named(self):
        self.refused(2, "there is no format 'fbx', there are glb, glb-draco, obj", "fbx")
        self.refused(1, "no such file", "glb", result=os.path.join(self.folder.name, "nowhere"))
        self.refused(2, "--sequence names the recording", "colmap")
        self.refused(1, "No such file", "glb", out=os.path.join(self.out, "no/folder/a.glb"))
        self.refused(1, "there is no folder", "obj", out=os.path.join(self.out, "no/folder/obj"))
        os.remove(self.path("mesh.ply"))
        for name in ("glb", "glb-draco", "obj", "ply", "stl"):
            self.refused(1, "no mesh.ply, of which " + name + " is made: `hermite mesh", name)
        os.remove(self.path("cloud.ply"))
        self.refused(1, "cloud.ply", "las")

    def test_a_folder_that_is_taken_stays_as_it_is(self):
        taken = os.path.join(self.out, "taken")
        os.mkdir(taken)
        write(os.path.join(taken, "mine"), "mine")
        self.refused(2, "there is something already", "obj", out=taken)
        self.assertEqual(os.listdir(taken), ["mine"])

    def test_damaged_results(self):
        write(self.path("cloud.ply"), cloud_ply([(0, 0, float("nan"))]))
        for name in ("points-ply", "las", "points-glb", "splats"):
            self.refused(2, "point 0 of 1 is not finite", name)
        write(self.path("cloud.ply"), cloud_ply([]))
        self.refused(2, "it has no points", "las")
        write(self.path("cloud.ply"), cloud_ply(POINTS)[:-1])
        self.refused(1, "cut at vertex 39", "splats")
        write(self.path("mesh.ply"), mesh_ply([(0, 0, 1), (1, float("inf"), 1), (1, 1, 1)], [(0, 2, 1)]))
        for name in ("glb", "glb-draco", "obj", "ply", "stl"):
            self.refused(2, "position of vertex 1 is not finite", name)
        write(self.path("trajectory.txt"), "0 0 0\n")
        self.refused(1, "expected 8 numbers", "kitti")

    def test_edits_take_parts_out(self):
        edits = self.path("edits.json")
        box = {"axes": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "low_m": [-9, -9, -9], "high_m": [9, 9, 9]}
        keep = {"version": 1, "edits": [{"kind": "keep_inside", "box": dict(box, high_m=[0.25, 9, 9])}]}
        write(edits, json.dumps(keep))
        write(self.path("cloud.ply"), cloud_ply([(0, 0, 1), (0.2, 0, 1), (0.3, 0, 1)]))
        write(self.path("mesh.ply"), mesh_ply([(0, 0, 1), (0, 1, 1), (0.5, 0, 1)], [(0, 1, 2)]))
        self.assertIn(b"element vertex 2\n", read(self.export("points-ply", "--edits", edits)))
        mesh = read(self.export("ply", "--edits", edits))
        self.assertIn(b"element vertex 4\n", mesh)
        self.assertIn(b"element face 2\n", mesh)
        write(edits, json.dumps({"version": 1, "edits": [{"kind": "remove_inside", "box": box}]}))
        for name in ("las", "stl", "plan-svg"):
            self.refused(2, "leave nothing", name, "--edits", edits)
        self.refused(2, "neither a mesh nor a cloud", "kitti", "--edits", edits)
        write(edits, '{"version": 1, "edits": [{"kind": "melt", "box": 1}]}')
        self.refused(2, "edits.json: edits[0].kind must be", "las", "--edits", edits)
        self.refused(1, "missing.json", "las", "--edits", self.path("missing.json"))

    def test_a_full_disk_leaves_nothing(self):
        """Writing is cut at 4 kB, as a full disk would."""
        write(self.path("cloud.ply"), cloud_ply(POINTS * 100))
        for name in ("las", "obj"):
            write(self.path("mesh.ply"), mesh_ply([(i, 0, 1) for i in range(500)], [(i, i + 1, i + 2) for i in range(498)]))
            out = os.path.join(self.out, name)
            command = 'trap "" XFSZ; ulimit -f 4; exec "$@"'
            process = subprocess.run(["bash", "-c", command, "bash", HERMITE, "export", self.result, "--format", name, "--out", out],
                                     capture_output=True, text=True, timeout=300)
            self.assertEqual(process.returncode, 1, process.stderr)
            self.assertIn("File too large", process.stderr)
        self.assertEqual(os.listdir(self.out), [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
