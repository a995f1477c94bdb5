#!/usr/bin/env python3
"""Plants one fault at a time in a copy of the sources and shows that the tests notice it.

Example: tests/mutants/run.py --build build/mutants
         tests/mutants/run.py --only "push dropped"
         tests/mutants/run.py --fifths    one fifth of them, another one with each commit

A fault survives if all its test programs pass. Ends with 1 if one survives, no longer applies or does not compile.
"""

import argparse
import pathlib
import shutil
import subprocess
import sys
import time

from faults import FAULTS

ROOT = pathlib.Path(__file__).resolve().parents[2]


def fifth():
    """Which fifth of the faults is this commit's: all have their turn within five commits; None outside a checkout."""
    counted = subprocess.run(["git", "rev-list", "--count", "HEAD"], cwd=ROOT, capture_output=True, check=False)
    return int(counted.stdout) % 5 if counted.returncode == 0 else None


def processor_flags():
    try:
        return set(pathlib.Path("/proc/cpuinfo").read_text().split())
    except OSError:
        return set()


def copy_sources(to):
    """Copies what git tracks, keeping the times of files that did not change, so that little is compiled anew."""
    listed = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT,
                            capture_output=True, check=False)
    names = listed.stdout.decode().split("\0") if listed.returncode == 0 else []
    if not names:  # not a checkout: everything but build folders
        names = [str(path.relative_to(ROOT)) for path in ROOT.rglob("*") if "build" not in path.parts]
    for name in filter(None, names):
        source, target = ROOT / name, to / name
        if not source.is_file() or (target.exists() and target.read_bytes() == source.read_bytes()):
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source, target)


def run(command, **options):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **options)


def notices(binaries, program):
    """Whether a test program fails; one that hangs or crashes notices too."""
    try:
        return run([binaries / program, "--gtest_fail_fast"], timeout=120).returncode != 0
    except subprocess.TimeoutExpired:
        return True


def judge(fault, sources, build):
    path = sources / fault.file
    original = path.read_text()
    if original.count(fault.old) != 1:
        return f"NO LONGER APPLIES: the text is there {original.count(fault.old)} times"
    path.write_text(original.replace(fault.old, fault.new))
    try:
        programs = fault.tests.split()
        made = run(["cmake", "--build", build, "--target", *programs])
        if made.returncode != 0:
            return "DOES NOT COMPILE\n" + made.stdout[-2000:]
        found = next((program for program in programs if notices(build / "bin", program)), None)
        return f"caught by {found}" if found else "SURVIVED"
    finally:
        path.write_text(original)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=ROOT / "build" / "mutants", type=pathlib.Path, help="folder to work in")
    parser.add_argument("--only", default="", help="faults whose name contains this")
    parser.add_argument("--fifths", action="store_true", help="one fifth, which follows from the number of commits")
    arguments = parser.parse_args()
    work = arguments.build.resolve()
    sources, build = work / "source", work / "build"
    flags = processor_flags()
    chosen = [fault for fault in FAULTS if arguments.only in fault.name and (not fault.needs or fault.needs in flags)]
    if arguments.fifths and fifth() is not None:
        chosen = chosen[fifth()::5]
    copy_sources(sources)
    # Little optimisation: what counts is compiling. Assertions stay off, so that the tests do the work.
    made = run(["cmake", "-S", sources, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG", "-DKERF_WERROR=OFF"])
    programs = sorted({program for fault in chosen for program in fault.tests.split()})
    if made.returncode == 0:
        made = run(["cmake", "--build", build, "--target", *programs])
    if made.returncode != 0:
        sys.exit(made.stdout)
    failing = [program for program in programs if notices(build / "bin", program)]
    if failing:
        sys.exit(f"without any fault these fail already: {', '.join(failing)}")
    bad = 0
    for fault in chosen:
        start = time.monotonic()
        verdict = judge(fault, sources, build)
        bad += not verdict.startswith("caught")
        print(f"{fault.name:<60} {verdict} ({time.monotonic() - start:.0f} s)", flush=True)
    for fault in FAULTS:
        if fault.needs and fault.needs not in flags:
            print(f"{fault.name:<60} left out: it shows on processors with {fault.needs}")
    print(f"{len(chosen) - bad} of {len(chosen)} faults caught")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
