#!/usr/bin/python3
"""`hermite compare` from end to end: two visits of a small synthetic room, the same result twice, and what cannot be compared.

    compare_test.py path/to/hermite
"""
import json
import os
import struct
import subprocess
import sys
import tempfile
import unittest

HERMITE = sys.argv[1]
ROOM = "synthetic:frames=20,rate=15,width=160,height=120"


def call(*arguments):
    return subprocess.run([HERMITE, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False, timeout=300)


def ply(points):
    header = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(points)
    header += "".join("property float %s\n" % name for name in ("x", "y", "z", "nx", "ny", "nz")) + "end_header\n"
    return header.encode() + b"".join(struct.pack("<6f", *p) for p in points)


class CompareTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def compare(self, first, second):
        done = call("compare", first, second, "--out", self.path("out"), "--json")
        return done.returncode, json.loads(done.stdout) if done.stdout else None, done.stderr.decode()

    def test_two_visits(self):
        for name, options in (("before", ""), ("after", ",removed=plant")):
            done = call("reconstruct", ROOM + options, "--out", self.path(name))
            self.assertEqual(done.returncode, 0, done.stderr)
        status, report, _ = self.compare(self.path("before"), self.path("before"))
        self.assertEqual(status, 0, report)
        self.assertEqual(report["verdict"], "same_place")
        self.assertEqual(report["regions"], [])
        for row in range(4):
            for column in range(4):
                self.assertAlmostEqual(report["a_from_b"][row][column], 1 if row == column else 0, places=4)
        status, report, _ = self.compare(self.path("before"), self.path("after"))
        self.assertEqual(status, 0, report)
        with open(self.path("out/changes.ply"), "rb") as file:
            first = file.read()
        self.assertTrue(first.startswith(b"ply\nformat binary_little_endian 1.0\n"))
        self.compare(self.path("before"), self.path("after"))
        with open(self.path("out/changes.ply"), "rb") as file:
            self.assertEqual(file.read(), first, "the same bytes")

    def test_what_cannot_be_compared(self):
        with open(self.path("empty.ply"), "wb") as file:
            file.write(ply([]))
        nan = float("nan")
        with open(self.path("nan.ply"), "wb") as file:
            file.write(ply([(nan, nan, nan, 0, 0, 1)] * 2000))
        for name, said in (("empty.ply", "no points"), ("nan.ply", "0 usable points")):
            status, report, message = self.compare(self.path(name), self.path(name))
            self.assertNotEqual(status, 0)
            self.assertIsNone(report)
            self.assertIn(said, message)
        done = call("compare", self.path("a"), self.path("b"), "--out", self.path("out"), "--least-change", "500")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn(b"least change", done.stderr)


if __name__ == "__main__":
    sys.argv = sys.argv[:1]
    unittest.main()
