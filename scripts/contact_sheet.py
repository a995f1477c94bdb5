#!/usr/bin/env python3
"""Renders the bundled scenes, and some of the real ones where they are at hand, and puts the pictures on one sheet.

Example: scripts/contact_sheet.py --scenes ~/scenes -o docs/pictures.png

The real scenes are taken from the folder of PLY files with a cameras.tsv that --scenes (or KERF_SCENES) names; without
it their places stay empty.
"""

import argparse
import array
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

ROOT = pathlib.Path(__file__).resolve().parents[1]
REAL = ["bunny", "sponza", "sibenik", "housing_coarse", "fzk_haus"]
COLUMNS, GAP = 3, 6


def camera_of(folder, name):
    """The options of a real scene's camera 1."""
    for line in (folder / "cameras.tsv").read_text().splitlines()[1:]:
        field = line.split("\t")
        if field[:2] == [name, "1"]:
            point = [",".join(field[i:i + 3]) for i in (2, 5, 8)]
            return [f"--eye={point[0]}", f"--look-at={point[1]}", f"--up={point[2]}", f"--fov={field[11]}"]
    sys.exit(f"{folder / 'cameras.tsv'} has no camera 1 of {name}")


def read_pfm(path):
    kind, size, scale, pixels = path.read_bytes().split(b"\n", 3)
    assert kind == b"PF" and float(scale) < 0
    width, height = map(int, size.split())
    values = array.array("f", pixels)
    if sys.byteorder == "big":
        values.byteswap()
    row = 3 * width
    return [values[y * row:(y + 1) * row] for y in reversed(range(height))]


def srgb_byte(x):
    x = min(max(x, 0.0), 1.0)
    x = 12.92 * x if x <= 0.0031308 else 1.055 * x ** (1 / 2.4) - 0.055
    return int(255 * x + 0.5)


def write_png(path, rows, width):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    lines = bytearray()
    for row in rows:
        lines.append(1)  # each byte less the one of the pixel before
        lines += bytes((row[i] - (row[i - 3] if i >= 3 else 0)) & 255 for i in range(3 * width))
    temporary = path.with_name(path.name + ".part")
    temporary.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, len(rows), 8, 2, 0, 0, 0)) +
                          chunk(b"IDAT", zlib.compress(bytes(lines), 9)) + chunk(b"IEND", b""))
    temporary.replace(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kerf", default=ROOT / "build/release/bin/kerf", help="the program")
    parser.add_argument("--scenes", default=os.environ.get("KERF_SCENES"), help="folder of the real scenes")
    parser.add_argument("-o", "--output", default=ROOT / "docs/pictures.png", type=pathlib.Path)
    parser.add_argument("--size", default="300x200", help="of each picture")
    parser.add_argument("--spp", default=64, type=int, help="samples of each pixel")
    arguments = parser.parse_args()
    width, height = map(int, arguments.size.split("x"))

    jobs = [(path.stem, [path]) for path in sorted((ROOT / "scenes").glob("*.yaml"))]
    if arguments.scenes:
        folder = pathlib.Path(arguments.scenes)
        jobs += [(name, [folder / f"{name}.ply", *camera_of(folder, name)]) for name in REAL]
    pictures = []
    with tempfile.TemporaryDirectory() as work:
        output = pathlib.Path(work) / "picture.pfm"
        for name, words in jobs:
            print(name, flush=True)
            subprocess.run([arguments.kerf, "render", *map(str, words), "-o", output, "--size", arguments.size, "--spp",
                            str(arguments.spp), "--quiet"], check=True)
            pictures.append([bytes(map(srgb_byte, row)) for row in read_pfm(output)])

    gap = bytes([255]) * 3 * GAP
    sheet_width = COLUMNS * (width + GAP) + GAP
    blank = bytes([255]) * 3 * sheet_width
    sheet = [blank] * GAP
    empty = [bytes([255]) * 3 * width] * height
    for first in range(0, len(pictures), COLUMNS):
        row = pictures[first:first + COLUMNS]
        row += [empty] * (COLUMNS - len(row))
        sheet += [gap + b"".join(picture[y] + gap for picture in row) for y in range(height)] + [blank] * GAP
    write_png(arguments.output, sheet, sheet_width)
    print(f"{arguments.output}: {', '.join(name for name, _ in jobs)}")


if __name__ == "__main__":
    main()
