#!/usr/bin/python3
"""A scan's exports as other programs read them: Open3D, Draco's own decoder, COLMAP. A program that is not installed is skipped, and said so.

    foreign_readers_test.py path/to/hermite
"""
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

HERMITE = sys.argv[1]
RECORDING = "synthetic:frames=8,width=160,height=120"
READ_BY_OPEN3D = """
import json, sys
import open3d
found = {}
for name in json.loads(sys.argv[1]):
    mesh = open3d.io.read_triangle_mesh(name, True)
    box = mesh.get_axis_aligned_bounding_box()
    found[name] = {"triangles": len(mesh.triangles), "textures": [texture.get_max_bound().tolist() for texture in mesh.textures],
                   "uvs": mesh.has_triangle_uvs(), "normals": mesh.has_vertex_normals(), "low": list(box.min_bound), "high": list(box.max_bound)}
for name in json.loads(sys.argv[2]):
    cloud = open3d.io.read_point_cloud(name)
    found[name] = {"points": len(cloud.points), "normals": cloud.has_normals(), "colors": cloud.has_colors()}
print(json.dumps(found))
"""


def run(*command):
    process = subprocess.run(command, capture_output=True, text=True, timeout=300)
    if process.returncode:
        raise AssertionError(" ".join(command) + "\n" + process.stdout + process.stderr)
    return process.stdout


def count_of(ply, element):
    with open(ply, "rb") as file:
        return int(re.search(rb"element %s (\d+)" % element.encode(), file.read(4096)).group(1))


def needs(program):
    return unittest.skipUnless(shutil.which(program), program + " is not installed")


class ForeignReaders(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="hermite foreign ")
        cls.addClassCleanup(cls.folder.cleanup)
        cls.result = os.path.join(cls.folder.name, "result")
        run(HERMITE, "reconstruct", RECORDING, "--out", cls.result, "--mesh")
        cls.triangles = count_of(os.path.join(cls.result, "mesh.ply"), "face")
        cls.points = count_of(os.path.join(cls.result, "cloud.ply"), "vertex")
        assert cls.triangles > 1000 and cls.points > 1000, (cls.triangles, cls.points)

    def export(self, name, file, sequence=True):
        out = os.path.join(self.folder.name, file)
        run(HERMITE, "export", self.result, "--format", name, "--out", out, *(("--sequence", RECORDING) if sequence else ()))
        return out

    def test_open3d(self):
        if subprocess.run(["/usr/bin/python3", "-c", "import open3d"], capture_output=True, timeout=300).returncode:
            self.skipTest("open3d is not installed")
        glb, obj = self.export("glb", "textured.glb"), os.path.join(self.export("obj", "obj"), "mesh.obj")
        ply, stl = self.export("ply", "mesh.ply", False), self.export("stl", "mesh.stl", False)
        dense = os.path.join(self.export("nerfstudio", "nerfstudio"), "points.ply")
        cloud = os.path.join(self.result, "cloud.ply")
        found = json.loads(run("/usr/bin/python3", "-c", READ_BY_OPEN3D, json.dumps([glb, obj, ply, stl]), json.dumps([cloud, dense])))
        for name in (glb, obj, ply, stl):
            self.assertEqual(found[name]["triangles"], self.triangles, name)
            self.assertTrue(found[name]["normals"], name)
        for name in (glb, obj):
            self.assertTrue(found[name]["uvs"], name)
            self.assertEqual(len(found[name]["textures"]), 1, name)
        # The world of a scan has y down, in metres; glTF and OBJ have it up; STL has millimetres, z up.
        low, high = found[ply]["low"], found[ply]["high"]
        for name, expected in ((glb, [low[0], -high[1], -high[2]]), (obj, [low[0], -high[1], -high[2]]),
                               (stl, [1000 * low[0], 1000 * low[2], -1000 * high[1]])):
            for one, other in zip(found[name]["low"], expected):
                self.assertAlmostEqual(one, other, delta=1e-3 * max(1, abs(other)), msg=name)
        for name in (cloud, dense):
            self.assertEqual(found[name], {"points": self.points, "normals": True, "colors": True}, name)

    @needs("draco_decoder")
    def test_draco(self):
        with open(self.export("glb-draco", "compressed.glb"), "rb") as file:
            glb = file.read()
        length, = struct.unpack_from("<I", glb, 12)
        document = json.loads(glb[20:20 + length])
        view = document["bufferViews"][document["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["bufferView"]]
        start = 20 + length + 8 + view["byteOffset"]
        compressed, decoded = (os.path.join(self.folder.name, name) for name in ("mesh.drc", "decoded.ply"))
        with open(compressed, "wb") as file:
            file.write(glb[start:start + view["byteLength"]])
        run("draco_decoder", "-i", compressed, "-o", decoded)
        self.assertEqual(count_of(decoded, "face"), self.triangles)

    @needs("colmap")
    def test_colmap(self):
        output = run("colmap", "model_analyzer", "--path", os.path.join(self.export("colmap", "colmap"), "sparse", "0"))
        self.assertIn("Cameras: 1\n", output)
        self.assertRegex(output, r"Registered images: [1-9]")
        self.assertIn("Points: %d\n" % self.points, output)
        error_px = float(re.search(r"Mean reprojection error: ([\d.]+)px", output).group(1))
        self.assertLess(error_px, 0.01)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
