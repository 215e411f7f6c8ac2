#!/usr/bin/python3
"""hermite token and hermite share, on a folder without a server and beside a running one; and what the command line says to typing errors.

    token_command_test.py path/to/hermite
"""
import http.client
import json
import os
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time

HERMITE = sys.argv[1]
SCAN = "abcdefghijklmnopqrstuvwxyz"


def hermite(*arguments):
    done = subprocess.run([HERMITE, *arguments], capture_output=True, text=True, timeout=60)
    return done.returncode, done.stdout.strip(), done.stderr


def must(*arguments):
    status, output, errors = hermite(*arguments)
    assert status == 0, (arguments, status, errors)
    return output


class Server:
    def __init__(self, data):
        self.log = tempfile.TemporaryFile()
        self.process = subprocess.Popen([HERMITE, "serve", "--listen", "127.0.0.1:0", "--data", data], stdout=subprocess.PIPE,
                                        stderr=self.log, text=True)
        self.address = self.process.stdout.readline().strip()
        self.port = int(self.address.split("/")[2].split(":")[1])

    def status(self, token):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        connection.request("GET", "/api/v1/scans", headers={"Authorization": "Bearer " + token})
        return connection.getresponse().status

    def stop(self):
        """What it logged."""
        self.process.send_signal(signal.SIGTERM)
        assert self.process.wait(60) == 0
        self.log.seek(0)
        return self.log.read().decode()


def add_scan(data):
    """A finished scan, as a server leaves it. Nobody else uses the database now."""
    database = sqlite3.connect(data + "/hermite.db")
    with database:
        database.execute(
            "INSERT INTO scans(id, title, phase, words, width, height, fx, fy, cx, cy, depth_units_per_metre, frames_received, frames_processed, "
            "frames_dropped, created_at_ms, finished_at_ms) VALUES(?, 't', 'finished', '', 640, 480, 525, 525, 319.5, 239.5, 5000, 0, 0, 0, 1, 2)",
            (SCAN,))
    database.close()


def all_bytes(folder):
    found = b""
    for where, _, names in os.walk(folder):
        for name in names:
            if name != "token":  # that is the one secret that is kept, for its owner
                with open(os.path.join(where, name), "rb") as file:
                    found += file.read()
    return found


def manage(data):
    """Creates, lists and revokes; returns the secrets."""
    token = must("token", "create", "--name", "robot", "--scope", "scan", "--days", "30", "--data", data)
    assert token.startswith("hmt_") and len(token) == 68, token
    rows = json.loads(must("token", "list", "--json", "--data", data))["tokens"]
    robot = [row for row in rows if row["name"] == "robot" and row["state"] == "active"]
    assert len(robot) == 1 and robot[0]["scopes"] == ["scan"], rows
    assert token not in must("token", "list", "--data", data)
    link = must("share", "create", SCAN, "--data", data, "--address", "https://scan.example.org")
    assert link.startswith("https://scan.example.org/#share=hms_") and link.endswith("&scan=" + SCAN), link
    share = json.loads(must("share", "list", "--json", "--data", data))["shares"][0]
    must("share", "revoke", share["id"], "--data", data)
    must("token", "revoke", robot[0]["id"], "--data", data)
    assert "revoked" in must("token", "list", "--data", data)
    for arguments in (("token", "revoke", "none"), ("share", "revoke", robot[0]["id"]), ("share", "create", SCAN[::-1])):
        status, _, message = hermite(*arguments, "--data", data)
        assert status == 1 and "there is no" in message, (arguments, status, message)
    status, _, message = hermite("token", "create", "--days", "-1", "--data", data)
    assert status != 0 and "0 to 3650" in message, message
    return [token, link.split("=")[1].split("&")[0]]


def typing_errors():
    status, output, _ = hermite("--version")
    assert status == 0 and output.startswith("hermite "), output
    status, _, errors = hermite("serv")
    assert status == 2 and 'there is no command "serv"; did you mean "serve"?' in errors, errors
    status, _, errors = hermite("zebra")
    assert status == 2 and "did you mean" not in errors and "reconstruct" in errors, errors
    status, _, errors = hermite()
    assert status == 2 and "--help" in errors, errors


def main():
    typing_errors()
    with tempfile.TemporaryDirectory() as folder:
        data = folder + "/data"
        status, _, message = hermite("token", "list", "--data", data)
        assert status == 2 and "no data folder" in message, (status, message)
        os.mkdir(data)
        must("token", "list", "--data", data)
        add_scan(data)
        secrets = manage(data)
        kept = must("token", "create", "--data", data)

        server = Server(data)
        first = server.address.split("#token=")[1]
        assert server.status(first) == 200 and server.status(kept) == 200, "made before the start"
        secrets += manage(data)
        made = must("token", "create", "--data", data)
        assert server.status(made) == 200
        identity = json.loads(must("token", "list", "--json", "--data", data))["tokens"][0]["id"]
        must("token", "revoke", identity, "--data", data)
        assert server.status(made) == 401, "at once"

        must("token", "revoke", "first", "--data", data)
        status, _, message = hermite("token", "list", "--data", data)
        assert status == 1 and "stop the server" in message, message
        log = server.stop()
        for secret in secrets + [first, kept, made]:
            assert secret not in log, "a secret in the log"
            assert secret.encode() not in all_bytes(data), "a secret in the data folder"

        again = Server(data)
        assert "#token" not in again.address, "a revoked first token is not offered"
        assert again.status(first) == 401 and again.status(kept) == 200
        again.stop()
        os.remove(data + "/token")
        anew = Server(data)
        assert anew.status(anew.address.split("#token=")[1]) == 200, "a new file brings a new first token"
        anew.stop()
    print("ok")


if __name__ == "__main__":
    started = time.monotonic()
    main()
    print("%.1f s" % (time.monotonic() - started))
