"""The table of expected errors: what `expected_error` of report.json says of a path, beside its true error."""
import json
import os
import statistics

SMALL = "width=320,height=240"
ROOM, BARE = f"synthetic:frames=150,{SMALL}", f"synthetic:frames=150,{SMALL},scene=bare"
NOISES = ["", "+noise=kinect-white,seed=1", "+noise=kinect,seed=1", "+noise=kinect,seed=2", "+noise=gaussian,sigma_mm=6,seed=1", "+noise=gaussian,sigma_mm=12,seed=1"]
# Before the noise of a Kinect, seed 1; repeated images repeat their noise.
DISTURBANCES = ["+sparse", "+skip", "+person", "+dark", "+flying", "+lowres", "+speckle", "+mirror", "+rolling"]
KINECT = "+noise=kinect,seed=1"
RECORDING = "living_room_part"
LONG = [f"synthetic:scene={scene},frames={frames},{SMALL},rate=10" for scene, frames in (("loop", 620), ("office", 680), ("twins", 700), ("blank", 530))]

RUNS = ([room + noise for room in (ROOM, BARE) for noise in NOISES] +
        [room + disturbance + KINECT for room in (ROOM, BARE) for disturbance in DISTURBANCES] +
        [room + KINECT + "+frozen" for room in (ROOM, BARE)] +
        [RECORDING + noise for noise in NOISES[:4] + NOISES[5:]] + [RECORDING + disturbance + KINECT for disturbance in DISTURBANCES[:2]] +
        [scene + noise for scene in LONG for noise in NOISES[1:3]])

FACTOR = 1.5  # within which an expected error counts as right


def ranks(values):
    order = sorted(range(len(values)), key=values.__getitem__)
    places = [0.0] * len(values)
    for place, index in enumerate(order):
        places[index] = float(place)
    return places


def expected_error_table(runner, table):
    pairs = []

    def report_of(source):
        """With --work, a run that is there is not repeated."""
        if not runner.work:
            return runner.report(source)
        path = os.path.join(runner.work, "expected", "_".join([source.replace("/", "_"), *runner.frames[1:]]) + ".json")
        if not os.path.exists(path):
            report = runner.report(source)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "w", encoding="utf-8") as text:
                json.dump(report, text)
        with open(path, encoding="utf-8") as text:
            return json.load(text)

    def rows():
        for source in RUNS:
            if not runner.is_here(source) or (runner.only and not runner.only.search(source)):
                continue
            report = report_of(source)
            expected = report.get("expected_error")
            if expected is None:
                yield [source, f"{1000 * report['ate_rmse_m']:.1f}"] + ["–"] * 5
                continue
            pairs.append((report["ate_rmse_m"], expected["path_m"]))
            yield ([source, f"{1000 * report['ate_rmse_m']:.1f}", f"{1000 * expected['path_m']:.1f}", f"{expected['path_m'] / report['ate_rmse_m']:.2f}"] +
                   [f"{1000 * expected[part]:.2f}" for part in ("step_m", "drift_m", "stall_m")])

    table(["run", "ATE RMSE [mm]", "expected [mm]", "expected / true", "of steps [mm]", "of drift", "of stalls"], rows())
    if len(pairs) < 3:
        return
    true, expected = zip(*pairs)
    right = sum(1 / FACTOR <= ours / theirs <= FACTOR for theirs, ours in pairs)
    table(["runs", "rank correlation", f"within a factor of {FACTOR} [%]", "of 2 [%]", "median of expected / true", "too small by more than 2"],
          [[str(len(pairs)), f"{statistics.correlation(ranks(true), ranks(expected)):.2f}", f"{100 * right / len(pairs):.0f}",
            f"{100 * sum(0.5 <= ours / theirs <= 2 for theirs, ours in pairs) / len(pairs):.0f}",
            f"{statistics.median(ours / theirs for theirs, ours in pairs):.2f}", str(sum(ours < theirs / 2 for theirs, ours in pairs))]])
