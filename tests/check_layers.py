#!/usr/bin/env python3
"""Checks what includes what: the layers of DESIGN.md, no cycles, and that CMake lists every source file of kerf/.

Usage: check_layers.py [FOLDER | --self-test]    (FOLDER: the root of the repository)
"""
import re
import sys
import tempfile
from pathlib import Path

# What each folder may include, besides itself: the table "Layers" of DESIGN.md.
TABLE = {"kerf/base": "", "kerf/geometry": "base", "kerf/references": "base geometry", "kerf/tree": "base geometry",
         "kerf/build": "base geometry references tree", "kerf/layout": "base geometry tree",
         "kerf/trace": "base geometry tree layout", "kerf/choose": "base geometry references tree build layout trace",
         "kerf/scene": "base geometry references tree build layout trace choose", "kerf/io": "base geometry",
         "kerf/render": "base geometry references tree layout trace choose scene io",  # never sees a builder
         "kerf/gpu": "base geometry references tree build layout trace choose scene",
         "kerf/gpu_render": "base geometry references tree layout trace choose scene io render gpu"}
EVERYTHING = " ".join(folder.removeprefix("kerf/") for folder in TABLE)
TABLE |= {"kerf/study": EVERYTHING, "apps": EVERYTHING + " study", "examples": EVERYTHING + " study",
          "python": "base geometry scene io render study"}  # base and geometry: the words that scene speaks in


def faults(root):
    includes = {}
    for path in sorted(p for top in ("kerf", "apps", "python", "examples") for p in root.glob(f"{top}/**/*")):
        if path.suffix in (".h", ".cpp", ".cu", ".cl"):
            text = path.read_text(encoding="utf-8")
            includes[str(path.relative_to(root))] = re.findall(r'^\s*#\s*include\s*["<](kerf/[^">]+)[">]', text, re.M)
    listed = "\n".join(p.read_text(encoding="utf-8") for p in [root / "CMakeLists.txt", *root.glob("kerf/**/CMakeLists.txt")])
    listed = [re.sub(r"\\\$\\\{\w+\\\}", r"\\w+", re.escape(word)) for word in re.findall(r"kerf/[^\s()]+\.c\w+", listed)]
    for name, included in includes.items():
        top = name.split("/")
        folder = "/".join(top[:2]) if top[0] == "kerf" else top[0]
        if folder not in TABLE:
            yield f"{name}: {folder} is not in the table of layers"
            continue
        for other in included:
            layer = other.split("/")[1]
            if "kerf/" + layer != folder and layer not in TABLE[folder].split():
                yield f"{name}: {folder} may not include {other}"
        if folder.startswith("kerf/") and not name.endswith(".h") and not any(re.fullmatch(w, name) for w in listed):
            yield f"{name}: CMake does not list it"
    done, path = set(), []

    def visit(name):
        if name in path:
            yield "files include each other: " + " -> ".join(path[path.index(name):] + [name])
        elif name not in done:
            path.append(name)
            for other in includes.get(name, []):
                yield from visit(other)
            done.add(path.pop())
    for name in includes:
        yield from visit(name)


def self_test():
    files = {"CMakeLists.txt": "kerf/base/a_${X}.cpp", "kerf/base/a_one.cpp": "", "kerf/base/b.cpp": "",
             "kerf/base/up.h": '#include "kerf/scene/scene.h"', "kerf/scene/scene.h": '#include <kerf/base/up.h>',
             "kerf/render/r.h": ' # include "kerf/build/builders.h"', "python/m.cpp": '#include "kerf/trace/t.h"',
             "kerf/render/fine.h": '#include "kerf/io/ply.h"', "kerf/odd/odd.h": ""}
    expected = ["kerf/base/b.cpp: CMake does", "kerf/base/up.h: kerf/base may not include kerf/scene/scene.h",
                "kerf/odd/odd.h: kerf/odd is not", "kerf/render/r.h: kerf/render may not include kerf/build/builders.h",
                "python/m.cpp: python may not include kerf/trace/t.h",
                "files include each other: kerf/base/up.h -> kerf/scene/scene.h -> kerf/base/up.h"]
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            (Path(folder) / name).parent.mkdir(parents=True, exist_ok=True)
            (Path(folder) / name).write_text(text + "\n")
        found = list(faults(Path(folder)))
    return [f"expected '{e}', found {found}" for e, f in zip(expected, found + [""] * 9) if not f.startswith(e)] + found[6:]


root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parents[1]
problems = self_test() if sys.argv[1:] == ["--self-test"] else list(faults(root))
print("\n".join(problems) or "all right")
sys.exit(1 if problems else 0)
