#!/usr/bin/python3
"""Measures runs of `hermite reconstruct` and prints what tests/bench/README.md records: a Markdown table of speed and accuracy,
and one of the time a frame spends in each stage.

    tests/bench/measure.py --hermite build/release/server/hermite [--frames A:B] [--set key=value] SEQUENCE...

Times are means over the frames of one run; nothing else should run on the machine.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile


def run(arguments, sequence):
    with tempfile.TemporaryDirectory() as out:
        command = [arguments.hermite, "reconstruct", sequence, "--out", out]
        if arguments.frames:
            command += ["--frames", arguments.frames]
        for setting in arguments.set:
            command += ["--set", setting]
        done = subprocess.run(command, stdout=subprocess.PIPE, check=False)
        if done.returncode != 0:
            sys.exit(f"{' '.join(command)} ended with {done.returncode}")
        report = json.loads(done.stdout)
    report["name"] = os.path.basename(sequence.rstrip("/"))
    return report


def table(head, rows):
    print("| " + " | ".join(head) + " |")
    print("|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print()


def overview_row(report):
    error_mm = f"{1000 * report['ate_rmse_m']:.1f}" if "ate_rmse_m" in report else "–"
    return [report["name"], f"{report['tracked_frames']}/{report['frames']}", f"{report['mean_frame_ms']:.0f}", error_mm,
            str(report["surfels"]), f"{report['peak_rss_mb']:.0f}", f"{report['gpu_memory_mb']:.0f}"]


def stage_rows(reports):
    stages = sorted({stage for report in reports for stage in report["stages_ms"]},
                    key=lambda stage: -max(report["stages_ms"].get(stage, 0) for report in reports))
    return [[stage] + [f"{report['stages_ms'].get(stage, 0):.1f}" for report in reports] for stage in stages]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hermite", required=True, help="the program")
    parser.add_argument("--frames", help="A:B")
    parser.add_argument("--set", action="append", default=[], metavar="key=value")
    parser.add_argument("sequences", nargs="+", metavar="SEQUENCE")
    arguments = parser.parse_args()
    reports = [run(arguments, sequence) for sequence in arguments.sequences]
    print(f"Device: {', '.join(sorted({report['device'] for report in reports}))}; {os.cpu_count()} CPU cores.\n")
    table(["sequence", "tracked", "ms a frame", "ATE RMSE [mm]", "surfels", "peak RSS [MB]", "GPU memory [MB]"], map(overview_row, reports))
    table(["stage [ms]"] + [report["name"] for report in reports], stage_rows(reports))


if __name__ == "__main__":
    main()
