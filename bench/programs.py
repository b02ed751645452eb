"""Where the programs are that the scripts of the experiments run: in what `./bootstrap build` makes, unless an option says so."""

import os
import pathlib
import shutil
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILDS = ("build/release/bin", "build/cpu-release/bin")  # with a GPU, and without


def _refuse(what):
    sys.exit(f"{pathlib.Path(sys.argv[0]).name}: {what}")


def _is_program(path):
    return path.is_file() and os.access(path, os.X_OK)


def folder_of(names, given=None, option="--bin"):
    """The folder that has all these programs: the one given, else that of the newest build. Ends the script where there is none."""
    if given is not None:
        missing = [name for name in names if not _is_program(pathlib.Path(given) / name)]
        if missing:
            _refuse(f"{option} {given}: there is no {missing[0]}")
        return pathlib.Path(given)
    found = [ROOT / build for build in BUILDS if all(_is_program(ROOT / build / name) for name in names)]
    if not found:
        _refuse(f"no {' and '.join(names)} in {' or '.join(BUILDS)}: build them, or give their folder with {option} DIR")
    return max(found, key=lambda folder: (folder / names[0]).stat().st_mtime)


def scree(given=None, option="--scree"):
    """The program scree: the one given, a path or a name, else that of the newest build. Ends the script where there is none."""
    if given is not None:
        if shutil.which(given) is None:
            _refuse(f"{option} {given}: there is no such program")
        return given
    found = [ROOT / build / "scree" for build in BUILDS if _is_program(ROOT / build / "scree")]
    if not found:
        _refuse(f"no scree in {' or '.join(BUILDS)}: build it, or say which with {option} PROGRAM")
    return str(max(found, key=lambda program: program.stat().st_mtime))
