#!/usr/bin/python3
"""Lets the disk become read-only while a camera streams, as a file system does that has found an error in itself.

    read_only_disk.py path/to/hermite path/to/hermite-client

The data folder is on an ext4 of its own, in a file and a mount namespace of its own, mounted with errors=remount-ro. It is told that it has an
error: from then on it takes no write, also not to open files, and what was not synced is lost. Three things are looked at:

while a camera streams   the client is told so and ends, the state of the scan says why, /readyz says it, another scan is refused with
                         a message, the server lives and ends well; with a good disk again the scan is ended as interrupted, nothing that was
                         durable is missing
at a start               of a server with data and of one without: exit status 1, and a message that names the place
and the server dies      with a good disk again the scan goes on and has the result of an undisturbed one

Skipped (77) where namespaces, loop devices or ext4 may not be had.
"""
import os
import shutil
import signal
import subprocess
import sys
import tempfile

from frame_log import frames_in_log
from programs import FRAMES, PATIENCE_S, Camera, Server, check, durable_said, failures, free_port, log_of, readiness, stream_until, wait_until

SKIPPED = 77
IN_NAMESPACE = "HERMITE_TEST_IN_NAMESPACE"
DISK_BYTES = 256_000_000
FRAMES_BEFORE = 10
READ_ONLY = "Read-only file system"

os.environ["PATH"] += ":/usr/sbin:/sbin"


def skip(why):
    print("skipped:", why)
    sys.exit(SKIPPED)


class Disk:
    def __init__(self, folder):
        self.image = os.path.join(folder, "image")
        self.path = os.path.join(folder, "disk")
        os.mkdir(self.path)
        with open(self.image, "wb") as image:
            image.truncate(DISK_BYTES)
        self.run("mkfs.ext4", "-q", "-F", self.image)
        self.mount()

    @staticmethod
    def run(*command):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        if done.returncode != 0:
            skip(f"{' '.join(command[:1])}: {done.stdout.strip()}")
        return done.stdout.strip()

    def mount(self):
        self.run("mount", "-o", "loop,errors=remount-ro", self.image, self.path)
        device = os.path.basename(self.run("findmnt", "-no", "SOURCE", self.path))
        self.trigger = f"/sys/fs/ext4/{device}/trigger_fs_error"
        if not os.access(self.trigger, os.W_OK):
            skip(f"{self.trigger} cannot be written")

    def become_read_only(self):
        with open(self.trigger, "w", encoding="ascii") as trigger:
            trigger.write("told by a test")

    def repair(self):
        """Nobody has a file open there."""
        self.run("umount", self.path)
        # 1: errors were corrected.
        if subprocess.run(["e2fsck", "-fy", self.image], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode > 1:
            sys.exit("the file system cannot be repaired")
        self.mount()


def stream_into_it(server, client, disk, data, admin_port):
    camera, scan = stream_until(server, client, FRAMES_BEFORE)
    disk.become_read_only()
    check(camera.result() is None, "the client says that the scan did not go well")
    said = "".join(camera.lines)
    # A sync that is under way when the file system gives up answers EIO.
    check("cannot be stored" in said and (READ_ONLY in said or "Input/output error" in said), "the client is told why: " + said)
    (row,) = [row for row in server.scans() if row["id"] == scan]
    check(row["state"] in ("interrupted", "failed") and READ_ONLY in row["words"], f"the state says why: {row}")
    status, message = readiness(admin_port)
    check(status == 503 and "the disk: making a file in " + data in message and READ_ONLY in message, f"/readyz: {status} {message}")
    another = Camera(client, server.url)
    check(another.result() is None and READ_ONLY in "".join(another.lines), f"another scan is refused: {another.lines}")
    check(server.process.poll() is None, "the server lives")
    check(server.end(signal.SIGTERM) == 0, "the server ends well")
    return scan, row


def start_on_it(program, disk, data):
    for folder in (data, os.path.join(disk.path, "none yet")):
        done = subprocess.run([program, "serve", "--listen", "127.0.0.1:0", "--admin-listen", "off", "--data", folder],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=PATIENCE_S, check=False)
        check(done.returncode == 1 and done.stdout == "", f"exit status {done.returncode}: {done.stdout}")
        check(folder in done.stderr and READ_ONLY in done.stderr, "the message: " + done.stderr)
        print("at a start:", done.stderr.strip().replace(os.path.dirname(disk.path), "FOLDER"))


def look_at(disk, data, program, client):
    admin_port = free_port()
    server = Server(program, data, settings=("--admin-listen", f"127.0.0.1:{admin_port}", "--resume-window", "5", "--min-free-disk", "0"))
    try:
        break_disk(disk, data, admin_port, server, program, client)
    finally:
        if server.process.poll() is None:
            server.process.kill()


def break_disk(disk, data, admin_port, server, program, client):
    undisturbed = Camera(client, server.url).result()
    check(undisturbed is not None and undisturbed[0] == FRAMES, f"an undisturbed scan: {undisturbed}")

    scan, before = stream_into_it(server, client, disk, data, admin_port)
    start_on_it(program, disk, data)
    disk.repair()
    frames = frames_in_log(log_of(data, scan))
    # None of them where the first sync was under way: then none was acknowledged either. What was acknowledged is counted below.
    check(frames < FRAMES, f"{frames} of {FRAMES} frames are in the log")
    server.start()

    def row():
        return next(row for row in server.scans() if row["id"] == scan)

    wait_until(lambda: row()["state"] != "running", "the end of the scan")
    after = row()
    check(after["state"] == "interrupted" and after["frames_received"] == frames, f"with a good disk: {after}")

    camera, scan = stream_until(server, client, FRAMES_BEFORE)
    server.process.send_signal(signal.SIGSTOP)
    disk.become_read_only()
    server.end(signal.SIGKILL)
    wait_until(lambda: durable_said(camera.lines), "the client notices")
    disk.repair()
    kept = frames_in_log(log_of(data, scan))
    durable = durable_said(camera.lines)
    check(max(durable) <= kept < FRAMES, f"{durable} frames were durable, {kept} are in the log")
    server.start()
    result = camera.result()
    check(result == undisturbed, f"the scan goes on: {result}")
    if failures:
        print(server.tail())
    check(server.end(signal.SIGTERM) == 0, "the server ends well")
    print(f"read-only after {frames} frames; scan {before['state']}: {before['words']}; then {after['state']}. "
          f"Killed with {max(durable)} frames durable, {kept} in the log: {'FAILED' if failures else 'as it should be'}")


def main():
    if IN_NAMESPACE not in os.environ:
        if not shutil.which("unshare") or subprocess.run(["unshare", "--mount", "true"], stderr=subprocess.DEVNULL, check=False).returncode != 0:
            skip("no mount namespace may be made here")
        os.environ[IN_NAMESPACE] = "1"
        os.execvp("unshare", ["unshare", "--mount", "--propagation", "private", sys.executable, *sys.argv])
    # Mounts go with the namespace, loop devices with their mounts.
    with tempfile.TemporaryDirectory() as folder:
        disk = Disk(folder)
        # By a link, so that what the server says on stderr lies elsewhere.
        data = os.path.join(folder, "data")
        os.mkdir(os.path.join(disk.path, "data"))
        os.symlink(os.path.join(disk.path, "data"), data)
        try:
            look_at(disk, data, *sys.argv[1:3])
        finally:
            subprocess.run(["umount", "--lazy", disk.path], stderr=subprocess.DEVNULL, check=False)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
