#!/usr/bin/python3
"""Twenty jobs on two workers: the server is killed with SIGKILL while two run, one job is cancelled, one is a bad archive.

    job_queue.py path/to/hermite path/to/hermite-client [--kills 1] [--frames 5]

Passes when the right 18 finish, each exactly once and with the same result, and the other two say why and leave nothing.
"""
import json
import os
import signal
import subprocess
import sys
import tempfile
import time

from programs import PATIENCE_S, Server, argument_parser, check, failures

GOOD = 18


def states(server):
    return {job["title"]: job for job in server.ask("jobs")["jobs"]}


def wait_until(server, condition, what):
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        jobs = states(server)
        if condition(jobs):
            return jobs
        time.sleep(0.05)
    sys.exit(f"never: {what}; {[(title, job['state']) for title, job in jobs.items()]}")


def count(jobs, state):
    return sum(job["state"] == state for job in jobs.values())


def submit(client, server, folder, path, title, *more):
    process = subprocess.run([client, "upload", path, "--title", title, "--no-check", "--json", "--server", server.url, *more],
                             capture_output=True, text=True, timeout=PATIENCE_S, env={**os.environ, "XDG_STATE_HOME": folder + "/state"})
    check(process.returncode == 0, f"upload of {title}: {process.stdout} {process.stderr}")
    return json.loads(process.stdout)["job"]


def record(hermite, folder, name, frames):
    path = os.path.join(folder, name)
    subprocess.run([hermite, "convert", f"synthetic:frames={frames},width=160,height=120,seed=1", path, "--to", "tum"], check=True,
                   stdout=subprocess.DEVNULL)
    return path


def main():
    parser = argument_parser()
    parser.add_argument("--kills", type=int, default=1)
    parser.add_argument("--frames", type=int, default=5)
    arguments = parser.parse_args()
    started = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        room = record(arguments.hermite, folder, "room", arguments.frames)
        long_room = record(arguments.hermite, folder, "long", 300)
        bad = os.path.join(folder, "bad.tar")
        subprocess.run(["tar", "-C", folder, "-cf", bad, "room"], check=True)
        with open(bad, "r+b") as file:
            file.truncate(os.path.getsize(bad) // 2)
        server = Server(arguments.hermite, os.path.join(folder, "data"), settings=("--job-workers", "2"))
        cancelled = submit(arguments.client, server, folder, long_room, "cancelled", "--priority", "50")
        wait_until(server, lambda jobs: jobs["cancelled"]["stage"] == "tracking", "the long job runs")
        server.ask("jobs/" + cancelled, "DELETE")
        submit(arguments.client, server, folder, bad, "bad")
        for number in range(GOOD):
            submit(arguments.client, server, folder, room, f"good {number}")
        for kill in range(arguments.kills):
            finished = GOOD * (kill + 1) // (arguments.kills + 2)
            wait_until(server, lambda jobs: count(jobs, "finished") >= finished and count(jobs, "running") == 2, "two run")
            server.end(signal.SIGKILL)
            server.start()
        jobs = wait_until(server, lambda jobs: count(jobs, "running") + count(jobs, "queued") == 0, "all end")
        good = [job for title, job in jobs.items() if title.startswith("good")]
        check(len(jobs) == GOOD + 2, f"{len(jobs)} jobs")
        check(all(job["state"] == "finished" for job in good), f"the good ones finish: {good}")
        check(jobs["cancelled"]["state"] == "cancelled", f"the cancelled one: {jobs['cancelled']}")
        check(jobs["bad"]["state"] == "failed" and "cut short" in jobs["bad"]["words"], f"the bad one: {jobs['bad']}")
        scans = server.ask("scans")["scans"]
        check(sorted(scan["id"] for scan in scans) == sorted(job["scan"] for job in good), "one scan a good job, and no other")
        check(all(scan["state"] == "finished" for scan in scans), "every scan is finished")
        results = {server.ask(f"scans/{scan['id']}/report.json")["cloud_sha256"] for scan in scans}
        check(len(results) == 1, f"the same result each time, not {len(results)}")
        again = sum(job["attempts"] > 1 for job in good)
        check(again >= 1, "some job was running when the server died")
        check(sorted(os.listdir(os.path.join(folder, "data/scans"))) == sorted(scan["id"] for scan in scans), "no half scan is left")
        server.end_well()
    print(f"20 jobs on 2 workers, {arguments.kills} kill(s), {again} jobs begun again, {time.monotonic() - started:.0f} s: "
          f"{'FAILED' if failures else '18 finished once, 1 cancelled, 1 failed in words'}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
