#!/usr/bin/python3
"""Kills the server with SIGKILL at random moments while cameras stream, starts it again, and looks whether anything was lost.

    kill_server.py path/to/hermite path/to/hermite-client [--kills 20] [--seed 1]

Passes when every scan came back after every kill, no frame that the client was told to be durable is missing from the log on disk, and
trajectory and cloud of every scan have the hashes of an undisturbed run, whether it was rebuilt from a checkpoint or not. The log is read here by a program of its own, from
core/log/frame_log.md alone.
"""
import glob
import os
import random
import re
import signal
import sys
import tempfile
import time

from frame_log import frames_in_log
from programs import FRAMES, Camera, Server, argument_parser, check, durable_said, failures

KILLS_PER_SCAN = 5

# So that most kills find a checkpoint, and many a half-written one.
CHECKPOINT_PERIOD_MS = 100


def logs_in(data):
    return set(glob.glob(os.path.join(data, "scans", "*", "log")))


def time_of_checkpoint(log):
    try:
        return os.stat(os.path.join(os.path.dirname(log), "checkpoint.bin")).st_mtime_ns
    except FileNotFoundError:
        return 0


def wait_for_checkpoint(camera, log):
    """Until the server has written one since now; not for ever."""
    before, deadline = time_of_checkpoint(log), time.monotonic() + 10
    while time_of_checkpoint(log) == before and time.monotonic() < deadline and camera.process.poll() is None:
        time.sleep(0.005)


def disturb(server, camera, log, kills, rng):
    """Up to `kills` kills while the camera streams. Returns how many there were."""
    done = seen = 0
    while done < kills:
        if done % 2 == 1:
            wait_for_checkpoint(camera, log)
        deadline = time.monotonic() + rng.uniform(0.02, 2.0)
        while time.monotonic() < deadline and camera.process.poll() is None:
            time.sleep(0.005)
        if camera.process.poll() is not None:
            break
        server.end(signal.SIGKILL)
        done += 1
        frames = frames_in_log(log)
        time.sleep(0.3)  # the client notices
        said = durable_said(list(camera.lines))
        for count in said[seen:]:
            check(count <= frames, f"{count} frames were durable, {frames} are in the log")
        seen = len(said)
        server.start()
    return done


def main():
    parser = argument_parser()
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    rng = random.Random(arguments.seed)
    with tempfile.TemporaryDirectory() as folder:
        data = os.path.join(folder, "data")
        server = Server(arguments.hermite, data, settings=("--checkpoint-period", str(CHECKPOINT_PERIOD_MS)))
        started = time.monotonic()
        expected = Camera(arguments.client, server.url).result()
        check(expected is not None and expected[0] == FRAMES, f"the undisturbed run: {expected}")
        kills = scans = resumed = longest = 0
        logs = logs_in(data)
        while kills < arguments.kills and not failures:
            camera = Camera(arguments.client, server.url)
            # Not before its first frame is on disk: a camera that has not been told of its scan cannot come back to it.
            while not (new := logs_in(data) - logs) or frames_in_log(min(new)) == 0:
                time.sleep(0.01)
                if camera.process.poll() is not None:
                    sys.exit("the camera ended before its first frame: " + "".join(camera.lines))
            log = min(new)
            logs.add(log)
            done = disturb(server, camera, log, min(KILLS_PER_SCAN, arguments.kills - kills), rng)
            result = camera.result()
            check(result == expected,
                  f"scan {scans + 1} after {done} kills: {result} instead of {expected}\n" + "".join(camera.lines[-20:]))
            kills += done
            scans += 1
            resumed += sum("connected again" in line for line in camera.lines)
            longest = max(longest, done)
        server.end_well()
        restored = [int(count) for count in re.findall(r"rebuilt: (\d+) frames from a checkpoint", server.all_of_log())]
        check(any(restored) or kills < 10, "no scan was rebuilt from a checkpoint")
        unusable = server.all_of_log().count("checkpoint cannot be used")
        verdict = "FAILED" if failures else "nothing lost, all results the same"
        print(f"{kills} kills in {scans} scans of {FRAMES} frames (up to {longest} a scan), {resumed} times resumed, "
              f"{len(restored)} times rebuilt, of these {sum(count > 0 for count in restored)} from a checkpoint "
              f"({sum(restored)} frames in all), {unusable} checkpoints could not be used, "
              f"{time.monotonic() - started:.0f} s, seed {arguments.seed}: {verdict}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
