#!/usr/bin/env python3
"""Checks the arrows of the house: who may include whom (docs/architecture.md)."""

import pathlib
import re
import sys

LIBRARIES = {
    "app": {"app", "engine", "slam", "render"},
    "engine": {"engine", "slam", "render"},
    "slam": {"slam"},
    "render": {"render"},
}
SLAM_ROOMS = {
    "data": set(),
    "geometry": {"data"},
    "features": {"geometry", "data"},
    "fitting": {"geometry", "data"},
    "segmentation": {"geometry", "data"},
    "optimize": {"geometry", "data"},
    "stages": {"optimize", "segmentation", "fitting", "features", "geometry", "data"},
}
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)


def includes(path):
    return INCLUDE.findall(path.read_text(encoding="utf-8"))


def slam_room(path):
    parts = pathlib.PurePosixPath(path).parts
    return parts[1] if len(parts) > 2 and parts[0] == "slam" else None


def wrong_arrows(root):
    for library, allowed in LIBRARIES.items():
        for path in sorted((root / library).rglob("*")):
            if path.suffix not in {".h", ".cc"}:
                continue
            name = path.relative_to(root).as_posix()
            for target in includes(path):
                top = target.split("/")[0]
                if top not in allowed:
                    yield f"{name} includes {target}: {library} may not include {top}"
                here, there = slam_room(name), slam_room(target)
                if here and there and here != there and there not in SLAM_ROOMS[here]:
                    yield f"{name} includes {target}: slam/{here} may not include slam/{there}"
                if here and library == "slam" and target == "slam/system.h":
                    yield f"{name} includes {target}: the face of slam is not for its own rooms"


def mixed_bridges(root):
    """Only engine/convert.h may know both Eigen and GLM."""
    for path in sorted((root / "engine").rglob("*.h")):
        text = path.read_text(encoding="utf-8")
        name = path.relative_to(root).as_posix()
        if name != "engine/convert.h" and "#include <Eigen" in text and "#include <glm" in text:
            yield f"{name} includes both Eigen and GLM: engine/convert.h is the one bridge"


def cycles(root):
    graph = {}
    for library in LIBRARIES:
        for path in (root / library).rglob("*.h"):
            name = path.relative_to(root).as_posix()
            graph[name] = [t for t in includes(path) if (root / t).exists()]
    state = {}

    def visit(node, trail):
        state[node] = "open"
        for target in graph.get(node, []):
            if state.get(target) == "open":
                yield "cycle: " + " -> ".join(trail + [node, target])
            elif target not in state:
                yield from visit(target, trail + [node])
        state[node] = "done"

    for node in sorted(graph):
        if node not in state:
            yield from visit(node, [])


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    count = sum(1 for lib in LIBRARIES for p in (root / lib).rglob("*") if p.suffix in {".h", ".cc"})
    if count == 0:
        sys.exit("no sources found: the check would say nothing")
    problems = [*wrong_arrows(root), *mixed_bridges(root), *cycles(root)]
    print("\n".join(problems) or f"{count} files, every arrow points the right way")
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
