#!/usr/bin/python3
"""`hermite-client import` against a real server: clouds and meshes become scans that are listed, shown, taken away, shared, backed up, counted,
kept over a restart and deleted; and what is wrong with a file is said in a message, and the server lives on.

    import_test.py path/to/hermite path/to/hermite-client
"""
import json
import os
import re
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.error
import urllib.request

HERMITE, CLIENT = sys.argv[1:3]


def ply(points, faces=(), form="binary_big_endian", columns="x y z nx ny nz"):
    header = "ply\nformat %s 1.0\nelement vertex %d\n" % (form, len(points)) + "".join("property double %s\n" % c for c in columns.split())
    header += "element face %d\nproperty list uchar uint vertex_indices\nend_header\n" % len(faces)
    mark = ">" if "big" in form else "<"
    body = b"".join(struct.pack("%s%dd" % (mark, len(p)), *p) for p in points)
    return header.encode() + body + b"".join(struct.pack("%sB%dI" % (mark, len(f)), len(f), *f) for f in faces)


def glb(document, binary):
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def triangle():
    document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "buffers": [{"byteLength": 36}],
                "bufferViews": [{"buffer": 0, "byteLength": 36}],
                "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3}]}
    return document, struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)


def face_count(path):
    with open(path, "rb") as file:
        return int(re.search(rb"element face (\d+)", file.read(1000)).group(1))


# A floor of a room somewhere in a map projection, 2 cm apart, z up.
FLOOR = [(500000 + 0.02 * i, 4649776 + 0.02 * k, 30, 0, 0, 1) for i in range(30) for k in range(30)]


