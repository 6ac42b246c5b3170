"""A framed print for a wall, 0.40 x 0.50 m: oak frame, mount with a window, print in flat inks."""

import math

from mathutils import Matrix

from models import bake, drawing, export, poster_print
from models.assembly import Assembly
from models.recipes import Graph
from models.shapes import Shape, fillet

WIDTH_M, HEIGHT_M = 0.40, 0.50
MEMBER_M, DEPTH_M = 0.024, 0.022  # frame members: width seen from the front, depth off the wall
MOUNT_M = 0.040  # visible width of the mount
SHEET_DEPTH_M = 0.010
PRINT_PX = (640, 875)


def oak(name):
    """Straight-grained oak, oiled; the decal's u runs along the grain, v across."""
    g = Graph(name)
    uv = g.node("ShaderNodeUVMap", uv_map="decal").outputs["UV"]

    def grain(scale, detail, warp=0.0):
        where = g.node("ShaderNodeMapping", {"Vector": uv, "Scale": scale})
        node = g.node(
            "ShaderNodeTexNoise",
            {"Vector": where.outputs[0], "Scale": 1.0, "Detail": detail, "Distortion": warp},
        )
        return node.outputs["Fac"]

    bands = g.ramp(grain((9.0, 150.0, 1.0), 3.0, 0.6), 0.35, 0.68)
    pores = g.ramp(grain((38.0, 1300.0, 1.0), 1.0), 0.60, 0.70)
    tone = g.mix(bands, drawing.srgb("#c08a52"), drawing.srgb("#8e5a2e"))
    tone = g.mix(g.math("MULTIPLY", pores, 0.6), tone, drawing.srgb("#5d3719"))
    grime = g.math("MULTIPLY", g.ramp(g.crevice(0.006), 0.3, 0.95), 0.5)
    colour = g.mix(grime, tone, drawing.srgb("#2c1a0e"))
    height = g.math("MULTIPLY", pores, -0.00012)
    return g.recipe(colour, g.lerp(bands, 0.42, 0.55), 0.0, height)


def card(name, hex_code):
    g = Graph(name)
    fibre = g.noise(0.0016, 3.0)
    colour = g.mix(fibre, drawing.srgb(hex_code), [0.93 * c for c in drawing.srgb(hex_code)])
    return g.recipe(colour, 0.85, 0.0, g.math("MULTIPLY", fibre, 0.00006))


def print_recipe():
    g = Graph("print")
    ink = g.picture(poster_print.picture(*PRINT_PX), "print", True)
    return g.recipe(ink, 0.6, 0.0, g.math("MULTIPLY", g.noise(0.0012, 2.0), 0.00003))


def frame():
    """Four mitred members swept round the rectangle; x right, y up, z off the wall."""
    face = fillet(
        [
            (0.0, 0.0),
            (0.0, DEPTH_M),
            (0.62 * MEMBER_M, DEPTH_M),
            (MEMBER_M, DEPTH_M - 0.006),
            (MEMBER_M, SHEET_DEPTH_M - 0.002),
        ],
        [0, 0.004, 0.006, 0.002, 0],
        5,
    )  # (inset from the outer edge, height)
    run = [0.0]
    for (a, b), (c, d) in zip(face, face[1:]):
        run.append(run[-1] + math.hypot(c - a, d - b))
    shape = Shape()
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    for side in range(4):
        member = Shape()
        (ax, ay), (bx, by) = corners[side], corners[(side + 1) % 4]
        for inset, z in face:
            for sx, sy in ((ax, ay), (bx, by)):
                member.vertices.append((sx * (WIDTH_M / 2 - inset), sy * (HEIGHT_M / 2 - inset), z))
        length = WIDTH_M if side % 2 == 0 else HEIGHT_M
        for i in range(len(face) - 1):
            ends = [(inset, length - inset) for inset, _ in (face[i], face[i + 1])]
            uvs = [
                (ends[0][0], run[i]),
                (ends[0][1], run[i]),
                (ends[1][1], run[i + 1]),
                (ends[1][0], run[i + 1]),
            ]
            decals = [(u + 0.7 * side, v + 0.13 * side) for u, v in uvs]
            member.add_face([2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2], uvs, decals)
        shape.append(member)
    return shape


def sheet(left, bottom, right, top, z):
    shape = Shape(vertices=[(left, bottom, z), (right, bottom, z), (right, top, z), (left, top, z)])
    corners = [(left, bottom), (right, bottom), (right, top), (left, top)]
    shape.add_face([0, 1, 2, 3], corners, [(0, 0), (1, 0), (1, 1), (0, 1)])
    return shape


def window(outer, inner, z_outer, z_inner):
    """A flat or sloping ring between two rectangles given by half width and half height."""
    shape = Shape()
    signs = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    for (half_w, half_h), z in ((outer, z_outer), (inner, z_inner)):
        shape.vertices += [(sx * half_w, sy * half_h, z) for sx, sy in signs]
    for i in range(4):
        k = (i + 1) % 4
        corners = [i, k, 4 + k, 4 + i]
        slope = 1.0 if z_outer == z_inner else 1.4
        uvs = [(shape.vertices[c][0] * slope, shape.vertices[c][1] * slope) for c in corners]
        shape.add_face(corners, uvs)
    return shape


def back():
    shape = sheet(-WIDTH_M / 2, -HEIGHT_M / 2, WIDTH_M / 2, HEIGHT_M / 2, 0.0)
    shape.faces = [face[::-1] for face in shape.faces]
    shape.uvs = [uvs[::-1] for uvs in shape.uvs]
    return shape


def build(scratch):
    a = Assembly("poster")
    # Off the wall (z) becomes Blender's -y; the origin is the bottom centre of the back.
    place = Matrix.Translation((0, 0, HEIGHT_M / 2)) @ Matrix.Rotation(math.pi / 2, 4, "X")
    sight = (WIDTH_M / 2 - MEMBER_M, HEIGHT_M / 2 - MEMBER_M)
    opening = (sight[0] - MOUNT_M, sight[1] - MOUNT_M)
    bevel = 0.0022
    a.add(frame(), oak("oak"), place)
    mount = card("mount", "#efe9dc")
    inner = (opening[0] + bevel, opening[1] + bevel)
    a.add(window(sight, inner, SHEET_DEPTH_M, SHEET_DEPTH_M), mount, place, density=0.8)
    a.add(
        window(inner, opening, SHEET_DEPTH_M, SHEET_DEPTH_M - bevel),
        card("core", "#fbf8f0"),
        place,
        density=0.8,
    )
    face = sheet(-opening[0], -opening[1], opening[0], opening[1], SHEET_DEPTH_M - bevel)
    a.add(face, print_recipe(), place, density=1.5)
    a.add(back(), card("backing", "#7d6b55"), place, density=0.12)
    whole = a.finish()
    textures = bake.bake(whole, a.recipes, 1024, scratch, occlusion_m=0.03)
    export.dress(whole, export.baked_material("poster", textures))
    return False
