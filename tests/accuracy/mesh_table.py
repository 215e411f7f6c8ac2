"""The tables "mesh" of tests/accuracy/run: our meshes, and two of other methods made of the same surfels and depth (mesh_baselines.py)."""
import importlib.util
import json
import os
import re
import subprocess
import sys
import time

CELL_M = 0.01
# With its noise, and without it as the truth.
SOURCES = [("living_room_part+noise=kinect,seed=1", "living_room_part"),
           ("synthetic:frames=150,noise=kinect,seed=1", "synthetic:frames=150"),
           ("synthetic:frames=150,scene=bare,noise=kinect,seed=1", "synthetic:frames=150,scene=bare"),
           ("synthetic:frames=150,scene=office,rate=15,noise=kinect,seed=1", "synthetic:frames=150,scene=office,rate=15")]
BASELINES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "mesh_baselines.py")
# What a sound mesh has none of.
FAULTS = ["overfull_edges", "disagreeing_edges", "flipped_faces", "pinched_vertices", "degenerate_faces", "repeated_faces", "vertices_away"]


def measured(command):
    """Seconds, those of all processors, and greatest memory [MB] of a command; ends the program with its message when it fails."""
    started_s = time.monotonic()
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as child:
        message = child.stderr.read().decode()
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode != 0:
        sys.exit(f"{' '.join(command)} ended with {child.returncode}: {message[-2000:]}")
    return {"seconds": time.monotonic() - started_s, "cpu_seconds": usage.ru_utime + usage.ru_stime, "peak_mb": usage.ru_maxrss / 1024}


class Workshop:
    """What is made of one recording, in a folder of its own; what takes long is made once."""

    def __init__(self, runner, work, source, truth):
        self.runner, self.source, self.truth = runner, source, truth
        self.folder = os.path.join(work, re.sub(r"[^\w.=,+-]", "_", source))
        os.makedirs(self.folder, exist_ok=True)
        self.costs = {}

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def once(self, name, command):
        """`command` writes `name`.ply; its costs are kept beside it."""
        if not os.path.exists(self.path(name + ".json")):
            costs = measured(command)
            with open(self.path(name + ".json"), "w", encoding="utf-8") as file:
                json.dump(costs, file)
        with open(self.path(name + ".json"), encoding="utf-8") as file:
            self.costs[name] = json.load(file)

    def reconstruct(self):
        if not os.path.exists(self.path("result", "surfels.ply")):
            self.runner.call("reconstruct", self.runner.path(self.source), "--out", self.path("result"), *self.runner.frames)
        self.cloud, self.surfels, self.trajectory = (self.path("result", name) for name in ("cloud.ply", "surfels.ply", "trajectory.txt"))

    def make_ours(self):
        if subprocess.run([self.runner.hermite, "mesh", "--help"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode:
            print(f"skipped: {self.runner.hermite} has no command 'mesh'", file=sys.stderr)
            return
        self.costs["ours"] = measured([self.runner.hermite, "mesh", self.path("result"), "--out", self.path("ours.ply")])

    def make_others(self):
        if importlib.util.find_spec("open3d") is None:
            print("skipped: Poisson and TSDF need Open3D: install python3-open3d, and run with Debian's own /usr/bin/python3", file=sys.stderr)
            return
        cell = ["--cell", str(CELL_M)]
        self.once("Poisson", [sys.executable, BASELINES, "poisson", self.cloud, self.path("Poisson.ply"), *cell])
        frames = self.path("frames.raw")
        if not os.path.exists(frames) and not os.path.exists(self.path("TSDF.json")):
            measured([self.runner.hermite, "convert", self.runner.path(self.source), frames, "--to", "raw", *self.runner.frames])
        self.once("TSDF", [sys.executable, BASELINES, "tsdf", frames, self.trajectory, self.path("TSDF.ply"), *cell])

    def judged(self):
        """Name and measures: of the cloud, then of the meshes."""
        names = list(self.costs)
        judged = self.runner.call("evaluate", "--mesh", *[self.path(name + ".ply") for name in names], "--cell", str(CELL_M), "--cloud", self.cloud,
                                  "--surfels", self.surfels, "--estimate", self.trajectory, "--surface", self.runner.path(self.truth))
        with open(self.path("judged.json"), "w", encoding="utf-8") as file:
            json.dump(judged, file, indent=2)
        yield "our cloud", judged["cloud"]
        for name, measures in zip(names, judged["meshes"]):
            yield name, measures


def mm(measures, key):
    return f"{1000 * measures[key]:.1f}" if key in measures else "–"


def percent(measures, key):
    return f"{100 * measures[key]:.1f}"


def accuracy_row(source, name, measures):
    is_mesh = measures["depth_views"] > 0
    depth = [mm(measures, "depth_capped_mean_m"), percent(measures, "depth_missing")] if is_mesh else ["", ""]
    return ([source, name] + [mm(measures, f"surface_{key}_m") for key in ("mean", "median", "percentile95")] +
            [mm(measures, "edge_mean_m"), percent(measures, "edge_missing_10mm")] +
            [percent(measures, f"{key}_{width}") for width in ("5mm", "10mm") for key in ("f_score", "precision", "recall")] + depth)


def validity_row(source, name, measures, costs):
    return ([source, name, str(measures["triangles"]), f"{costs['seconds']:.0f}", f"{costs['cpu_seconds']:.0f}", f"{costs['peak_mb']:.0f}"] +
            [str(measures[key]) for key in FAULTS + ["border_edges", "components"]])


def mesh_tables(runner, work, table):
    """Prints them. `work`: a folder that keeps reconstructions and the meshes of others; `table`: of a head and rows."""
    judged = []
    for source, truth in SOURCES:
        if not runner.is_here(source):
            continue
        workshop = Workshop(runner, work, source, truth)
        workshop.reconstruct()
        workshop.make_ours()
        workshop.make_others()
        if workshop.costs:
            judged += [(source, name, measures, workshop.costs.get(name)) for name, measures in workshop.judged()]
    table(["sequence", "", "mean [mm]", "median", "95 %", "mean at creases", "of creases missing [%]", "F at 5 mm [%]", "precision", "recall", "F at 10 mm [%]",
           "precision", "recall", "depth beside the path [mm]", "missing [%]"], (accuracy_row(*row[:3]) for row in judged))
    table(["sequence", "", "triangles", "s", "CPU s", "MB", "edges with > 2 faces", "edges whose faces disagree", "flipped faces", "pinched vertices",
           "degenerate faces", "repeated faces", "vertices > 2 cells from a surfel", "border edges", "parts"], (validity_row(*row) for row in judged if row[3]))
