#!/usr/bin/python3
"""Same frames, same settings, same device: the same poses, cloud and mesh to the last bit, whatever else the machine does and however many
threads the device has.

    replay_test.py path/to/hermite
"""
import json
import os
import subprocess
import sys
import tempfile
import unittest

HERMITE = sys.argv[1]
SEQUENCE = "synthetic:frames=12,width=160,height=120,noise=kinect-white,seed=1"


def start(folder, *more, **environment):
    command = [HERMITE, "reconstruct", SEQUENCE, "--out", folder, "--set", "map.stable_confidence=1", *more]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env={**os.environ, **environment})


def hashes(process):
    out, error = process.communicate(timeout=500)
    assert process.returncode == 0, error.decode()
    report = json.loads(out)
    assert report["tracked_frames"] == 12 and report["surfels"] > 1000, report
    return report["trajectory_sha256"], report["cloud_sha256"]


class Replay(unittest.TestCase):
    def test_threads_and_load_change_nothing(self):
        with tempfile.TemporaryDirectory() as folder:
            alone = hashes(start(os.path.join(folder, "alone"), "--mesh"))
            # lavapipe takes the number of its threads from there; other devices do not care.
            together = [start(os.path.join(folder, f"threads{count}"), LP_NUM_THREADS=str(count)) for count in (0, 1, 3, 7)]
            for process in together:
                self.assertEqual(hashes(process), alone)
            again = os.path.join(folder, "again.ply")
            made = json.loads(subprocess.run([HERMITE, "mesh", os.path.join(folder, "threads3"), "--out", again], stdout=subprocess.PIPE, check=True,
                                             timeout=300).stdout)
            self.assertGreater(made["triangles"], 1000)
            with open(again, "rb") as mesh, open(os.path.join(folder, "alone", "mesh.ply"), "rb") as reconstructed:
                self.assertEqual(mesh.read(), reconstructed.read(), "what --mesh leaves is what hermite mesh makes")
            with open(os.path.join(folder, "alone", "report.json"), encoding="utf-8") as report:
                self.assertEqual(json.load(report)["mesh"]["triangles"], made["triangles"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
