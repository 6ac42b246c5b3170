"""A wooden alphabet block, 6 cm, with painted frames and the letters of our name."""

import math

import numpy as np
from mathutils import Matrix

from models import bake, drawing, export
from models.assembly import Assembly
from models.recipes import Graph
from models.shapes import Shape, fillet, loft, rounded_rectangle, shell

SIDE_M = 0.060
CORE_M = 0.0564  # the block without its raised frames
FRAME_M = 0.0065
LETTER_PX = 384
# (letter, colour, how the face's own x-y plane turns to that side of the block); front first.
SIDES = (
    ("P", "#d8432f", Matrix()),
    ("L", "#2f78b7", Matrix.Rotation(math.radians(90), 4, "Z")),
    ("A", "#e9a21f", Matrix.Rotation(math.radians(180), 4, "Z")),
    ("N", "#3d9a57", Matrix.Rotation(math.radians(270), 4, "Z")),
    ("E", "#7a4fa3", Matrix.Rotation(math.radians(-90), 4, "X")),
    ("C", "#d3652b", Matrix.Rotation(math.radians(90), 4, "X")),
)
STAND = Matrix.Rotation(math.pi / 2, 4, "X")  # the front face's own z becomes the block's front


def beech(g):
    """Colour and height of sawn beech: rays and growth rings through the solid, grain along x."""
    rings = g.noise(0.016, 2.0, stretch=(0.12, 1.0, 1.0))
    wave = g.math("SINE", g.math("MULTIPLY", rings, 75.0))
    fine = g.noise(0.0022, 3.0, stretch=(0.07, 1.0, 1.0))
    flecks = g.ramp(g.noise(0.0016, 1.0, stretch=(0.22, 1.0, 1.0)), 0.62, 0.70)
    tone = g.math("ADD", g.lerp(wave, 0.30, 0.48), g.math("MULTIPLY", fine, 0.45))
    colour = g.mix(tone, drawing.srgb("#ecca98"), drawing.srgb("#c08a51"))
    colour = g.mix(g.math("MULTIPLY", flecks, 0.5), colour, drawing.srgb("#8f5c30"))
    height = g.math("MULTIPLY", g.math("ADD", fine, flecks), -0.00005)
    return colour, height


def bare_wood(name):
    g = Graph(name)
    colour, height = beech(g)
    worn = g.ramp(g.edge(0.006), 0.35, 0.8)
    colour = g.mix(g.math("MULTIPLY", worn, 0.35), colour, drawing.srgb("#8a5c36"))
    dust = g.math("MULTIPLY", g.ramp(g.crevice(0.004), 0.3, 0.95), 0.6)
    return g.recipe(g.mix(dust, colour, drawing.srgb("#3c2614")), 0.55, 0.0, height)


def painted_wood(name, hex_code):
    """Milk paint, thin enough to show the grain, rubbed off at the edges."""
    g = Graph(name)
    wood, grain = beech(g)
    ink = drawing.srgb(hex_code)
    rub = g.math(
        "ADD", g.edge(0.0022), g.math("MULTIPLY", g.math("SUBTRACT", g.noise(0.006, 5.0), 0.5), 1.3)
    )
    bare = g.ramp(rub, 0.66, 0.78)
    coat = g.mix(g.noise(0.01, 4.0), 0.88 * ink, 1.08 * ink)
    coat = g.mix(0.10, coat, wood)
    height = g.math("ADD", grain, g.math("MULTIPLY", bare, -0.0001))
    return g.recipe(g.mix(bare, coat, wood), g.lerp(bare, 0.42, 0.6), 0.0, height)


def letter_masks(letter):
    """Coverage of the letter and of the thin square round it, and a relief in 0..1."""
    x, y = drawing.grid(LETTER_PX, LETTER_PX)
    x, y = x / LETTER_PX, y / LETTER_PX
    soft = 1.0 / LETTER_PX
    size = 0.50
    width = max(px for stroke in drawing.LETTERS[letter] for px, _ in stroke)
    distance = drawing.letter_distance(x, y, letter, 0.5 - width * size / 2, 0.25, size) - 0.066
    line = np.abs(drawing.box_distance(x, y, 0.5, 0.5, 0.415, 0.415, 0.05)) - 0.008
    cover = np.maximum(drawing.cover(distance, soft), drawing.cover(line, soft))
    return cover, drawing.smoothstep(0.012, -0.012, distance)


def letter_panel(letter, hex_code):
    g = Graph(f"panel {letter}")
    cover, relief = letter_masks(letter)
    wood, grain = beech(g)
    ink = drawing.srgb(hex_code)
    worn = g.ramp(g.noise(0.005, 6.0, roughness=0.7), 0.60, 0.68)
    painted = g.math(
        "MULTIPLY", g.picture(cover, f"cover {letter}", False), g.math("SUBTRACT", 1.0, worn)
    )
    coat = g.mix(g.noise(0.008, 4.0), 0.9 * ink, 1.06 * ink)
    colour = g.mix(painted, wood, coat)
    dust = g.math("MULTIPLY", g.ramp(g.crevice(0.004), 0.35, 1.0), 0.6)
    raised = g.math("MULTIPLY", g.picture(relief, f"relief {letter}", False), 0.0006)
    roughness = g.lerp(painted, 0.58, 0.42)
    return g.recipe(
        g.mix(dust, colour, drawing.srgb("#3c2614")), roughness, 0.0, g.math("ADD", raised, grain)
    )


def frame():
    """The raised border of one face, centred, its foot at z = 0."""
    height = (SIDE_M - CORE_M) / 2
    half = SIDE_M / 2 - 0.0016
    profile = fillet(
        [(0, -0.0012), (0, height), (-FRAME_M, height), (-FRAME_M - 0.0008, 0)],
        [0, 0.0014, 0.0007, 0],
        4,
    )
    rings = []
    for offset, z in profile:
        side = 2 * (half + offset)
        rings.append(
            [
                (x, y, z)
                for x, y in rounded_rectangle(side, side, max(0.004 + 0.5 * offset, 0.0012), 4)
            ]
        )
    return loft(rings, False, False, charts="box")


def panel():
    half = CORE_M / 2 - FRAME_M + 0.002
    lift = 0.0003
    shape = Shape(
        vertices=[
            (-half, -half, lift),
            (half, -half, lift),
            (half, half, lift),
            (-half, half, lift),
        ]
    )
    shape.add_face([0, 1, 2, 3], [v[:2] for v in shape.vertices], [(0, 0), (1, 0), (1, 1), (0, 1)])
    return shape


def build(scratch):
    a = Assembly("block")
    centre = Matrix.Translation((0, 0, SIDE_M / 2))
    edge = 0.0035
    profile = [(-edge, -CORE_M / 2), (0, -CORE_M / 2), (0, CORE_M / 2), (-edge, CORE_M / 2)]
    core = shell(
        CORE_M,
        CORE_M,
        edge,
        fillet(profile, [0, edge * 0.98, edge * 0.98, 0], 4),
        4,
        caps=(True, True),
    )
    a.add(core, bare_wood("beech"), centre, density=0.7)
    for letter, hex_code, turn in SIDES:
        place = centre @ turn @ STAND @ Matrix.Translation((0, 0, CORE_M / 2))
        a.add(frame(), painted_wood(f"frame {letter}", hex_code), place)
        a.add(panel(), letter_panel(letter, hex_code), place, density=1.25)
    whole = a.finish()
    textures = bake.bake(whole, a.recipes, 1024, scratch, occlusion_m=0.012)
    export.dress(whole, export.baked_material("block", textures))
    return False
