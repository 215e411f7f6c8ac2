#!/usr/bin/python3
"""Batch jobs on a real Slurm cluster of two nodes, all on this machine, with a real server and real clients.

same       a recording and a scan that is processed again have the hashes of `hermite reconstruct`
stopped    a job that is told to leave, as before its time limit, goes on from its checkpoint in a second attempt
cancelled  by the client: the job leaves Slurm; by scancel: the job fails and says so
go_on      a node is cut off while a job runs, and Slurm gives the job to the other one. The process of the first node lives on and writes its
           result, which nobody reads; then the server is killed: the next one finds the job, and does not submit it again
away       slurmctld is down when a job comes: the job says so, and runs once it is back

    slurm_jobs.py HERMITE HERMITE_CLIENT
"""
import concurrent.futures
import contextlib
import functools
import glob
import json
import os
import signal
import subprocess
import sys
import tempfile
import time

from programs import Server, argument_parser, check, verdict

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../support/slurm"))
from slurm_cluster import SKIPPED, Cluster, DoesNotRun, processes_with, why_not  # noqa: E402

PATIENCE_S = 120
POLL_S = 2  # of the server
LONG = 100  # frames, some seconds of work
SETTINGS = ("--batch", "slurm", "--slurm-memory", "1000", "--checkpoint-period", "200", "--slurm-jobs", "8")


def sequence(frames, seed=1):
    return f"synthetic:frames={frames},width=160,height=120,seed={seed}"


class World:
    """The cluster, the server in front of it, and a recording of each length."""

    def __init__(self, arguments, folder, cluster):
        self.arguments = arguments
        self.folder = folder
        self.cluster = cluster
        self.recordings = {}
        self.server = Server(arguments.hermite, folder + "/data", settings=SETTINGS, environment=self.cluster.environment)

    def recording(self, frames):
        if frames not in self.recordings:
            path = f"{self.folder}/room{frames}"
            subprocess.run([self.arguments.hermite, "convert", sequence(frames), path, "--to", "tum"], check=True, stdout=subprocess.DEVNULL)
            self.recordings[frames] = path
        return self.recordings[frames]

    def submit(self, frames, title):
        command = [self.arguments.client, "upload", self.recording(frames), "--title", title, "--no-check", "--json", "--server", self.server.url]
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S,
                              env={**os.environ, "XDG_STATE_HOME": f"{self.folder}/state-{title.replace(' ', '-')}"})
        check(done.returncode == 0, f"upload of {title}: {done.stdout} {done.stderr}")
        return json.loads(done.stdout)["job"]

    def job(self, job):
        return self.server.ask("jobs/" + job)

    def wait(self, job, condition, what):
        deadline = time.monotonic() + PATIENCE_S
        while not condition(now := self.job(job)):
            if time.monotonic() > deadline:
                print(self.cluster.ask("squeue", "--states=all"), self.server.tail())
                sys.exit(f"never: {what}; {now}")
            time.sleep(0.1)
        return now

    def end_of(self, job):
        return self.wait(job, lambda now: now["state"] in ("finished", "failed", "cancelled"), "the job ends")

    def runs(self, job, frames):
        """As the node says, which is sooner than the server hears it."""

        def done():
            for path in glob.glob(f"{self.folder}/data/slurm/{job}/attempt-*/run-*/progress.json"):
                with open(path, encoding="utf-8") as file:
                    progress = json.load(file)
                if progress["stage"] == "tracking" and progress["done"] >= frames:
                    return True
            return False

        self.cluster.wait(done, f"{frames} frames are done")

    def in_slurm(self, job):
        """What Slurm knows of the job's attempts, the oldest first."""
        rows = [row for row in self.cluster.jobs().values() if job in row["name"]]
        return sorted(rows, key=lambda row: int(row["number"]))

    def hashes(self, scan):
        report = self.server.ask(f"scans/{scan}/report.json")
        return report["trajectory_sha256"], report["cloud_sha256"]

    @functools.cache
    def expected(self, frames):
        out = f"{self.folder}/expected{frames}"
        subprocess.run([self.arguments.hermite, "reconstruct", self.recording(frames), "--out", out], check=True, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)
        with open(out + "/report.json", encoding="utf-8") as file:
            report = json.load(file)
        return report["trajectory_sha256"], report["cloud_sha256"]

    def finished_well(self, job, frames, what):
        report = self.end_of(job)
        check(report["state"] == "finished", f"{what}: {report}")
        if report["state"] != "finished":
            return report
        scans = [scan for scan in self.server.scans() if scan["title"] == report["title"]]
        check([scan["id"] for scan in scans] == [report["scan"]], f"{what}: one scan, not {scans}")
        check(scans[0]["state"] == "finished" and scans[0]["frames_processed"] == frames and scans[0]["width"] == 160, f"{what}: {scans}")
        check(self.hashes(report["scan"]) == self.expected(frames), f"{what}: the bits of a local run")
        check(len(self.server.ask(f"scans/{report['scan']}/frames")["timestamps_s"]) == frames, f"{what}: its frames are kept")
        return report

    def words(self, job):
        return " / ".join(line["words"] for line in self.job(job)["log"])


