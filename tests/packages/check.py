#!/usr/bin/env python3
"""What is in the packages of deploy/packages.sh: files and their rights, the service, the settings, the manual pages, the library. And that
the same packages, built a second time, are the same bytes.

    check.py PACKAGES PACKAGES_AGAIN

Exits non-zero, and says what is wrong. Needs dpkg-deb and CMake, and for the unit systemd-analyze, without which it says that it left that
out. Installs nothing and writes to a temporary folder only.
"""
import gzip
import io
import pathlib
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = {"hermite-server": "hermite", "hermite-client": "hermite-client"}
CONTENTS = {
    "hermite-server": ["etc/hermite/serve.toml", "lib/systemd/system/hermite.service", "usr/bin/hermite", "usr/share/hermite/openapi.json",
                       "usr/share/hermite/web/index.html", "usr/share/man/man1/hermite.1.gz", "usr/share/doc/hermite-server/README.md"],
    "hermite-client": ["usr/bin/hermite-client", "usr/share/man/man1/hermite-client.1.gz"],
    "hermite-dev": ["usr/include/hermite/core/run/results.h", "usr/lib/cmake/hermite/hermite-config.cmake",
                    "usr/lib/hermite/libhermite_run.a", "usr/share/doc/hermite-dev/examples/own_camera.cpp"],
}
OUTSIDE_USR = {"etc/hermite/serve.toml", "lib/systemd/system/hermite.service"}
wrong = []


def must(condition, sentence):
    if not condition:
        wrong.append(sentence)
        print(f"WRONG: {sentence}", flush=True)


def output_of(*command):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True).stdout


def field(package, name):
    return output_of("dpkg-deb", "--field", package, name).decode().strip()


def check_files(name, package):
    members = tarfile.open(fileobj=io.BytesIO(output_of("dpkg-deb", "--fsys-tarfile", package))).getmembers()
    files = {member.name.removeprefix("./") for member in members if not member.isdir()}
    for wanted in CONTENTS[name] + [f"usr/share/doc/{name}/{file}" for file in ("copyright", "changelog.gz")]:
        must(wanted in files, f"{name} lacks {wanted}")
    for file in files:
        must(file.startswith("usr/") or file in OUTSIDE_USR, f"{name} has {file}")
    for member in members:
        rights = 0o755 if member.isdir() or member.name.startswith("./usr/bin/") else 0o644
        must(member.uid == member.gid == 0 and member.mode == rights and not member.islnk() and not member.issym(),
             f"{member.name} of {name} belongs to {member.uid}:{member.gid} and has the rights {member.mode:o}")


def check_program(name, root, version):
    program = root / "usr/bin" / PROGRAMS[name]
    said = output_of(program, "--version").decode().strip()
    must(said.split()[-1] == version, f"{program.name} --version says {said}, but the package has {version}")
    commands = re.findall(r"^  ([a-z]+) {2,}", output_of(program, "--help").decode().split("Subcommands:")[1], re.M)
    manual = gzip.decompress((root / f"usr/share/man/man1/{program.name}.1.gz").read_bytes()).decode()
    listed = re.findall(r"^\.TP\n\.B ([a-z]+)$", manual.split(".SH COMMANDS")[1].split(".SH OPTIONS")[0], re.M)
    must(commands == listed, f"the manual page of {program.name} has the commands {listed}, but the program has {commands}")


def check_viewer(root):
    web = root / "usr/share/hermite/web"
    named = re.findall(r'(?:src|href)="\./([^"]+)"', (web / "index.html").read_text())
    must(named, "index.html names no file of the viewer")
    for file in named:
        must((web / file).is_file(), f"index.html names {file}, which is not in hermite-server")


