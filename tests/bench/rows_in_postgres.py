#!/usr/bin/python3
"""How long requests take whose rows are in PostgreSQL, beside SQLite. A measurement, no test.

    rows_in_postgres.py path/to/hermite path/to/hermite-client [--scans 1000] [--rounds 200]

Two servers of this machine with the same rows, which `hermite migrate` has moved for one of them; PostgreSQL (tests/support/postgres) runs
beside them and syncs its files. Prints the median of each time, in milliseconds, as a Markdown table:

list    GET /api/v1/scans, of all scans
one     GET /api/v1/scans/ID
change  PATCH /api/v1/scans/ID with other tags
"""
import os
import shutil
import signal
import sqlite3
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "faults"))
from postgres_rows import Postgres  # noqa: E402
from programs import Server, argument_parser  # noqa: E402


def add_scans(data, count):
    with sqlite3.connect(data + "/hermite.db") as database:
        columns = "id, title, phase, words, width, height, fx, fy, cx, cy, depth_units_per_metre, frames_received, frames_processed, " \
                  "frames_dropped, created_at_ms, finished_at_ms"
        database.executemany(f"INSERT INTO scans({columns}) VALUES(?, ?, 'finished', '', 640, 480, 525, 525, 320, 240, 1000, 9, 9, 0, ?, ?)",
                             [(f"{i:026d}", f"scan {i}", i, i) for i in range(1, count + 1)])
    database.close()


def median_ms(rounds, ask):
    times = []
    for i in range(rounds):
        begin = time.perf_counter()
        ask(i)
        times.append(1000 * (time.perf_counter() - begin))
    return statistics.median(times)


def measured(server, scans, rounds):
    scan = f"scans/{scans // 2:026d}"
    return (median_ms(rounds // 10, lambda i: server.ask("scans")), median_ms(rounds, lambda i: server.ask(scan)),
            median_ms(rounds, lambda i: server.ask(scan, "PATCH", {"tags": [f"tag {i}"]})))


def main():
    parser = argument_parser()
    parser.add_argument("--scans", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=200)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        postgres = Postgres(folder, "--sync")
        data, moved = os.path.join(folder, "file"), os.path.join(folder, "moved")
        settings = ["--admin-listen", "off", "--requests-per-second", "10000"]
        Server(arguments.hermite, data, settings).end(signal.SIGTERM)
        add_scans(data, arguments.scans)
        shutil.copytree(data, moved)
        begin = time.perf_counter()
        subprocess.run([arguments.hermite, "migrate", "--from", moved, "--to", postgres.url()], check=True, capture_output=True)
        moving_s = time.perf_counter() - begin
        print("| rows in | list | one | change |\n|---|---|---|---|")
        for name, place in (("SQLite", data), ("PostgreSQL", moved)):
            server = Server(arguments.hermite, place, settings)
            print("| %s | %.1f | %.1f | %.1f |" % (name, *measured(server, arguments.scans, arguments.rounds)))
            server.end(signal.SIGTERM)
        print(f"moving them took {moving_s:.1f} s")
        postgres.end()


if __name__ == "__main__":
    main()
