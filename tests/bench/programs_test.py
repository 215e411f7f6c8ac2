#!/usr/bin/python3
"""hermite_bench and tests/bench/run from end to end, on eight small frames of the synthetic camera.

    programs_test.py path/to/hermite path/to/hermite_bench
"""
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

HERMITE, BENCH = sys.argv[1:3]
SEQUENCE = "synthetic:frames=8,width=160,height=120"
# What every machine has, and what sanitizers add.
RUNTIME = {"libvulkan", "libfmt", "libstdc++", "libm", "libgcc_s", "libc", "libpthread", "libdl", "librt", "libasan", "libubsan"}


def run(*command):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False, timeout=300)


def rows(text, first_cell):
    return [line for line in text.splitlines() if line.startswith(f"| {first_cell} |")]


class Bench(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.raw = os.path.join(cls.folder.name, "room.raw")
        dumped = run(HERMITE, "reconstruct", SEQUENCE, "--dump-raw", cls.raw)
        assert dumped.returncode == 0, dumped.stderr

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_tables_and_trace(self):
        trace_file = os.path.join(self.folder.name, "trace.json")
        done = run(BENCH, self.raw, "--frames", "9", "--warm-up", "2", "--trace", trace_file)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("8 frames of 160x120. 9 frames measured after 2 to warm up, 9 tracked.", done.stdout)
        self.assertRegex(done.stdout, r"Reachable: [0-9.]+ GB/s of memory, [0-9]+ GFLOP/s")
        for row in ["frame, wall clock", "preprocess", "track", "fuse", "predict", "GPU passes together", "track/odometry", "map/predict",
                    "frame/surface", "map", "all", "alive", "slots in use"]:
            self.assertEqual(len(rows(done.stdout, row)), 1, row)
        with open(trace_file, encoding="utf-8") as file:
            events = [event for event in json.load(file)["traceEvents"] if event["ph"] == "X"]
        self.assertEqual(sum(event["cat"] == "frame" for event in events), 9)
        self.assertEqual(sum(event["cat"] == "stage" for event in events), 4 * 9)
        for event in events:
            self.assertGreaterEqual(event["ts"], 0)
            self.assertGreaterEqual(event["dur"], 0)

    def test_bad_files_are_refused_with_a_message(self):
        with open(self.raw, "rb") as file:
            data = file.read()
        bad = os.path.join(self.folder.name, "bad.raw")
        for content, message in [(b"", "0 bytes"), (data[:-1], "cut short"), (b"not " + data[4:], "HRMFRAME"),
                               (data[:12] + b"\xff\xff\xff\xff" + data[16:], "camera.width")]:
            with open(bad, "wb") as file:
                file.write(content)
            done = run(BENCH, bad)
            self.assertEqual(done.returncode, 1)
            self.assertIn(message, done.stderr)
            self.assertEqual(done.stdout, "")

    def test_help_and_usage(self):
        self.assertEqual(run(BENCH, "--help").returncode, 0)
        self.assertEqual(run(BENCH).returncode, 2)
        self.assertEqual(run(BENCH, self.raw, "--frames", "no").returncode, 2)
        neither = run(HERMITE, "reconstruct", SEQUENCE)
        self.assertEqual(neither.returncode, 2)
        self.assertIn("--dump-raw", neither.stderr)

    def test_links_nothing_but_vulkan_and_fmt(self):
        libraries = re.findall(r"^\s*(lib[^.\s]+)\.so", run("ldd", BENCH).stdout, re.MULTILINE)
        self.assertIn("libvulkan", libraries)
        self.assertEqual(set(libraries) - RUNTIME, set())

    def test_the_script_prints_both(self):
        script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "run")
        done = run(sys.executable, script, "--hermite", HERMITE, "--bench", BENCH, "--bench-frames", "3", SEQUENCE)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(rows(done.stdout, SEQUENCE)), 1)
        self.assertEqual(len(rows(done.stdout, "track")), 2)
        self.assertEqual(len(rows(done.stdout, "map/merge")), 1)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
