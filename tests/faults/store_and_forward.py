#!/usr/bin/python3
"""A camera that scans on while its server is away, from the terminal's side: the programs, a pseudo terminal, SIGKILL.

    store_and_forward.py path/to/hermite path/to/hermite-client [--frames 60]

The server is killed after a third of the scan and comes back after the second third. Passes when nothing was lost and trajectory and cloud
have the hashes of an undisturbed batch run of the recorded frames, streamed and local. Then: a scan whose server comes only after its end,
a recording of which the client is killed, and the keys.
"""
import json
import os
import pty
import re
import resource
import select
import signal
import subprocess
import sys
import tempfile
import time

from programs import PATIENCE_S, Server, argument_parser, check, failures

SETTINGS = ["--set", "map.stable_confidence=1"]
PREFLIGHT = 3
FRAME_BYTES = 12_000  # a frame is recorded in somewhat more


def camera(frames):
    return f"recording:synthetic:frames={PREFLIGHT + frames},width=160,height=120,noise=kinect-white,seed=1"


def scan_command(client, source, folder, url=None):
    command = [client, "scan", "--camera", source, "--preflight", str(PREFLIGHT), "--record", folder]
    return command + (["--server", url] + SETTINGS if url else [])


def hashes(text):
    report = json.loads(text)
    return report["frames"], report["trajectory_sha256"], report["cloud_sha256"]


def streamed(client, folder, url):
    return hashes(subprocess.run([client, "stream", folder, "--server", url] + SETTINGS, check=True, capture_output=True, text=True,
                                 timeout=PATIENCE_S).stdout)


def reconstructed(hermite, folder, out):
    subprocess.run([hermite, "reconstruct", folder, "--out", out] + SETTINGS, check=True, capture_output=True, timeout=PATIENCE_S)
    with open(os.path.join(out, "report.json"), encoding="utf-8") as report:
        return hashes(report.read())


def wait_for_recorded(process, log, frames):
    """Until so many are on the disk: how long that takes is the machine's affair."""
    deadline = time.monotonic() + PATIENCE_S
    size = lambda: sum(entry.stat().st_size for entry in os.scandir(log)) if os.path.isdir(log) else 0
    while size() < frames * FRAME_BYTES and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.01)
    check(process.poll() is None, f"the camera still scans after {frames} frames")


def away_for_a_third(hermite, client, server, folder, frames):
    log = os.path.join(folder, "away")
    process = subprocess.Popen(scan_command(client, camera(frames), log, server.url), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    wait_for_recorded(process, log, frames // 3)
    server.end(signal.SIGKILL)
    wait_for_recorded(process, log, frames * 2 // 3)
    server.start()
    out, errors = process.communicate(timeout=PATIENCE_S)
    check(process.returncode == 0, f"the scan ends well: {errors}")
    if process.returncode != 0:
        return
    result = hashes(out)
    check(result[0] == frames, f"{result[0]} of {frames} frames in the result")
    check(result == streamed(client, log, server.url), "the result is that of the recording streamed undisturbed")
    check(result == reconstructed(hermite, log, os.path.join(folder, "away-local")), "and of the recording without a server")
    check("connected again" in errors or "as a new scan" in errors, f"the link was lost and came back: {errors}")


def server_comes_late(client, server, folder, frames):
    log = os.path.join(folder, "late")
    server.end(signal.SIGTERM)
    process = subprocess.Popen(scan_command(client, camera(frames), log, server.url), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    time.sleep(frames / 30 + 1)
    server.start()
    out, errors = process.communicate(timeout=PATIENCE_S)
    check(process.returncode == 0, f"the late server gets the scan: {errors}")
    check(process.returncode != 0 or hashes(out) == streamed(client, log, server.url), "and has the same result")


def killed_client(hermite, client, folder):
    log = os.path.join(folder, "killed")
    process = subprocess.Popen(scan_command(client, camera(1000), log), stderr=subprocess.DEVNULL)
    wait_for_recorded(process, log, 30)
    process.kill()
    process.wait()
    inspected = subprocess.run([hermite, "inspect", log, "--json"], check=True, capture_output=True, text=True)
    found = json.loads(inspected.stdout)
    check(found["frame_count"] > 10, f"what was on the disk can be read: {found['frame_count']} frames")
    check(any("not finished" in doubt for doubt in found["doubts"]), f"and that it was broken off is said: {found['doubts']}")


def full_disk(client, server, folder):
    """No file of the client can become longer than 300 kB."""
    log = os.path.join(folder, "full")
    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, 300_000))
    done = subprocess.run(scan_command(client, camera(1000), log, server.url), capture_output=True, text=True, timeout=PATIENCE_S,
                          preexec_fn=limit, restore_signals=False)
    check(done.returncode == 0, f"what was recorded before the disk was full has its result: {done.stderr}")
    check("the recording has ended: writing" in done.stderr, f"and it is said why there is no more: {done.stderr}")
    check(done.returncode != 0 or 3 < hashes(done.stdout)[0] < 1000, "some frames")


class Terminal:
    """A program on a pseudo terminal."""

    def __init__(self, command):
        self.text = ""
        self.pid, self.descriptor = pty.fork()
        if self.pid == 0:
            os.execv(command[0], command)

    def wait_for(self, pattern):
        deadline = time.monotonic() + 60
        while not re.search(pattern, self.text) and time.monotonic() < deadline:
            self.read(0.1)
        check(re.search(pattern, self.text), f"{pattern} on the terminal: {self.text[-1000:]}")
        self.text = ""

    def read(self, patience_s):
        if select.select([self.descriptor], [], [], patience_s)[0]:
            try:
                self.text += os.read(self.descriptor, 4096).decode()
            except OSError:  # the other end is closed
                return False
        return True

    def press(self, key):
        os.write(self.descriptor, key)

    def status(self):
        while self.read(PATIENCE_S):
            pass
        return os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])


def keys(client, server, folder):
    command = scan_command(client, camera(2000), os.path.join(folder, "keys"), server.url)
    terminal = Terminal([os.path.abspath(command[0])] + command[1:])
    terminal.wait_for(r"fps .*tracked")
    terminal.press(b" ")
    terminal.wait_for("paused: space goes on")
    terminal.press(b" ")
    terminal.wait_for("fps")
    terminal.press(b"\x03")
    terminal.wait_for("no more frames: waiting for the result")
    check(terminal.status() == 0, "Ctrl-C finishes well")

    command = scan_command(client, camera(2000), os.path.join(folder, "keys2"), server.url)
    terminal = Terminal([os.path.abspath(command[0])] + command[1:])
    terminal.wait_for(r"fps .*tracked")
    terminal.press(b"\x03")
    time.sleep(1.5)
    terminal.press(b"\x03")
    started = time.monotonic()
    check(terminal.status() in (0, 1), "a second Ctrl-C stops at once")
    check(time.monotonic() - started < 10, "which is soon")


def main():
    parser = argument_parser()
    parser.add_argument("--frames", type=int, default=60)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        server = Server(arguments.hermite, os.path.join(folder, "data"))
        started = time.monotonic()
        away_for_a_third(arguments.hermite, arguments.client, server, folder, arguments.frames)
        server_comes_late(arguments.client, server, folder, arguments.frames // 3)
        killed_client(arguments.hermite, arguments.client, folder)
        full_disk(arguments.client, server, folder)
        keys(arguments.client, server, folder)
        server.end_well()
        verdict = "FAILED" if failures else "nothing lost, all results the same"
        print(f"{arguments.frames} frames, the server away for a third of them, {time.monotonic() - started:.0f} s: {verdict}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
