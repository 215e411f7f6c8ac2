#!/usr/bin/python3
"""Lets a disk become full while a camera streams: a real one, a tmpfs of its own in a mount namespace of its own.

    full_disk.py path/to/hermite path/to/hermite-client

no room to begin    a camera is refused with a message before its first frame, /readyz says why
nearly full         the scan that runs ends as interrupted while there is room for its results, and has them
full to the last    another program takes every byte: the camera is told so and ends, the server lives, the scan ends as interrupted, its
byte                frames stay and nothing that was told to be durable is missing. When there is room again its results are made by
                    themselves, of every frame in its log
job                 one that the disk becomes too full for is queued again, says so, and is done when there is room
and killed          the same, and the server is killed while nothing can be written: the next one makes the results

Skipped (77) where no mount namespace or tmpfs may be had.
"""
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import urllib.error
import urllib.request

from frame_log import frames_in_log
from programs import FRAMES, PATIENCE_S, Camera, Server, check, durable_said, failures, free_port, log_of, readiness, stream_until, wait_until

SKIPPED = 77
IN_NAMESPACE = "HERMITE_TEST_IN_NAMESPACE"
DISK_MB = 300
FRAMES_BEFORE = 10
JOB_FRAMES = 80


def skip(why):
    print("skipped:", why)
    sys.exit(SKIPPED)


class Filler:
    """Another program that takes what there is, but for so many bytes."""

    def __init__(self, folder):
        self.path = os.path.join(folder, "of another program")

    def leave(self, left_bytes):
        self.go()
        with open(self.path, "wb") as file:
            size, piece = 0, 1 << 20
            while piece >= 4096:
                status = os.statvfs(self.path)
                room = status.f_bavail * status.f_frsize - left_bytes
                try:
                    if room < piece:
                        raise OSError
                    os.posix_fallocate(file.fileno(), size, piece)
                    size += piece
                except OSError:
                    piece //= 2

    def go(self):
        if os.path.exists(self.path):
            os.unlink(self.path)


def row_of(server, scan):
    return next(row for row in server.scans() if row["id"] == scan)


def result_of(server, scan, name):
    """Bytes of a result, or the status of the refusal."""
    request = urllib.request.Request(f"{server.url.split('/#')[0]}/api/v1/scans/{scan}/{name}",
                                     headers={"Authorization": "Bearer " + server.token()})
    try:
        with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
            return answer.read()
    except urllib.error.HTTPError as refusal:
        return refusal.code


def begin_on_it(server, client, filler, admin_port):
    filler.leave(20_000_000)
    camera = Camera(client, server.url)
    check(camera.result() is None and "not enough room" in "".join(camera.lines), f"a scan is refused: {camera.lines}")
    check(not server.scans(), "no scan has begun")
    status, message = readiness(admin_port)
    check(status == 503 and "MB are free" in message, f"/readyz: {status} {message}")
    filler.go()


def come_near(server, client, filler):
    camera, scan = stream_until(server, client, FRAMES_BEFORE)
    filler.leave(40_000_000)  # of the 50 MB that are to stay free
    check(camera.result() is None and "nearly full" in "".join(camera.lines), f"the client is told why: {camera.lines}")
    row = row_of(server, scan)
    check(row["state"] == "interrupted" and "nearly full" in row["words"] and not row["to_be_rebuilt"], f"nearly full: {row}")
    check(isinstance(result_of(server, scan, "cloud.ply"), bytes), "it has its results")
    filler.go()
    return row


def fill(server, client, filler, data):
    camera, scan = stream_until(server, client, FRAMES_BEFORE)
    filler.leave(0)
    check(camera.result() is None, "the client says that the scan did not go well")
    said = "".join(camera.lines)
    check("cannot be stored" in said or "nearly full" in said, "the client is told why: " + said)
    check(data not in said and os.path.realpath(data) not in said, "no path of the server is told: " + said)
    check(server.process.poll() is None, "the server lives")
    wait_until(lambda: row_of(server, scan)["state"] != "running", "the end of the scan")
    row = row_of(server, scan)
    check(row["state"] == "interrupted" and row["to_be_rebuilt"] and "when there is room" in row["words"], f"full: {row}")
    check(result_of(server, scan, "cloud.ply") == 404, "it has no results")
    frames = frames_in_log(log_of(data, scan))
    check(0 < frames <= FRAMES, f"{frames} of {FRAMES} frames are in the log")
    durable = durable_said(camera.lines)
    check(all(count <= frames for count in durable), f"what was durable is there: {durable}, {frames}")
    return scan, frames, row


