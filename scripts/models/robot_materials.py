"""What the toy robot is made of: enamel, rubber, metal, glass, lamps and a printed dial."""

import math

import numpy as np

from models import drawing
from models.recipes import Graph, bare_metal, dark_glass, glowing, painted_metal, rubber

TEAL = drawing.srgb("#1f8f93")
ORANGE = drawing.srgb("#ec6a2c")
CREAM = drawing.srgb("#f1e3c4")
EYE_LIGHT = drawing.srgb("#8ff4ff")
LAMP_LIGHT = drawing.srgb("#ff7a2e")
HEART_LIGHT = drawing.srgb("#ff3f55")


def recipes(face_z):
    """The robot's materials by name; face_z is the height of the middle of its face."""
    return {
        "teal": painted_metal("teal", TEAL, wear=0.42, second=CREAM, split_z=0.083),
        "blue": painted_metal("blue", TEAL, wear=0.42),
        "orange": painted_metal("orange", ORANGE, wear=0.36, reach_m=0.006),
        "cream": painted_metal("cream", CREAM, wear=0.22, reach_m=0.0015),
        "rubber": rubber("rubber"),
        "slot": rubber("slot", (0.006, 0.006, 0.007), scuffed=0.0),
        "steel": bare_metal("steel", (0.62, 0.61, 0.60), (0.28, 0.26, 0.24)),
        "brass": bare_metal("brass", (0.78, 0.55, 0.22), (0.30, 0.19, 0.08)),
        "glass": dark_glass("glass", face_z - 0.002, face_z + 0.055),
        "eye": glowing("eye", EYE_LIGHT),
        "glint": glowing("glint", (0.95, 1.0, 1.0)),
        "cheek": glowing("cheek", [0.55 * c for c in HEART_LIGHT]),
        "lamp": glowing("lamp", LAMP_LIGHT),
        "heart": glowing("heart", HEART_LIGHT),
        "dial": dial_recipe(),
    }


def dial_recipe():
    size = 192
    x, y = drawing.grid(size, size)
    x, y = x / size * 2 - 1, y / size * 2 - 1
    soft = 2.0 / size
    radius, angle = np.hypot(x, y), np.degrees(np.arctan2(x, -y))
    image = np.ones((size, size, 3)) * drawing.srgb("#f7efdc")
    red_zone = drawing.cover(np.abs(radius - 0.72) - 0.07, soft) * (angle > 55) * (angle < 122)
    image = drawing.paint(image, drawing.srgb("#d8402f"), red_zone)
    for tick in range(-120, 121, 24):
        a = math.radians(tick)
        inner, outer = (0.62, 0.84)
        ends = [(r * math.sin(a), -r * math.cos(a)) for r in (inner, outer)]
        distance = drawing.segment_distance(x, y, *ends) - 0.028
        image = drawing.paint(image, (0.02, 0.02, 0.025), drawing.cover(distance, soft))
    a = math.radians(38)
    needle = drawing.segment_distance(x, y, (0, 0), (0.62 * math.sin(a), -0.62 * math.cos(a)))
    image = drawing.paint(image, drawing.srgb("#c8321f"), drawing.cover(needle - 0.045, soft))
    image = drawing.paint(image, (0.02, 0.02, 0.025), drawing.cover(radius - 0.13, soft))
    g = Graph("dial")
    return g.recipe(g.picture(image, "dial", True), 0.22)
