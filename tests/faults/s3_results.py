#!/usr/bin/python3
"""A server that keeps its results in S3, with a real S3 server (OpenStack Swift) and the real programs.

the same   a scan's results, whole and in parts by Range, are the bytes of a server that keeps them in its folder
away       S3 is killed while a scan ends: the camera is told, /readyz says so, and once S3 is back the same results appear by themselves
moved      `hermite migrate` to the folder and back, and a server starts only where its results are
wrong      no bucket, a wrong key, or a second folder on the same prefix: the server says so and does not start

    s3_results.py HERMITE HERMITE_CLIENT
"""
import hashlib
import os
import signal
import subprocess
import sys
import tempfile
import urllib.error
import urllib.request

from programs import PATIENCE_S, Camera, Server, argument_parser, check, free_port, readiness, stream_until, verdict, wait_until

SWIFT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../support/s3/swift_server.py")
RESULTS = ("cloud.ply", "trajectory.txt", "report.json")
SKIPPED = 77


class Swift:
    def __init__(self, folder):
        self.folder = folder
        self.port = 0
        self.start()

    def start(self):
        self.process = subprocess.Popen(["/usr/bin/python3", SWIFT, self.folder, "--port", str(self.port)], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True)
        self.port = int(self.process.stdout.readline() or 0)

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.process.stdin.close()
        self.process.stdout.close()


def key_file(folder, secret="testing"):
    path = os.path.join(folder, "key-" + secret)
    with open(os.open(path, os.O_CREAT | os.O_WRONLY, 0o600), "w", encoding="ascii") as file:
        file.write(f"aws_access_key_id = hermite:tests\naws_secret_access_key = {secret}\n")
    return path


def settings_of(swift, key):
    return ["--s3-endpoint", f"http://127.0.0.1:{swift.port}", "--s3-credentials", key]


def read(server, scan, name, part=None):
    """Bytes and entity tag of a result, or the status of the refusal."""
    headers = {"Authorization": "Bearer " + server.token()}
    if part:
        headers["Range"] = "bytes=%d-%d" % part
    request = urllib.request.Request(f"{server.url.split('/#')[0]}/api/v1/scans/{scan}/{name}", headers=headers)
    try:
        with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
            return answer.read(), answer.headers["ETag"]
    except urllib.error.HTTPError as refusal:
        return refusal.code, None


def row_of(server, scan):
    return next(row for row in server.scans() if row["id"] == scan)


def hashes(server, scan):
    """Of what does not depend on time or folder."""
    return [hashlib.sha256(read(server, scan, name)[0]).hexdigest() for name in RESULTS[:2]]


def same_bytes(remote, local, client):
    """Returns the scan of each server."""
    scans = []
    for server in (remote, local):
        camera = Camera(client, server.url)
        check(camera.result() is not None, f"a scan: {camera.lines}")
        scans.append(server.scans()[0]["id"])
    check(hashes(remote, scans[0]) == hashes(local, scans[1]), "the results in S3 are those in the folder")
    whole, tag = read(remote, scans[0], "cloud.ply")
    check(tag and len(whole) > 1000, f"a cloud with an entity tag: {tag}")
    for first, last in ((0, 99), (100, 1000), (len(whole) - 5, len(whole) - 1), (7, len(whole) + 100)):
        check(read(remote, scans[0], "cloud.ply", (first, last))[0] == whole[first:last + 1], f"bytes {first} to {last}")
    check(read(remote, scans[0], "cloud.ply", (len(whole), len(whole) + 1))[0] == 416, "no bytes behind the end")
    check(read(remote, scans[0], "none.ply")[0] == 404, "no other file")
    return scans


def away(remote, client, swift, admin_port, expected):
    camera, scan = stream_until(remote, client, 5)
    swift.kill()
    check(camera.result() is None, "the client says that the scan did not go well")
    said = "".join(camera.lines)
    check("cannot be stored" in said and "does not answer" in said, "the camera is told: " + said)
    row = row_of(remote, scan)
    check(row["to_be_rebuilt"] and "once it answers" in row["words"], f"the scan is to be rebuilt: {row}")
    status, message = readiness(admin_port)
    check(status == 503 and "the results" in message and str(swift.port) in message, f"/readyz: {status} {message}")
    check(read(remote, scan, "cloud.ply")[0] == 404, "it has no results yet")
    swift.start()
    wait_until(lambda: not row_of(remote, scan)["to_be_rebuilt"] and row_of(remote, scan)["state"] != "running", "the results appear")
    check(hashes(remote, scan) == expected, "they are the same as of the other scan")
    wait_until(lambda: "the results" not in readiness(admin_port)[1], "/readyz is content")
    return scan