def check_settings(root, package, scratch):
    listed = output_of("dpkg-deb", "--info", package, "conffiles").decode().split()
    must(listed == ["/etc/hermite/serve.toml"], f"conffiles lists {listed}")
    file = root / "etc/hermite/serve.toml"
    program = root / "usr/bin/hermite"
    asked = [program, "serve", "--print-config", "--data", "/nowhere"]
    must(output_of(*asked, "--config", file) == output_of(*asked), "serve.toml changes a default")
    names = set(re.findall(r"^([a-z-]+) = ", output_of(*asked).decode(), re.M))
    for line in re.findall(r"^#([a-z-]+ = .*)$", file.read_text(), re.M):
        must(line.split()[0] in names, f'serve.toml has "{line}", which is no setting')
        # What has to be set together with others is refused for that reason only.
        (scratch / "one.toml").write_text(line + "\n")
        refusal = subprocess.run([*asked, "--config", scratch / "one.toml"], capture_output=True, text=True).stderr
        must("one.toml" not in refusal, f'serve.toml has "{line}", which hermite refuses: {refusal}')


def check_unit(root, scratch):
    unit = (root / "lib/systemd/system/hermite.service").read_text()
    must("/opt/" not in unit and "DynamicUser" not in unit, "the unit is that of an installation without package")
    start = re.search(r"^ExecStart=(\S+)", unit, re.M).group(1)
    must((root / start.lstrip("/")).is_file(), f"the unit starts {start}, which is not in the package")
    if not shutil.which("systemd-analyze"):
        print("SKIPPED: systemd-analyze is not installed; the unit was not verified")
        return
    # It looks for the program here, where the package is not installed.
    (scratch / "hermite.service").write_text(unit.replace(start, str(root / start.lstrip("/"))))
    verdict = subprocess.run(["systemd-analyze", "verify", "--man=no", scratch / "hermite.service"], capture_output=True, text=True)
    ours = [line for line in verdict.stderr.splitlines() if "hermite" in line]
    must(not ours, f"systemd-analyze verify: {ours}")


def check_library(root, package, scratch):
    needed = {name.strip() for name in field(package, "Depends").split(",")}
    listed = set(re.sub(r"#.*", "", (SOURCE / "deploy/packages.txt").read_text()).split())
    must(needed <= listed, f"hermite-dev depends on {needed - listed}, which deploy/packages.txt does not list")
    # CMake looks whether every file of the libraries is there; compiling is the business of the step `library`.
    result = subprocess.run(["cmake", "-S", root / "usr/share/doc/hermite-dev/examples", "-B", scratch / "examples",
                             f"-DCMAKE_PREFIX_PATH={root / 'usr'}"], capture_output=True, text=True)
    must(result.returncode == 0, f"find_package(hermite) fails: {result.stderr}")


def main():
    first, again = (pathlib.Path(folder) for folder in sys.argv[1:])
    packages = {package.name.split("_")[0]: package for package in sorted(first.glob("*.deb"))}
    must(packages.keys() == CONTENTS.keys(), f"the packages are {sorted(packages)}")
    version = re.search(r"^project\(hermite VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text(), re.M).group(1)
    with tempfile.TemporaryDirectory() as folder:
        scratch = pathlib.Path(folder)
        for name, package in packages.items():
            root = scratch / name
            subprocess.run(["dpkg-deb", "--extract", package, root], check=True)
            must(field(package, "Version") == version, f"{name} has the version {field(package, 'Version')}, the project {version}")
            must(package.read_bytes() == (again / package.name).read_bytes(), f"{package.name} differs when it is built again")
            check_files(name, package)
            if name in PROGRAMS:
                check_program(name, root, version)
        check_viewer(scratch / "hermite-server")
        check_settings(scratch / "hermite-server", packages["hermite-server"], scratch)
        check_unit(scratch / "hermite-server", scratch)
        check_library(scratch / "hermite-dev", packages["hermite-dev"], scratch)
    if wrong:
        sys.exit(f"{len(wrong)} things are wrong")
    print(f"{len(packages)} packages of version {version}: their contents are right, and the same when built again")


main()
