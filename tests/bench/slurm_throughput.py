#!/usr/bin/python3
"""How fast many small recordings become scans: in the server itself, and on one and two nodes of a Slurm cluster that is all on this machine.

    slurm_throughput.py HERMITE HERMITE_CLIENT [--jobs 40] [--frames 20]

Prints the table of deploy/SCALING.md. The clock runs from the first upload until the last scan is finished; the nodes share the cores.
"""
import os
import subprocess
import sys
import tempfile
import time

sys.path[:0] = [os.path.join(os.path.dirname(os.path.abspath(__file__)), other) for other in ("../faults", "../support/slurm")]
from programs import Server, argument_parser, wait_until  # noqa: E402
from slurm_cluster import NODES, SKIPPED, Cluster, why_not  # noqa: E402


def seconds_of(server, arguments, recordings):
    began = time.monotonic()
    done = subprocess.run([arguments.client, "upload", *recordings, "--no-check", "--server", server.url], capture_output=True, text=True,
                          check=False, env={**os.environ, "XDG_STATE_HOME": os.path.dirname(recordings[0]) + "/state-" + str(server.port)})
    if done.returncode != 0:
        sys.exit(done.stderr)

    def states():
        return [job["state"] for job in server.ask("jobs")["jobs"]]

    wait_until(lambda: all(state not in ("queued", "running") for state in states()), "all jobs end")
    seconds = time.monotonic() - began
    if states() != ["finished"] * len(recordings):
        sys.exit(f"not all finished: {states()}")
    return seconds


def main():
    parser = argument_parser()
    parser.add_argument("--jobs", type=int, default=40)
    parser.add_argument("--frames", type=int, default=20)
    arguments = parser.parse_args()
    if why_not():
        print("skipped:", why_not())
        return SKIPPED
    with tempfile.TemporaryDirectory() as folder:
        recordings = []
        for number in range(arguments.jobs):
            recordings.append(f"{folder}/room{number}")
            subprocess.run([arguments.hermite, "convert", f"synthetic:frames={arguments.frames},width=160,height=120,seed={number}", recordings[-1],
                            "--to", "tum"], check=True, stdout=subprocess.DEVNULL)
        cluster = Cluster(folder + "/cluster")
        slurm = ("--batch", "slurm", "--slurm-memory", "1000", "--slurm-jobs", str(arguments.jobs))
        rows = []
        try:
            for where, settings, node_count in (("the server, one at once", (), 0), ("the server, two at once", ("--job-workers", "2"), 0),
                                                ("one node", slurm, 1), ("two nodes", slurm, 2)):
                for number, node in enumerate(NODES):
                    cluster.ask("scontrol", "update", "NodeName=" + node, *(["State=RESUME"] if number < node_count else
                                                                            ["State=DRAIN", "Reason=bench"]))
                server = Server(arguments.hermite, f"{folder}/{len(rows)}", settings=("--admin-listen", "off", *settings),
                                environment=cluster.environment)
                seconds = seconds_of(server, arguments, recordings)
                server.end_well()
                rows.append(f"| {where} | {seconds:.0f} | {60 * arguments.jobs / seconds:.0f} |")
                print(rows[-1], flush=True)
        finally:
            cluster.end()
    print("\n".join([f"| {arguments.jobs} recordings of {arguments.frames} frames, done by | seconds | a minute |", "|---|---|---|", *rows]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
