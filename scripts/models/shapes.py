"""Triangle-free building blocks of the models, as plain data.

A Shape lives in its own space: metres, z up, built round the origin. Texture coordinates are in
metres too, one chart per smooth region, and charts never overlap by accident because each is moved
far away from the others; the atlas packs them later, so texel density is even over a whole model.
"""

import math
from dataclasses import dataclass, field

import numpy as np

CHART_STRIDE_M = 2.0  # larger than any shape, so charts never share a texture coordinate


@dataclass
class Shape:
    """Polygons with a texture coordinate (and maybe a decal coordinate in 0..1) per corner."""

    vertices: list = field(default_factory=list)
    faces: list = field(default_factory=list)
    uvs: list = field(default_factory=list)
    decals: list = field(default_factory=list)

    def add_face(self, corners, uvs, decals=None):
        self.faces.append(tuple(corners))
        self.uvs.append([tuple(uv) for uv in uvs])
        self.decals.append([tuple(d) for d in decals] if decals else [(0.0, 0.0)] * len(corners))

    def append(self, other):
        """Adds another shape's polygons; no vertex is shared, so its charts stay its own."""
        first = len(self.vertices)
        self.vertices += list(other.vertices)
        for face, uvs, decals in zip(other.faces, other.uvs, other.decals):
            self.add_face([first + i for i in face], uvs, decals)
        return self


def rounded_rectangle(width, height, radius, corner_steps=6):
    """Outline, counter-clockwise, 4 * (corner_steps + 1) points whatever the radius."""
    radius = max(min(radius, width / 2, height / 2), 1e-5)
    points = []
    for corner, (sx, sy) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        cx, cy = sx * (width / 2 - radius), sy * (height / 2 - radius)
        for step in range(corner_steps + 1):
            angle = math.pi / 2 * (corner + step / corner_steps)
            points.append((cx + radius * math.cos(angle), cy + radius * math.sin(angle)))
    return points


def circle(radius, steps=32):
    return [
        (radius * math.cos(2 * math.pi * i / steps), radius * math.sin(2 * math.pi * i / steps))
        for i in range(steps)
    ]


def fillet(points, radii, steps=4):
    """Rounds the inner corners of a polyline; radii holds one radius per point (0 keeps it)."""
    out = []
    for i, (point, radius) in enumerate(zip(points, radii)):
        p = np.array(point, float)
        if radius <= 0 or i in (0, len(points) - 1):
            out.append(tuple(p))
            continue
        to_prev, to_next = np.array(points[i - 1]) - p, np.array(points[i + 1]) - p
        len_prev, len_next = np.linalg.norm(to_prev), np.linalg.norm(to_next)
        to_prev, to_next = to_prev / len_prev, to_next / len_next
        half = math.acos(max(-1.0, min(1.0, float(to_prev @ to_next)))) / 2
        reach = min(radius / math.tan(half), 0.499 * len_prev, 0.499 * len_next)
        bisector = (to_prev + to_next) / np.linalg.norm(to_prev + to_next)
        centre = p + bisector * (reach / math.cos(half))
        start, end = p + to_prev * reach - centre, p + to_next * reach - centre
        sweep = math.pi - 2 * half
        for k in range(steps + 1):
            t = k / steps
            arc = (math.sin((1 - t) * sweep) * start + math.sin(t * sweep) * end) / math.sin(sweep)
            out.append(tuple(centre + arc))
    return out


def loft(rings, start_cap=True, end_cap=True, closed=True, charts="grid"):
    """Skin over rings of equally many 3D points, ordered so that normals point outwards.

    charts: "grid" unrolls the skin as a strip (pipes, turned parts); "box" projects every face
    along its main axis (rounded boxes). Decals run over the strip in 0..1. Flat caps get a chart
    of their own, with a decal over their bounding rectangle.
    """
    shape = Shape()
    rings = [np.array(ring, float) for ring in rings]
    count = len(rings[0])
    for ring in rings:
        shape.vertices += [tuple(p) for p in ring]
    columns = count if closed else count - 1
    widest = max(rings, key=lambda r: np.linalg.norm(r - np.roll(r, -1, axis=0), axis=1).sum())
    across = np.concatenate([[0.0], np.cumsum(_steps(widest))])
    along = np.concatenate(
        [[0.0], np.cumsum([np.linalg.norm(b - a, axis=1).mean() for a, b in zip(rings, rings[1:])])]
    )
    for j in range(len(rings) - 1):
        for i in range(columns):
            k = (i + 1) % count
            corners = [j * count + i, j * count + k, (j + 1) * count + k, (j + 1) * count + i]
            grid = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            uvs = [(across[a], along[b]) for a, b in grid]
            decals = [(a / columns, along[b] / along[-1]) for a, b in grid]
            shape.add_face(corners, uvs, decals)
    if charts == "box":
        box_project(shape)
    if start_cap:
        _cap(shape, rings[0], 0, reverse=True, chart=10)
    if end_cap:
        _cap(shape, rings[-1], (len(rings) - 1) * count, reverse=False, chart=11)
    return shape


