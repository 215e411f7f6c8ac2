"""The table of combined disturbances: scenes, movements and one to four disturbances at a time, drawn by chance, since users meet them together."""
import csv
import os
import random
import re
import tempfile

RUN_COUNT = 60
SCENES = ["room", "room", "bare", "office", "twins", "loop", None]  # None: the recording
RECORDING = "living_room_part"
WRONG_M, WRONG_SIGMAS = 0.05, 5

# A disturbance of the given strength, which is drawn evenly between the limits.
RANGES = {
    "mirror": "width_m=0.5:1.5,height_m=0.5:1.8,turn_deg=-60:60", "glass": "width_m=0.5:2,height_m=0.5:2", "screen": "speed_m_s=0.1:1",
    "door": "distance_m=1.4:2.6,swing_deg=20:80,period_s=2:6", "exposure": "amplitude=0.1:0.6,period_s=0.5:4", "flicker": "amplitude=0.05:0.3",
    "vignetting": "corner=0.3:0.8", "rolling": "ms=10:35", "clock": "ms=-40:40", "blur": "ms=8:35", "headlamp": "ambient=0.05:0.4", "lamp": "at_s=1:3,dim=0.2:0.6",
    "sun": "gain=1.3:3,width_m=0.3:1.5,speed_m_s=0.05:0.6", "balance": "amplitude=0.1:0.4,period_s=1:4", "bend": "percent=-2:2", "sparse": "keep=0.06:0.4",
    "focal": "percent=-2:2", "speckle": "holes=0.05:0.5,wild=0.002:0.03", "banding": "amplitude=0.05:0.25,bands=1:5", "dark": "gain=0.08:0.5,sigma=1:5",
    "attached": "share=0.05:0.3,distance_m=0.3:1", "warming": "percent=-1.2:1.2", "jitter": "ms=4:16",
}
CHOICES = {
    "person": "path=cross/ahead,clothes=checked/plain,distance_m=1.3/1.9/2.4,still_s=0/1.5", "skip": "every=2/3/4", "flying": "width_px=1/2/4", "lowres": "every=3/4/6/8",
    "misregistered": "right_px=-3/-2/2/3,down_px=-1/0/2", "torn": "every=3/7/12", "stained": "spots=3/8/15,width_px=10/20/30",
    "covered": "FRAMES", "missing": "FRAMES",
}


def drawn(chance, name):
    if name in RANGES:
        return name + "=" + re.sub(r"(-?[\d.]+):(-?[\d.]+)", lambda limits: f"{chance.uniform(float(limits[1]), float(limits[2])):.3g}", RANGES[name])
    if CHOICES[name] == "FRAMES":
        return f"{name}={chance.randint(30, 90)}:{chance.randint(5, 40)}"
    return name + "=" + ",".join(key + "=" + chance.choice(values.split("/")) for key, values in (one.split("=") for one in CHOICES[name].split(",")))


def source_of(seed):
    chance = random.Random(seed)
    scene, names = chance.choice(SCENES), chance.sample(sorted([*RANGES, *CHOICES]), chance.choice([1, 2, 2, 3, 3, 4]))
    if {"covered", "missing"} <= set(names):
        names.remove("missing")
    drawn_ones = ["+" + drawn(chance, name) for name in names]
    of_driver = [one for one in drawn_ones if one.startswith("+torn")]  # is done to measured images
    disturbances = "".join([*(one for one in drawn_ones if one not in of_driver), f"+noise=kinect,seed={seed}", *of_driver])
    if scene is None:
        return RECORDING + disturbances
    return f"synthetic:frames=180,width=320,height=240,scene={scene},speed={chance.choice([0.5, 1, 1, 1.5])},start={chance.choice([0, 0, 3, 7, 12])}{disturbances}"


def combined_table(runner, table):
    sums = {"frames": 0, "tracked": 0, "weak": 0, "lost": 0, "far": 0, "unlikely": 0}

    def rows():
        for seed in range(1, RUN_COUNT + 1):
            source = source_of(seed)
            if not runner.is_here(source) or (runner.only and not runner.only.search(source)):
                continue
            with tempfile.TemporaryDirectory() as work:
                path = os.path.join(work, "frames.csv")
                with runner.reconstructed(source, extra=("--per-frame", path)) as (report, _), open(path, newline="", encoding="utf-8") as text:
                    frames = list(csv.DictReader(text))
            tracked = [frame for frame in frames if frame["status"] == "tracked"]
            far = sum(float(frame["position_error_m"] or 0) > WRONG_M for frame in tracked)
            unlikely = sum(float(frame["error_sigmas"] or 0) > WRONG_SIGMAS for frame in tracked)
            counts = {status: sum(frame["status"] == status for frame in frames) for status in ("tracked", "weak", "lost")}
            for key, count in {"frames": len(frames), **counts, "far": far, "unlikely": unlikely}.items():
                sums[key] += count
            expected = report.get("expected_error")
            yield [source.replace("synthetic:frames=180,width=320,height=240,", ""), f"{1000 * report['ate_rmse_m']:.1f}",
                   f"{1000 * expected['path_m']:.1f}" if expected else "–", *map(str, counts.values()), str(far), str(unlikely)]

    table(["run", "ATE RMSE [mm]", "expected", "tracked", "weak", "lost", f"tracked and > {1000 * WRONG_M:.0f} mm off", f"> {WRONG_SIGMAS} deviations"], rows())
    table(["frames", "tracked [%]", "weak [%]", "lost [%]", "tracked and wrong by distance", "by deviations"],
          [[str(sums["frames"])] + [f"{100 * sums[key] / max(1, sums['frames']):.1f}" for key in ("tracked", "weak", "lost")] + [str(sums["far"]), str(sums["unlikely"])]])
