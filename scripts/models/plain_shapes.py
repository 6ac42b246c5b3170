"""Shapes for the test models: dictionaries of vertex attributes with "indices"."""

import math


def ball(radius=0.5, rings=12):
    shape = {"POSITION": [], "NORMAL": [], "TEXCOORD_0": [], "TANGENT": [], "indices": []}
    for i in range(rings + 1):
        for j in range(2 * rings + 1):
            polar, around = math.pi * i / rings, math.pi * j / rings
            normal = (
                math.sin(polar) * math.cos(around),
                math.cos(polar),
                -math.sin(polar) * math.sin(around),
            )
            shape["NORMAL"].append(normal)
            shape["POSITION"].append(tuple(radius * c for c in normal))
            shape["TEXCOORD_0"].append((j / (2 * rings), i / rings))
            shape["TANGENT"].append((-math.sin(around), 0.0, -math.cos(around), 1.0))
    row = 2 * rings + 1
    for i in range(rings):
        for j in range(2 * rings):
            a = i * row + j
            shape["indices"] += [a, a + row, a + 1, a + 1, a + row, a + row + 1]
    return shape


def box(half=0.5):
    shape = {"POSITION": [], "NORMAL": [], "TEXCOORD_0": [], "indices": []}
    for axis in range(3):
        for side in (-1, 1):
            normal, a = [0, 0, 0], [0, 0, 0]
            normal[axis], a[(axis + 1) % 3] = side, 1
            b = [
                normal[1] * a[2] - normal[2] * a[1],
                normal[2] * a[0] - normal[0] * a[2],
                normal[0] * a[1] - normal[1] * a[0],
            ]
            first = len(shape["POSITION"])
            for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                shape["POSITION"].append(
                    tuple(half * (normal[k] + u * a[k] + v * b[k]) for k in range(3))
                )
                shape["NORMAL"].append(tuple(normal))
                shape["TEXCOORD_0"].append(((u + 1) / 2, (1 - v) / 2))
            shape["indices"] += [first + k for k in (0, 1, 2, 0, 2, 3)]
    return shape


def square(half=0.5):
    """Upright, facing +z."""
    corners = ((-half, -half), (half, -half), (half, half), (-half, half))
    return {
        "POSITION": [(x, y, 0.0) for x, y in corners],
        "NORMAL": [(0.0, 0.0, 1.0)] * 4,
        "TEXCOORD_0": [(0, 1), (1, 1), (1, 0), (0, 0)],
        "indices": [0, 1, 2, 0, 2, 3],
    }


def grid(width, height, columns, rows):
    """Upright, facing +z, from y = 0 upwards."""
    shape = {"POSITION": [], "NORMAL": [], "TEXCOORD_0": [], "indices": []}
    for i in range(rows + 1):
        for j in range(columns + 1):
            u, v = j / columns, i / rows
            shape["POSITION"].append((width * (u - 0.5), height * v, 0.0))
            shape["NORMAL"].append((0.0, 0.0, 1.0))
            shape["TEXCOORD_0"].append((u, 1 - v))
    for i in range(rows):
        for j in range(columns):
            a = i * (columns + 1) + j
            b = a + columns + 1
            shape["indices"] += [a, a + 1, b + 1, a, b + 1, b]
    return shape
