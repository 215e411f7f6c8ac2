#!/usr/bin/python3
"""A token uploads an archive of many tiny files, to use up the disk's inodes, of which a disk with much room may have few.

    no_inodes.py path/to/hermite path/to/hermite-client

Passes when the job waits and says why before the inodes are used up, a camera can scan meanwhile, and `/readyz` and a camera are told when the disk
has no inodes left. Skipped (77) where no mount namespace or tmpfs may be had.
"""
import io
import json
import os
import sys
import tarfile
import urllib.request

from full_disk import on_a_disk
from programs import FRAMES, PATIENCE_S, Camera, Server, check, failures, free_port, readiness, wait_until

INODES = 3000
KEPT_MB = 200  # and as many inodes


def archive_of(file_count):
    packed = io.BytesIO()
    with tarfile.open(fileobj=packed, mode="w:gz") as tar:
        for number in range(file_count):
            entry = tarfile.TarInfo(f"depth/{number}.png")
            entry.size = 8
            tar.addfile(entry, io.BytesIO(b"%08d" % number))
    return packed.getvalue()


def look_at(disk, data, program, client):
    admin_port = free_port()
    server = Server(program, data, settings=("--admin-listen", f"127.0.0.1:{admin_port}", "--min-free-disk", str(KEPT_MB), "--resume-window", "2"))
    try:
        request = urllib.request.Request(server.url.split("/#")[0] + "/api/v1/uploads/many.tar.gz", data=archive_of(2 * INODES), method="PUT",
                                         headers={"Authorization": "Bearer " + server.token()})
        with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
            job = json.load(answer)["job"]
        wait_until(lambda: server.ask("jobs/" + job)["words"], "the job says something")
        told = server.ask("jobs/" + job)
        print("job", told["state"], told["words"], os.statvfs(disk).f_favail)
        check(told["state"] in ("queued", "failed") and "inodes" in told["words"], f"the job says why: {told}")
        result = Camera(client, server.url).result()
        check(result is not None and result[0] == FRAMES, f"a camera scans: {result}")
        for number in range(os.statvfs(disk).f_favail):
            with open(os.path.join(disk, f"of another program {number}"), "wb"):
                pass
        status, message = readiness(admin_port)
        check(status == 503 and "are free" in message, f"/readyz: {status} {message}")
        camera = Camera(client, server.url)
        check(camera.result() is None and "not enough room" in "".join(camera.lines), f"a scan is refused: {camera.lines}")
        server.end_well()
    finally:
        if server.process.poll() is None:
            server.process.kill()


if __name__ == "__main__":
    sys.exit(on_a_disk(f"size=4g,nr_inodes={INODES}", look_at))
