#!/usr/bin/python3
"""A camera that is calibrated badly is found out in its recording, and the reconstruction with the better one is as it should be.

    calibrate_test.py path/to/hermite
"""
import json
import os
import subprocess
import sys
import tempfile
import unittest

HERMITE = sys.argv[1]
BENT = "synthetic:frames=75,width=320,height=240,rate=20+bend=percent=3+noise=kinect-white,seed=1"  # 3.75 s, some 140 degrees


def hermite(*arguments):
    done = subprocess.run([HERMITE, *arguments], capture_output=True, timeout=500, check=False)
    return done.returncode, done.stdout.decode(), done.stderr.decode()


class Calibrate(unittest.TestCase):
    def test_a_bend_is_found_applied_and_written(self):
        with tempfile.TemporaryDirectory() as folder:
            code, out, error = hermite("reconstruct", BENT, "--set", "frame.correct_camera=false", "--out", os.path.join(folder, "bent"))
            self.assertEqual(code, 0, error)
            before = json.loads(out)
            self.assertNotIn("calibrations", before)
            self.assertNotIn("corrected_camera", before)

            code, out, error = hermite("reconstruct", BENT, "--out", os.path.join(folder, "corrected"))
            self.assertEqual(code, 0, error)
            corrected = json.loads(out)
            self.assertAlmostEqual(corrected["corrected_camera"]["depth_correction"]["bend"], 1 / 1.03 - 1, delta=0.003)
            self.assertIn("recalibrated", error)
            self.assertLess(corrected["ate_rmse_m"], before["ate_rmse_m"] / 3)

            camera_file = os.path.join(folder, "camera.json")
            code, out, error = hermite("calibrate", BENT, "--trajectory", os.path.join(folder, "bent", "trajectory.txt"), "--out", camera_file)
            self.assertEqual(code, 0, error)
            found = json.loads(out)
            bend = found["numbers"]["bend"]
            self.assertTrue(found["applied"] and bend["applied"], out)
            self.assertAlmostEqual(bend["value"], 1 / 1.03 - 1, delta=0.006)  # a fifth
            self.assertLess(found["held_back"]["after"]["rms_m"], found["held_back"]["before"]["rms_m"])

            few_frames = BENT.replace("frames=75", "frames=3")
            code, out, error = hermite("calibrate", few_frames, "--camera", camera_file)
            self.assertEqual(code, 0, error)
            self.assertEqual(json.loads(out)["camera"], found["camera"], "three frames tell nothing: it is that of the file")

    def test_a_camera_that_stands_still_tells_nothing(self):
        with tempfile.TemporaryDirectory() as folder:
            camera_file = os.path.join(folder, "camera.json")
            code, out, error = hermite("calibrate", "synthetic:frames=3,width=160,height=120", "--out", camera_file)
            self.assertEqual(code, 0, error)
            found = json.loads(out)
            self.assertFalse(found["applied"])
            self.assertIn("too few overlapping views", found["reason"])
            with open(camera_file, encoding="utf-8") as camera:
                self.assertEqual(json.load(camera), found["camera"])
            self.assertNotIn("depth_correction", found["camera"])

            # The same between the two passes of a reconstruction.
            code, out, error = hermite("reconstruct", "synthetic:frames=3,width=160,height=120", "--calibrate", "--out",
                                       os.path.join(folder, "twice"))
            self.assertEqual(code, 0, error)
            report = json.loads(out)
            self.assertEqual([(pass_["applied"], pass_["reason"]) for pass_ in report["calibrations"]], [(False, found["reason"])])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
