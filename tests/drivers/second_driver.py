#!/usr/bin/env python3
"""One short scan on two Vulkan drivers, Mesa's lavapipe and SwiftShader: their errors must agree. And on the first without each of what a
device may lack: there the results must be the same to the last bit.

    second_driver.py HERMITE LAVAPIPE_ICD SWIFTSHADER_ICD

Exits non-zero, and says why, when they differ. Needs no network, writes to a temporary folder only.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

SCAN = "synthetic:frames=20,width=320,height=240"
RELATIVE = 0.05
ABSOLUTE_M = 0.00002
WITHOUT = ["push-descriptors", "texel-buffers", "64-bit-atomics", "push-descriptors,texel-buffers,64-bit-atomics"]


def environment(icd, without=""):
    changed = dict(os.environ, VK_ICD_FILENAMES=icd, VK_DRIVER_FILES=icd)
    changed.pop("HERMITE_GPU_WITHOUT", None)
    if without:
        changed["HERMITE_GPU_WITHOUT"] = without
    return changed


def scan(program, icd, without=""):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "reconstruct", SCAN, "--out", folder], env=environment(icd, without), check=True, stdout=subprocess.DEVNULL,
                       timeout=300)
        report = json.loads((pathlib.Path(folder) / "report.json").read_text())
    print(f"{report['device']}, without {without or 'nothing'}: ATE {1000 * report['ate_rmse_m']:.4f} mm, {report['surfels']} surfels, "
          f"{report['mean_frame_ms']:.0f} ms a frame", flush=True)
    return report


def main():
    program, lavapipe, swiftshader = sys.argv[1:]
    problems = []
    first = scan(program, lavapipe)
    for without in WITHOUT:
        other = scan(program, lavapipe, without)
        for key in ("trajectory_sha256", "cloud_sha256"):
            if other[key] != first[key]:
                problems.append(f"without {without} there is another {key}")
    second = scan(program, swiftshader)
    for icd, report in ((lavapipe, first), (swiftshader, second)):
        report_text = subprocess.run([program, "doctor"], env=environment(icd), capture_output=True, text=True, timeout=300).stdout
        if f"using 0: {report['device']}" not in report_text:
            problems.append(f"the doctor does not speak of {report['device']}: {report_text}")
        if ("done without" in report_text) != (report is second):
            problems.append(f"the doctor is wrong about what {report['device']} does without: {report_text}")
    if "SwiftShader" not in second["device"]:
        problems.append(f"the second device is {second['device']}")
    if second["tracked_frames"] != first["tracked_frames"]:
        problems.append(f"{second['tracked_frames']} frames tracked, {first['tracked_frames']} on the first driver")
    for key in ("ate_rmse_m", "ate_max_m", "rpe_translation_rmse_m"):
        allowed = max(RELATIVE * first[key], ABSOLUTE_M)
        print(f"{key}: {1000 * first[key]:.4f} and {1000 * second[key]:.4f} mm, {1000 * allowed:.4f} mm may lie between", flush=True)
        if abs(second[key] - first[key]) > allowed:
            problems.append(f"{key} differs")
    if abs(second["surfels"] - first["surfels"]) > RELATIVE * first["surfels"]:
        problems.append("the number of surfels differs")
    for problem in problems:
        print(f"FAILED: {problem}")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