class CutOff:
    """A job whose node is cut off while it runs; its process there stands still."""

    def __init__(self, world):
        self.world = world
        self.job = world.submit(LONG, "node dies")
        world.runs(self.job, 5)
        (self.row,) = world.in_slurm(self.job)
        folder = f"{world.folder}/data/slurm/{self.job}"
        (attempt,) = os.listdir(folder)
        self.attempt = f"{folder}/{attempt}"
        (self.worker,) = self.workers()
        # No other job is to be sent there before Slurm has seen that it is gone.
        world.cluster.ask("scontrol", "update", "NodeName=" + self.row["node"], "State=DRAIN", "Reason=test")
        world.cluster.cut_off(self.row["node"], self.row["number"])
        os.kill(self.worker, signal.SIGSTOP)  # not before: a stopped group whose parent ends gets SIGHUP

    def workers(self):
        return processes_with("work\0" + self.attempt)

    def others(self):
        return [process for process in self.workers() if process != self.worker]

    def go_on(self):
        cluster = self.world.cluster
        cluster.wait(lambda: self.world.in_slurm(self.job)[0]["state"] == "PENDING", "Slurm sees that the node is gone")
        cluster.ask("scontrol", "update", "JobId=" + self.row["number"], "StartTime=now")  # it waits two minutes by itself
        cluster.wait(self.others, "the job has begun elsewhere")
        (other,) = self.others()
        os.kill(other, signal.SIGSTOP)
        (now,) = self.world.in_slurm(self.job)
        check(now["restarts"] == "1" and now["node"] != self.row["node"], f"the other node has it: {now}")
        os.kill(self.worker, signal.SIGCONT)
        cluster.wait(lambda: os.path.exists(self.attempt + "/run-0/outcome.json"), "the result of the dead node is there")
        time.sleep(2 * POLL_S)
        check(self.world.job(self.job)["state"] == "running", f"nobody reads it: {self.world.job(self.job)}")
        self.world.server.end(signal.SIGKILL)
        os.kill(other, signal.SIGCONT)
        self.world.server.start()
        self.world.finished_well(self.job, LONG, "a job whose node died, and its server")
        check(len(self.world.in_slurm(self.job)) == 1, f"it was submitted once: {self.world.in_slurm(self.job)}")
        words = self.world.words(self.job)
        check("put the job back" in words and "went on without it" in words, words)


def same(world):
    job = world.submit(8, "same")
    report = world.finished_well(job, 8, "a job")
    again = world.server.ask("jobs", "POST", {"scan": report["scan"], "title": "again"})["id"]
    world.finished_well(again, 8, "a scan that is processed again")
    check(len(world.in_slurm(job)) == 1 and len(world.in_slurm(again)) == 1, "each was in Slurm once")


def stopped(world):
    job = world.submit(LONG, "stopped")
    world.runs(job, 5)
    (row,) = world.in_slurm(job)
    world.cluster.ask("scancel", "--batch", "--signal=TERM", row["number"])  # as Slurm does before the time limit
    world.finished_well(job, LONG, "a job that was told to leave")
    check(len(world.in_slurm(job)) == 2, f"two attempts: {world.in_slurm(job)}")
    words = world.words(job)
    check("told to leave" in words and "goes on from a checkpoint" in words and "goes on with frame" in words, words)


def cancelled(world):
    other, job = world.submit(LONG, "scancel"), world.submit(LONG, "cancelled")
    world.wait(job, lambda now: now["stage"] == "waiting in the cluster", "the second one waits")
    world.server.ask("jobs/" + job, "DELETE")
    check(world.job(job)["state"] == "cancelled", "it is cancelled here")
    world.cluster.wait(lambda: world.in_slurm(job)[0]["state"] == "CANCELLED", "it leaves Slurm")
    now = world.wait(other, lambda now: now["stage"] == "tracking", "the server hears of its progress")
    check(now["total"] == LONG, f"{now}")
    world.cluster.ask("scancel", world.in_slurm(other)[0]["number"])
    report = world.end_of(other)
    check(report["state"] == "failed" and "scancel" in report["words"], f"it says so: {report}")
    check(not [scan for scan in world.server.scans() if scan["title"] in ("cancelled", "scancel")], "neither leaves a scan")


def away(world):
    world.cluster.kill("slurmctld")
    job = world.submit(8, "away")
    world.wait(job, lambda now: now["stage"] == "waiting for the cluster", "Slurm is away")
    check("does not take the job" in world.words(job), world.words(job))
    world.cluster.start_controller()
    world.finished_well(job, 8, "a job that came while Slurm was away")
    check(len(world.in_slurm(job)) == 1, f"it was submitted once: {world.in_slurm(job)}")


def main():
    arguments = argument_parser().parse_args()
    reason = why_not()
    if reason:
        print("skipped:", reason)
        return SKIPPED
    started = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        try:
            cluster = Cluster(folder + "/cluster")
        except DoesNotRun as error:
            print("skipped: Slurm does not run on this machine:", error)
            return SKIPPED
        world = World(arguments, folder, cluster)
        try:
            cut_off = CutOff(world)
            with concurrent.futures.ThreadPoolExecutor() as both:
                for case in [both.submit(one, world) for one in (same, stopped)]:
                    case.result()
            print(f"same, stopped: {time.monotonic() - started:.1f} s", flush=True)
            cancelled(world)
            print(f"cancelled: {time.monotonic() - started:.1f} s", flush=True)
            cut_off.go_on()
            print(f"go_on: {time.monotonic() - started:.1f} s", flush=True)
            away(world)
            world.cluster.wait(lambda: not os.listdir(folder + "/data/slurm"), "nothing is left in the shared folder")
            print(f"away: {time.monotonic() - started:.1f} s", flush=True)
            world.server.end_well()
        finally:
            world.server.process.kill()
            for process in processes_with(folder + "/data/slurm"):
                with contextlib.suppress(ProcessLookupError):
                    os.kill(process, signal.SIGKILL)
            world.cluster.end()
    return verdict()


if __name__ == "__main__":
    sys.exit(main())