def _steps(ring):
    return np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1)


def _cap(shape, ring, first, reverse, chart):
    """A fan round the ring's centre: no long thin triangles, and a clean shading normal."""
    centre = ring.mean(axis=0)
    normal = np.sum(
        [np.cross(a - centre, b - centre) for a, b in zip(ring, np.roll(ring, -1, 0))], 0
    )
    axes = [a for a in range(3) if a != int(np.argmax(np.abs(normal)))]
    low, span = ring.min(axis=0), np.maximum(np.ptp(ring, axis=0), 1e-9)
    hub = len(shape.vertices)
    shape.vertices.append(tuple(centre))
    points = {first + i: p for i, p in enumerate(ring)} | {hub: centre}
    for i in range(len(ring)):
        corners = [first + i, first + (i + 1) % len(ring), hub]
        if reverse:
            corners = [corners[1], corners[0], hub]
        flat = [points[c][axes] for c in corners]
        uvs = [(p[0] + CHART_STRIDE_M * chart, p[1]) for p in flat]
        shape.add_face(corners, uvs, [(p - low[axes]) / span[axes] for p in flat])


def box_project(shape):
    """Charts by each face's main axis: a stretch of 1.7 at the very worst, 1 on flat sides."""
    vertices = np.array(shape.vertices)
    for f, face in enumerate(shape.faces):
        p = vertices[list(face)]
        normal = np.zeros(3)
        for a, b in zip(p, np.roll(p, -1, axis=0)):
            normal += np.cross(a - p[0], b - p[0])
        axis = int(np.argmax(np.abs(normal) * (1.0, 1.02, 1.01)))  # ties go to the front, then top
        side = 2 * axis + (normal[axis] > 0)
        axes = [a for a in range(3) if a != axis]
        shape.uvs[f] = [(q[axes[0]] + CHART_STRIDE_M * side, q[axes[1]]) for q in p]


def shell(width, depth, radius, profile, corner_steps=6, charts="box", caps=(False, True)):
    """A rounded-rectangle column: profile lists (outward offset, z) from the bottom up.

    The bottom is open unless asked for, as most parts stand in another one.
    """
    rings = []
    for offset, z in profile:
        outline = rounded_rectangle(
            max(width + 2 * offset, 1e-4),
            max(depth + 2 * offset, 1e-4),
            radius + offset,
            corner_steps,
        )
        rings.append([(x, y, z) for x, y in outline])
    return loft(rings, *caps, charts=charts)


def turned(profile, steps=32, charts="grid", caps=(False, True)):
    """A solid of revolution round z: profile lists (radius, z) from the bottom up; see shell."""
    rings = [[(x, y, z) for x, y in circle(max(r, 1e-5), steps)] for r, z in profile]
    return loft(rings, *caps, charts=charts)


def ball(radius, steps=24, squash=1.0):
    half = steps // 2
    angles = [math.pi * (-0.5 + (i + 0.35) / (half - 0.3)) for i in range(half)]
    profile = [(radius * math.cos(a), radius * squash * math.sin(a)) for a in angles]
    return turned(profile, steps, "box", (True, True))


def hose(radius, length, ribs, depth, steps=20):
    """A ribbed rubber hose from z = 0 up to z = length."""
    profile = []
    samples = 4 * ribs
    for i in range(samples + 1):
        wave = 0.5 - 0.5 * math.cos(2 * math.pi * i / 4)
        profile.append((radius - depth * (1 - wave), length * i / samples))
    return turned(profile, steps, caps=(False, False))


def tube(path, radii, steps=10, flatten=1.0):
    """A pipe along 3D points; its frame is carried along without twist. flatten scales one axis."""
    path = [np.array(p, float) for p in path]
    tangents = [path[min(i + 1, len(path) - 1)] - path[max(i - 1, 0)] for i in range(len(path))]
    tangents = [t / np.linalg.norm(t) for t in tangents]
    side = np.cross(tangents[0], (0.0, 0.0, 1.0))
    if np.linalg.norm(side) < 1e-3:
        side = np.cross(tangents[0], (0.0, 1.0, 0.0))
    rings = []
    for p, t, r in zip(path, tangents, radii):
        side = side - t * (side @ t)
        side /= np.linalg.norm(side)
        up = np.cross(t, side)
        rings.append([p + x * side + y * flatten * up for x, y in circle(max(r, 1e-5), steps)])
    return loft(rings)
