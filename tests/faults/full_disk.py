#!/usr/bin/python3
"""Lets the disk become full while a camera streams.

    full_disk.py path/to/hermite path/to/hermite-client

No file of the server can become longer than 300 kB: what the log of the scan needs is three times that. Passes when the client is told in
words and ends, nothing that it was told to be durable is missing, the server lives, the state of the scan says why, and after a restart with
room another scan goes well.
"""
import glob
import os
import signal
import sys
import tempfile

from frame_log import frames_in_log
from programs import FRAMES, Camera, Server, check, durable_said, failures

LARGEST_FILE = 300_000


def main():
    with tempfile.TemporaryDirectory() as folder:
        data = os.path.join(folder, "data")
        server = Server(sys.argv[1], data, largest_file=LARGEST_FILE)
        camera = Camera(sys.argv[2], server.url)
        check(camera.result() is None, "the client says that the scan did not go well")
        said = "".join(camera.lines)
        check("cannot be stored" in said, "the client is told why: " + said)
        check(server.process.poll() is None, "the server lives")
        (scan,) = server.scans()
        check(scan["state"] in ("interrupted", "failed") and scan["words"], f"the state says why: {scan}")
        (log,) = glob.glob(os.path.join(data, "scans", "*", "log"))
        frames = frames_in_log(log)
        check(0 < frames < FRAMES, f"{frames} of {FRAMES} frames are in the log")
        check(all(count <= frames for count in durable_said(camera.lines)), "what was durable is there")
        check(server.end(signal.SIGTERM) == 0, "the server ends well")

        server.largest_file = None
        server.start()
        check(server.scans()[0]["state"] == scan["state"], "the state is the same after a restart")
        result = Camera(sys.argv[2], server.url).result()
        check(result is not None and result[0] == FRAMES, f"a scan on a disk with room: {result}")
        if failures:
            print(server.tail())
        check(server.end(signal.SIGTERM) == 0, "the server ends well")
        print(f"disk full after {frames} frames; scan {scan['state']}: {scan['words']}: {'FAILED' if failures else 'as it should be'}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
