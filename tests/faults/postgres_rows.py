#!/usr/bin/python3
"""A server that keeps its rows in PostgreSQL, with a real PostgreSQL and the real programs.

the same   a scan's results are the bytes of a server with SQLite
away       PostgreSQL is killed while a camera streams: the scan goes on and ends with the same results, /readyz says what is missing, and
           once it is back the rows say how the scan ended
killed     the server is killed while it scans and started again: the scan is resumed
moved      `hermite migrate` to the folder and back, a backup, tokens, and a server that starts only with the rows of its folder

    postgres_rows.py HERMITE HERMITE_CLIENT
"""
import json
import os
import signal
import subprocess
import sys
import tempfile
import urllib.error

from programs import PATIENCE_S, Camera, Server, argument_parser, check, free_port, readiness, stream_until, verdict, wait_until
from s3_results import hashes, row_of, starts

POSTGRES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../support/postgres/postgres_server.py")
SKIPPED = 77


class Postgres:
    def __init__(self, folder, *settings):
        self.process = subprocess.Popen(["/usr/bin/python3", POSTGRES, folder, *settings], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.port = int(self.process.stdout.readline() or 0)

    def command(self, line):
        print(line, file=self.process.stdin, flush=True)
        self.process.stdout.readline()

    def url(self):
        return f"postgresql://hermite@127.0.0.1:{self.port}/postgres"

    def end(self):
        self.process.stdin.close()
        self.process.wait()


def scanned(server, client):
    camera = Camera(client, server.url)
    check(camera.result() is not None, f"a scan: {camera.lines}")
    return server.scans()[0]["id"]


def refusal(server):
    """Status, code and Retry-After of a request for the scans."""
    try:
        server.scans()
    except urllib.error.HTTPError as error:
        with error:
            return error.code, json.load(error)["error"]["code"], error.headers["Retry-After"]
    return 200, "", ""


def away(server, client, postgres, admin_port, expected):
    camera, scan = stream_until(server, client, 5)
    postgres.command("crash")
    wait_until(lambda: readiness(admin_port)[0] == 503, "/readyz notices")
    check("database" in readiness(admin_port)[1], f"/readyz names it: {readiness(admin_port)}")
    status, code, pause_s = refusal(server)
    check((status, code) == (503, "unavailable") and int(pause_s) >= 1, f"a request may come again: {status} {code} {pause_s}")
    check(camera.result() is not None, f"the scan goes on and ends: {camera.lines}")
    postgres.command("start")
    wait_until(lambda: readiness(admin_port)[0] == 200, "/readyz is content")
    wait_until(lambda: row_of(server, scan)["state"] == "finished", "its row says so")
    check(hashes(server, scan) == expected, "with the same results")


def killed(server, client, expected):
    camera, scan = stream_until(server, client, 5)
    server.end(signal.SIGKILL)
    server.start()
    check(camera.result() is not None, f"the scan is resumed: {camera.lines}")
    check(hashes(server, scan) == expected, "with the same results")
    # The end of the scan before may not have been stored yet when the server was killed: then it is made again from its frames.
    wait_until(lambda: all(row["state"] == "finished" for row in server.scans()), "all scans have ended")


def run(program, *arguments):
    done = subprocess.run([program, *arguments], capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    check(done.returncode == 0, f"hermite {arguments[0]}: {done.stdout} {done.stderr}")
    return done.stdout


def moved(program, server, postgres, folder, data):
    scans = {scan["id"]: hashes(server, scan["id"]) for scan in server.scans()}
    run(program, "backup", "--data", data, "--to", os.path.join(folder, "backup"))
    check("another Hermite server" in starts(program, os.path.join(folder, "new"), "--database", postgres.url()), "one server at a time")
    check(server.end(signal.SIGTERM) == 0, "the server ends well")
    check("first" in run(program, "token", "list", "--data", data), "tokens are found without an address")
    check("another folder" in starts(program, os.path.join(folder, "new"), "--database", postgres.url()), "the database of another folder")
    run(program, "migrate", "--from", postgres.url(), "--to", data)
    check("move them first" in starts(program, data, "--database", postgres.url()), "rows in the file are to be moved first")
    run(program, "restore", "--from", os.path.join(folder, "backup"), "--data", os.path.join(folder, "restored"))
    for place in (data, os.path.join(folder, "restored")):
        local = Server(program, place, ["--admin-listen", "off"])
        check({scan["id"]: hashes(local, scan["id"]) for scan in local.scans()} == scans, f"the same scans in {place}")
        local.end_well()
    run(program, "migrate", "--from", data, "--to", postgres.url())
    again = Server(program, data, ["--admin-listen", "off"])
    again.ask("scans/" + next(iter(scans)), "DELETE")
    check(len(again.scans()) == len(scans) - 1, "one is removed")
    again.end_well()
    check(not os.path.exists(os.path.join(data, "hermite.db")), "no new file was made")


def main():
    arguments = argument_parser().parse_args()
    with tempfile.TemporaryDirectory() as folder:
        postgres = Postgres(folder)
        if postgres.port == 0:
            print("skipped: postgresql-15 (deploy/packages.txt) is not installed")
            return SKIPPED
        data, admin_port = os.path.join(folder, "data"), free_port()
        server = Server(arguments.hermite, data, ["--admin-listen", f"127.0.0.1:{admin_port}", "--database", postgres.url()])
        local = Server(arguments.hermite, os.path.join(folder, "local"), ["--admin-listen", "off"])
        expected = hashes(local, scanned(local, arguments.client))
        local.end_well()
        check(hashes(server, scanned(server, arguments.client)) == expected, "the results are those of a server with SQLite")
        away(server, arguments.client, postgres, admin_port, expected)
        killed(server, arguments.client, expected)
        moved(arguments.hermite, server, postgres, folder, data)
        postgres.end()
    return verdict()


if __name__ == "__main__":
    sys.exit(main())
