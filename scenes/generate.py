#!/usr/bin/env python3
"""Makes the scenes of this folder and their models: the same files, byte for byte, each time."""

import argparse
import pathlib
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from generator import bicycle, pavilion  # noqa: E402
from generator.files import files_of, ply_bytes  # noqa: E402

SCENES = {"pavilion": pavilion, "bicycle": bicycle}
HERE = pathlib.Path(__file__).resolve().parent


def parsed(arguments):
    parser = argparse.ArgumentParser(
        description=__doc__,
        epilog="Example: python3 scenes/generate.py pavilion --output /tmp --ply /tmp/pavilion.ply",
    )
    kinds = "; ".join(f"{name}: {module.__doc__[:-1]}" for name, module in SCENES.items())
    parser.add_argument("scene", choices=[*SCENES, "all"], help=f"what to make; {kinds}")
    parser.add_argument("--output", type=pathlib.Path, default=HERE, metavar="FOLDER",
                        help="where the YAML file and the folder of models go (default: the folder of this script)")
    parser.add_argument("--check", action="store_true", help="write nothing; fail if a file differs from what would be")
    parser.add_argument("--ply", type=pathlib.Path, metavar="FILE", help="also write the scene's triangles as a PLY")
    return parser.parse_args(arguments)


def stale(files, folder):
    """The files of a folder that are not there or differ."""
    return [path for path, text in files.items()
            if not (folder / path).is_file() or (folder / path).read_bytes() != text.encode()]


def write(files, folder):
    for path, text in files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_bytes(text.encode())


def main(arguments):
    options = parsed(arguments)
    names = list(SCENES) if options.scene == "all" else [options.scene]
    if options.ply and len(names) > 1:
        sys.exit("generate.py: --ply takes one scene")
    failed = False
    for name in names:
        scene = SCENES[name].scene()
        files = files_of(scene)
        if options.check:
            for path in stale(files, options.output):
                print(f"{options.output / path} is not what generate.py makes", file=sys.stderr)
                failed = True
        else:
            write(files, options.output)
        if options.ply:
            options.ply.write_bytes(ply_bytes(scene))
        size = sum(map(len, files.values()))
        print(f"{name}: {scene.triangle_count():,} triangles, {len(files)} files, {size / 1e6:.2f} MB", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