def is_rebuilt(server, scan, frames):
    wait_until(lambda: not row_of(server, scan)["to_be_rebuilt"] and row_of(server, scan)["state"] != "running", "the scan is rebuilt")
    row = row_of(server, scan)
    check(row["state"] == "interrupted" and row["frames_processed"] == frames, f"rebuilt: {row}")
    trajectory = result_of(server, scan, "trajectory.txt")
    lines = [line for line in trajectory.decode().splitlines() if not line.startswith("#")] if isinstance(trajectory, bytes) else trajectory
    check(isinstance(lines, list) and len(lines) == frames, f"{frames} frames have a pose: {lines}")
    check(isinstance(result_of(server, scan, "cloud.ply"), bytes), "and there is a cloud")


def job_waits(server, program, client, filler, folder):
    recording = os.path.join(folder, "recording")
    subprocess.run([program, "convert", f"synthetic:frames={JOB_FRAMES},width=160,height=120,seed=1", recording, "--to", "tum"], check=True,
                   stdout=subprocess.DEVNULL)
    sent = subprocess.run([client, "upload", recording, "--title", "of a job", "--no-check", "--json", "--server", server.url], capture_output=True,
                          text=True, check=False, env={**os.environ, "XDG_STATE_HOME": folder + "/state"})
    check(sent.returncode == 0, f"upload: {sent.stdout} {sent.stderr}")
    job = json.loads(sent.stdout)["job"]
    wait_until(lambda: server.ask("jobs/" + job)["stage"] == "tracking", "the job tracks")
    filler.leave(40_000_000)
    wait_until(lambda: server.ask("jobs/" + job)["words"], "the job says something")
    told = server.ask("jobs/" + job)
    check(told["state"] == "queued" and "nearly full" in told["words"], f"the job waits: {told}")
    filler.go()
    wait_until(lambda: server.ask("jobs/" + job)["state"] not in ("queued", "running"), "the job ends")
    told = server.ask("jobs/" + job)
    check(told["state"] == "finished" and row_of(server, told["scan"])["frames_processed"] == JOB_FRAMES, f"the job is done: {told}")


def look_at(disk, data, program, client):
    filler = Filler(disk)
    admin_port = free_port()
    server = Server(program, data, settings=("--admin-listen", f"127.0.0.1:{admin_port}", "--min-free-disk", "50", "--resume-window", "2"))
    try:
        begin_on_it(server, client, filler, admin_port)
        come_near(server, client, filler)
        scan, frames, row = fill(server, client, filler, data)
        filler.go()
        is_rebuilt(server, scan, frames)

        job_waits(server, program, client, filler, os.path.dirname(data))

        killed_scan, killed_frames, _ = fill(server, client, filler, data)
        server.end(signal.SIGKILL)
        filler.go()
        server.start()
        is_rebuilt(server, killed_scan, killed_frames)

        result = Camera(client, server.url).result()
        check(result is not None and result[0] == FRAMES, f"a scan on a disk with room: {result}")
        server.end_well()
        print(f"disk full with {frames} frames in the log; scan {row['state']}: {row['words']}; rebuilt: "
              f"{'FAILED' if failures else 'as it should be'}")
    finally:
        if server.process.poll() is None:
            server.process.kill()


def on_a_disk(options, look):
    """Runs it with that disk, and a data folder there. Returns the status of the program."""
    if IN_NAMESPACE not in os.environ:
        how = ["unshare", "--mount", "--propagation", "private"] + ([] if os.geteuid() == 0 else ["--map-root-user"])
        if not shutil.which("unshare") or subprocess.run([*how, "true"], stderr=subprocess.DEVNULL, check=False).returncode != 0:
            skip("no mount namespace may be made here, so no disk was filled")
        os.environ[IN_NAMESPACE] = "1"
        os.execvp("unshare", [*how, sys.executable, *sys.argv])
    with tempfile.TemporaryDirectory() as folder:
        disk = os.path.join(folder, "disk")
        os.mkdir(disk)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", options, "none", disk], stderr=subprocess.DEVNULL, check=False).returncode != 0:
            skip("no tmpfs may be mounted here, so no disk was filled")
        # By a link, so that what the server says on stderr lies elsewhere.
        data = os.path.join(folder, "data")
        os.mkdir(os.path.join(disk, "data"))
        os.symlink(os.path.join(disk, "data"), data)
        try:
            look(disk, data, *sys.argv[1:3])
        finally:
            subprocess.run(["umount", "--lazy", disk], stderr=subprocess.DEVNULL, check=False)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(on_a_disk(f"size={DISK_MB}m", look_at))