class Import(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="hermite-import-")
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.start()
        self.addCleanup(self.stop)

    def start(self):
        command = [HERMITE, "serve", "--listen", "127.0.0.1:0", "--data", os.path.join(self.folder, "data"), "--mesh-on-demand"]
        self.server = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        for line in self.server.stdout:
            found = re.search(r"(http://127\.0\.0\.1:\d+)/#token=(\w+)", line)
            if found:
                self.address, self.token = found.groups()
                return
        self.fail("the server does not say where it is")

    def stop(self):
        if self.server.poll() is None:
            self.server.send_signal(signal.SIGTERM)
        self.server.stdout.read()
        self.assertEqual(self.server.wait(60), 0)
        self.server.stdout.close()

    def client(self, *arguments):
        command = [CLIENT, *arguments, "--server", self.address, "--token", self.token]
        return subprocess.run(command, capture_output=True, text=True, timeout=120, env={**os.environ, "XDG_STATE_HOME": self.folder})

    def add(self, name, content, *more):
        path = os.path.join(self.folder, name)
        with open(path, "wb") as file:
            file.write(content)
        process = self.client("import", path, "--json", *more)
        return process, json.loads(process.stdout or "null")

    def api(self, path, method="GET", body=None, token=None):
        request = urllib.request.Request(self.address + "/api/v1/" + path, body and body.encode(), {"Authorization": "Bearer " + (token or self.token)}, method=method)
        with urllib.request.urlopen(request, timeout=30) as answer:
            return answer.read()

    def formats(self, scan):
        return {one["format"]: one["state"] for one in json.loads(self.api("scans/%s/exports" % scan))["exports"]}

    def test_a_cloud_is_a_scan(self):
        process, told = self.add("Hall.ply", ply(FLOOR))
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn("500000, 4649800, 0 was subtracted", process.stderr)
        scan = told["scan"]
        row = json.loads(self.api("scans/" + scan))
        self.assertEqual((row["title"], row["state"], row["frames_received"]), ("Hall", "finished", 0))
        self.assertEqual(set(self.formats(scan)), {"glb", "glb-draco", "obj", "ply", "stl", "cloud", "las", "points-glb", "splats", "plan-svg", "plan-dxf", "plan-json"})
        cloud = self.api("scans/%s/cloud.ply" % scan)
        self.assertIn(b"element vertex 900\n", cloud)
        at = cloud.index(b"end_header\n") + 11
        self.assertEqual(struct.unpack_from("<6f", cloud, at), (0, -30, -24, 0, -1, 0), "z up is -y of the world, and it is near 0")
        out = os.path.join(self.folder, "hall.ply")
        self.assertEqual(self.client("download", scan, "--format", "ply", "--out", out).returncode, 0)
        as_it_is = face_count(out)
        self.assertGreater(as_it_is, 100)
        done = self.client("download", scan, "--format", "ply_s1000", "--out", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertLess(face_count(out), as_it_is / 2, "finished as the name says")

        share = json.loads(self.api("scans/%s/shares" % scan, "POST", "{}"))["secret"]
        command = [HERMITE, "backup", "--data", os.path.join(self.folder, "data"), "--to", os.path.join(self.folder, "backup")]
        backup = subprocess.run(command, capture_output=True, text=True, timeout=60)
        self.assertEqual(backup.returncode, 0, backup.stderr)
        self.stop()
        self.start()
        self.assertTrue(os.path.exists(os.path.join(self.folder, "backup", "scans", scan, "cloud.ply")), os.listdir(self.folder))
        self.assertEqual(self.api("scans/%s/cloud.ply" % scan, token=share), cloud)
        self.api("scans/" + scan, "DELETE")
        with self.assertRaises(urllib.error.HTTPError):
            self.api("scans/" + scan)
        self.assertFalse(os.path.exists(os.path.join(self.folder, "data", "scans", scan)))

    def test_a_mesh_is_a_scan(self):
        document, binary = triangle()
        bytes_of_glb = glb(document, binary)
        process, told = self.add("roof.glb", bytes_of_glb)
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertEqual(self.formats(told["scan"]), {"imported": "ready", **dict.fromkeys("glb glb-draco obj ply stl".split(), "missing")})
        self.assertEqual(self.api("scans/%s/exports/imported" % told["scan"]), bytes_of_glb, "as it is")
        process, told = self.add("quad.ply", ply([(0, 0, 0), (4200, 0, 0), (4200, 0, 3000), (0, 0, 3000)], [(0, 1, 2, 3)], columns="x y z"))
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertIn("--scale 0.001", process.stderr)
        process, told = self.add("small.ply", ply([(0, 0, 0), (4200, 0, 0), (4200, 0, 3000)], [(0, 1, 2)], columns="x y z"), "--scale", "0.001", "--title", "Wall")
        self.assertEqual((process.returncode, told["state"]), (0, "finished"), process.stderr)
        self.assertNotIn("millimetres", process.stderr)
        kept = self.api("scans/%s/exports/imported" % told["scan"])
        self.assertIn(b'"max":[4.', kept)

    def test_what_is_wrong_is_said_and_the_server_lives_on(self):
        document, binary = triangle()

        def changed(**fields):
            return glb({**document, **fields}, binary)

        huge = b"ply\nformat ascii 1.0\nelement vertex 100000000000\nproperty float x\nend_header\n"
        cases = [("text.ply", b"Dear reader,\n", "neither PLY nor GLB"), ("nothing.ply", b"", "neither PLY nor GLB"),
                 ("empty.ply", ply([]), "nothing in it"), ("cut.ply", ply(FLOOR)[:-40], "cut at vertex 899 of 900"),
                 ("huge.ply", huge, "count of at most"), ("nan.ply", ply([(float("nan"), 0, 0)], columns="x y z"), "not finite"),
                 ("face.ply", ply([(0, 0, 0)] * 3, [(0, 1, 7)], columns="x y z"), "a vertex that is not there"),
                 ("circle.glb", changed(nodes=[{"mesh": 0, "children": [0]}]), "nodes[0] is below itself"),
                 ("uri.glb", changed(buffers=[{"byteLength": 36, "uri": "http://example.org/"}]), "buffers[0] has a uri"),
                 ("lie.glb", changed(accessors=[{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 10 ** 9}]), "are left of the limit")]
        for name, content, message in cases:
            process, told = self.add(name, content)
            self.assertEqual(process.returncode, 3, name + process.stderr)
            self.assertIn(message, told["words"], name)
            # The server does not believe the client.
            request = urllib.request.Request(self.address + "/api/v1/uploads/" + name, content, {"Authorization": "Bearer " + self.token}, method="PUT")
            if not content:
                continue
            with urllib.request.urlopen(request, timeout=30) as answer:
                job = json.loads(answer.read())["job"]
            while (state := json.loads(self.api("jobs/" + job)))["state"] in ("queued", "running"):
                time.sleep(0.2)
            self.assertEqual(state["state"], "failed", name)
            self.assertIn(message if name != "text.ply" else "no recording we know", state["words"], name)
        self.assertEqual(json.loads(self.api("scans"))["scans"], [])
        self.assertEqual(os.listdir(os.path.join(self.folder, "data", "scans")), [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