def starts(program, data, *settings):
    """Whether a server starts, and what it says."""
    try:
        done = subprocess.run([program, "serve", "--listen", "127.0.0.1:0", "--admin-listen", "off", "--data", data, *settings],
                              capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    except subprocess.TimeoutExpired:
        return "it started"
    return done.stderr


def says_what_is_wrong(program, folder, swift, key, data):
    settings = settings_of(swift, key)
    new = os.path.join(folder, "new")
    check("no such bucket" in starts(program, new, "--blobs", "s3://nowhere/a", *settings), "no bucket")
    check("secret key" in starts(program, new, "--blobs", "s3://scans/a", *settings_of(swift, key_file(folder, "wrong"))), "a wrong key")
    check("belongs to another folder" in starts(program, new, "--blobs", "s3://scans/a/b", *settings), "a prefix of another folder")
    check("are in s3://scans/a/b" in starts(program, data), "a folder whose results are in S3")
    os.chmod(key, 0o644)
    check("chmod 600" in starts(program, new, "--blobs", "s3://scans/a", *settings), "a key that others can read")
    os.chmod(key, 0o600)


def migrate(program, source, target, settings):
    done = subprocess.run([program, "migrate", "--from", source, "--to", target, *settings], capture_output=True, text=True,
                          timeout=PATIENCE_S, check=False)
    check(done.returncode == 0, f"migrate: {done.stdout} {done.stderr}")


def moved(program, remote, swift, key, data):
    """Without and with S3 the scans are the same, and there is nothing left where they were."""
    scans = {scan["id"]: hashes(remote, scan["id"]) for scan in remote.scans()}
    check(remote.end(signal.SIGTERM) == 0, "the server ends well")
    settings = settings_of(swift, key)
    migrate(program, "s3://scans/a/b", data, settings)
    local = Server(program, data, ["--admin-listen", "off"])
    check({scan: hashes(local, scan) for scan in scans} == scans, "the same in the folder")
    local.end_well()
    check("hermite migrate" in starts(program, data, "--blobs", "s3://scans/a/b", *settings), "results in the folder are to be moved first")
    migrate(program, data, "s3://scans/a/b", settings)
    left = [name for scan in scans for name in os.listdir(os.path.join(data, "scans", scan)) if name != "log"]
    check(not left, f"nothing is left in the folder: {left}")
    again = Server(program, data, ["--admin-listen", "off", "--blobs", "s3://scans/a/b", *settings])
    check({scan: hashes(again, scan) for scan in scans} == scans, "the same in S3 again")
    again.ask("scans/" + next(iter(scans)), "DELETE")
    check(len(again.scans()) == len(scans) - 1, "one is removed")
    again.end_well()


def main():
    arguments = argument_parser().parse_args()
    with tempfile.TemporaryDirectory() as folder:
        swift = Swift(os.path.join(folder, "swift"))
        if swift.port == 0:
            print("skipped: python3-swift (deploy/packages.txt) is not installed")
            return SKIPPED
        key = key_file(folder)
        data, admin_port = os.path.join(folder, "remote"), free_port()
        remote = Server(arguments.hermite, data,
                        ["--admin-listen", f"127.0.0.1:{admin_port}", "--blobs", "s3://scans/a/b", *settings_of(swift, key)])
        local = Server(arguments.hermite, os.path.join(folder, "local"), ["--admin-listen", "off"])
        scans = same_bytes(remote, local, arguments.client)
        local.end_well()
        away(remote, arguments.client, swift, admin_port, hashes(remote, scans[0]))
        moved(arguments.hermite, remote, swift, key, data)
        says_what_is_wrong(arguments.hermite, folder, swift, key, data)
        swift.kill()
    return verdict()


if __name__ == "__main__":
    sys.exit(main())
