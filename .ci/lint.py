#!/usr/bin/env python3
"""lint.py BUILD_DIR CLANG_TIDY [SECONDS]: clang-tidy on every source of the libraries and the program.

Sources are those in compile_commands.json below the folders of FOLDERS, instantiations that CMake wrote included. What passed
is remembered in build/lint by the contents of the source, of the headers it includes, and of the settings, so only what
changed is checked again. Changed sources come first, then those that include changed headers, then the others in an order
that differs from commit to commit: when the time (120 s) is over, the rest is left to later runs. Exit status 1 at a finding.
"""
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys
import time

FOLDERS = ("kernels", "collision", "solvers", "dynamics", "host", "scenes")
ROOT = pathlib.Path(__file__).resolve().parent.parent


def output(*command):
    """Standard output of a command, empty when it fails."""
    result = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    return result.stdout if result.returncode == 0 else ""


def in_tree(path, build):
    """The path as seen from the root (generated sources: from the folder they were written to), or None."""
    path = pathlib.Path(os.path.normpath(build / path))
    for base in (build / "generated", ROOT):
        if path.is_relative_to(base):
            name = path.relative_to(base)
            return name if name.parts[0] in FOLDERS else None
    return None


def dependencies(build):
    """Headers of the tree that each object was compiled from, by the name of the object; from ninja's log."""
    headers = {}
    current = None
    for line in output("ninja", "-C", str(build), "-t", "deps").splitlines():
        if line and not line.startswith(" "):
            current = headers.setdefault(line.split(": #deps")[0], [])
        elif line.strip() and current is not None and in_tree(line.strip(), build):
            current.append(os.path.normpath(build / line.strip()))
    return headers


def one_by_one(entries):
    """The same commands with a command of its own for each source that CMake has compiled in a batch."""
    for entry in entries:
        path = pathlib.Path(entry["directory"], entry["file"])
        if path.parent.name != "Unity":
            yield entry
            continue
        for source in re.findall(r'^#include "(.+)"', path.read_text(), re.MULTILINE):
            yield entry | {"file": source, "command": entry["command"].replace(entry["file"], source)}


def main():
    build = (ROOT / sys.argv[1]).resolve()
    tidy = sys.argv[2]
    deadline = time.monotonic() + float(sys.argv[3] if len(sys.argv) > 3 else 120)
    stamps = ROOT / "build" / "lint"
    stamps.mkdir(parents=True, exist_ok=True)
    entries = list(one_by_one(json.loads((build / "compile_commands.json").read_text())))
    for entry in entries:  # precompiled headers, and rules of the optimizer, are those of another compiler
        entry["command"] = re.sub(r" -include \S+/cmake_pch\.hxx| -Winvalid-pch| -fvect-cost-model=\S+", "",
                                  entry["command"])
    (stamps / "compile_commands.json").write_text(json.dumps(entries))
    # omp.h comes from GCC, whose other headers must stay behind those of clang.
    gcc_include = os.path.dirname(output("g++", "-print-file-name=include/omp.h").strip())
    settings = [tidy, "-p", str(stamps), "--quiet", "--extra-arg=-Wno-unknown-warning-option",
                "--extra-arg=-Wno-ignored-optimization-argument",
                "--extra-arg=-Wno-unused-command-line-argument", f"--extra-arg=-idirafter{gcc_include}"]
    base = output(tidy, "--version") + (ROOT / ".clang-tidy").read_text() + " ".join(settings[3:])

    git = ("git", "-c", f"safe.directory={ROOT}")
    commit = output(*git, "rev-parse", "HEAD")
    since = output(*git, "diff", "--name-only", "HEAD~1").splitlines()
    changed = {str(ROOT / name) for name in since}
    headers = dependencies(build)
    contents = {}

    def digest(path):
        if path not in contents:
            contents[path] = hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()
        return contents[path]

    work = []
    seen = set()  # a source may belong to several targets
    unchanged = 0
    for entry in entries:
        source = os.path.normpath(build / entry["file"])
        name = in_tree(source, build)
        if name is None or not source.endswith(".cpp") or source in seen:
            continue
        seen.add(source)
        made = re.search(r" -o (\S+)", entry["command"])
        included = headers.get(made.group(1)) if made else None
        key = None
        if included is not None:
            present = sorted(path for path in set(included) if os.path.exists(path))
            parts = [base, entry["command"], digest(source)] + [path + digest(path) for path in present]
            key = hashlib.sha256("\n".join(parts).encode()).hexdigest()
        stamp = stamps / f"{name}.passed"
        if key is not None and stamp.exists() and stamp.read_text() == key:
            unchanged += 1
            continue
        rank = 0 if source in changed else 1 if changed & set(included or ()) else 2
        work.append((rank, hashlib.sha256((commit + str(name)).encode()).hexdigest(), source, stamp, key))

    def check(source, stamp, key):
        """Findings in a source; None when the time was over before."""
        left = deadline - time.monotonic()
        if left <= 0:
            return None
        try:
            result = subprocess.run(settings + [source], cwd=ROOT, capture_output=True, text=True, timeout=left)
        except subprocess.TimeoutExpired:
            return None
        if result.returncode != 0:
            return result.stdout + (result.stderr if not result.stdout else "")
        if key is not None:
            stamp.parent.mkdir(parents=True, exist_ok=True)
            stamp.write_text(key)
        return ""

    found = []
    left_over = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for findings in pool.map(lambda item: check(*item[2:]), sorted(work, key=lambda item: item[:2])):
            if findings is None:
                left_over += 1
            elif findings:
                found.append(findings)
                print(findings, flush=True)
    print(f"{len(work) - left_over} sources checked, {unchanged} as they were when they passed, "
          f"{left_over} left for the next run; {len(found)} with findings")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
