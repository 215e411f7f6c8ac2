#!/usr/bin/python3
"""Kills the server with SIGKILL twice during an upload, and looks whether the client finishes it with the same bytes.

    kill_upload.py path/to/hermite path/to/hermite-client [--mb 60] [--seed 1]

Three clients: hermite-client upload; hermite-client upload that is killed as well and started again; tus-js-client (a stranger's, from
web/node_modules; left out, visibly, where that is not installed). What is sent is noise, so that its job fails and the upload stays to be
compared; the job must be there, once, and say why it failed. And curl does what server/README.md says.
"""
import glob
import hashlib
import os
import random
import signal
import shutil
import subprocess
import sys
import tempfile
import time

from programs import PATIENCE_S, Server, argument_parser, check, failures

HERE = os.path.dirname(os.path.abspath(__file__))
TUS_CLIENT = os.path.join(HERE, "tus_upload.mjs")
TUS_PACKAGE = os.path.join(HERE, "../../web/node_modules/tus-js-client")


def digest(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def uploads_in(data):
    return set(glob.glob(os.path.join(data, "uploads", "*")))


def wait_for_bytes(data, known, at_least, process):
    """Until the new upload has so many bytes, or its client has ended."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline and process.poll() is None:
        for path in uploads_in(data) - known:
            if os.path.getsize(path) >= at_least:
                return True
        time.sleep(0.001)
    return False


def disturbed(server, data, start, size, rng, kill_client):
    """Runs a client through two kills. Returns the path of the upload."""
    known = uploads_in(data)
    process = start()
    kills = 0
    for share in (rng.uniform(0.1, 0.4), rng.uniform(0.5, 0.8)):
        if not wait_for_bytes(data, known, int(share * size), process):
            break
        server.end(signal.SIGKILL)
        kills += 1
        if kill_client:
            process.kill()
            process.wait()
        time.sleep(0.2)
        server.start()
        if kill_client:
            process = start()
    out, err = process.communicate(timeout=PATIENCE_S)
    check(kills == 2, f"only {kills} kills: the upload was too quick\n{err}")
    check(process.returncode == 0, f"the client ends with {process.returncode}: {out} {err}")
    new = uploads_in(data) - known
    check(len(new) == 1, f"one upload, not {len(new)}: what was begun was gone on with")
    return min(new) if new else None


def failed_job(server, upload):
    """What the job of an upload that is none says."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        job = server.ask("jobs/" + os.path.basename(upload))
        if job["state"] == "failed":
            return job["words"]
        time.sleep(0.1)
    return ""


def curl_works(server, folder, source):
    """As in server/README.md."""
    address = server.url.split("/#token=")[0]
    process = subprocess.run(["curl", "-sS", "-T", source, "-H", "Authorization: Bearer " + server.token(), address + "/api/v1/uploads/"],
                             capture_output=True, text=True, timeout=PATIENCE_S)
    check('{"job":"' in process.stdout, f"curl: {process.stdout} {process.stderr}")


def main():
    parser = argument_parser()
    parser.add_argument("--mb", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    rng = random.Random(arguments.seed)
    started = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        data, source = os.path.join(folder, "data"), os.path.join(folder, "noise.bin")
        with open(source, "wb") as file:
            file.write(rng.randbytes(arguments.mb * 1_000_000))
        size, expected = os.path.getsize(source), digest(source)
        server = Server(arguments.hermite, data)
        environment = {**os.environ, "XDG_STATE_HOME": os.path.join(folder, "state")}
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "env": environment}

        def ours():
            return subprocess.Popen([arguments.client, "upload", source, "--no-check", "--server", server.url], **pipes)

        def strangers():
            return subprocess.Popen(["node", TUS_CLIENT, source, *server.url.split("/#token=")], **pipes)

        clients = [("hermite-client", ours, False), ("hermite-client, killed too", ours, True)]
        if os.path.isdir(TUS_PACKAGE) and shutil.which("node"):
            clients.append(("tus-js-client", strangers, False))
        else:
            print("SKIPPED: tus-js-client is not installed (npm --prefix web ci)")
        for name, start, kill_client in clients:
            begun = time.monotonic()
            upload = disturbed(server, data, start, size, rng, kill_client)
            if failures or not upload:
                break
            check(digest(upload) == expected, f"{name}: other bytes")
            check("is no recording we know" in failed_job(server, upload), f"{name}: its job says why it failed")
            print(f"{name}: {arguments.mb} MB through 2 kills, the same bytes, {time.monotonic() - begun:.1f} s", flush=True)
        check(len(server.ask("jobs")["jobs"]) == len(clients), "each upload has one job")
        curl_works(server, folder, source)
        server.end_well()
    print(f"{time.monotonic() - started:.0f} s: {'FAILED' if failures else 'all well'}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
