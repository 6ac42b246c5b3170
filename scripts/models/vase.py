"""A thrown stoneware vase, 0.24 m tall, with two glazes that ran in the kiln."""

import numpy as np

from models import bake, drawing, export
from models.assembly import Assembly
from models.recipes import Graph
from models.shapes import turned

PICTURE_PX = (1400, 1200)
STEPS = 56
CLAY, IRON = drawing.srgb("#bd9873"), drawing.srgb("#4a2c1b")
TEAL_THIN, TEAL_DEEP = drawing.srgb("#5fa9a2"), drawing.srgb("#0f4a57")
RUST, CREAM = drawing.srgb("#8a4a22"), drawing.srgb("#efe5cf")


def profile():
    """(radius, z) from the middle of the foot, up the outside, over the lip and down inside."""
    control = np.array(
        [
            (0.040, 0.0),
            (0.044, 0.006),
            (0.062, 0.055),
            (0.068, 0.095),
            (0.058, 0.145),
            (0.034, 0.188),
        ]
        + [(0.0265, 0.212), (0.030, 0.230), (0.0365, 0.2395)]
    )
    outside = spline(control, 30)
    inside = [(r - 0.0045, z - 0.0005) for r, z in outside[:9:-2]]
    foot = [(0.030, 0.004), (0.0335, 0.0005)]
    lip = [(outside[-1][0] - 0.0016, outside[-1][1] + 0.0018)]
    return foot + [tuple(p) for p in outside] + lip + inside


def spline(points, count):
    """Catmull-Rom through the points, evenly spread over their index."""
    padded = np.vstack([2 * points[0] - points[1], points, 2 * points[-1] - points[-2]])
    out = []
    for s in np.linspace(0, len(points) - 1 - 1e-9, count):
        i, t = int(s), s - int(s)
        a, b, c, d = padded[i : i + 4]
        out.append(
            0.5
            * (
                2 * b
                + (c - a) * t
                + (2 * a - 5 * b + 4 * c - d) * t**2
                + (3 * b - a - 3 * c + d) * t**3
            )
        )
    return out


class Surface:
    """Every texel of the picture on the vase: u round it, radius, z, and whether it is inside."""

    def __init__(self, points):
        width, height = PICTURE_PX
        points = np.array(points)
        run = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
        v = (np.arange(height)[::-1] + 0.5) / height * run[-1]
        self.u = np.tile((np.arange(width) + 0.5) / width, (height, 1))
        self.radius = np.tile(np.interp(v, run, points[:, 0])[:, None], (1, width))
        self.z = np.tile(np.interp(v, run, points[:, 1])[:, None], (1, width))
        self.inside = np.tile((v > run[np.argmax(points[:, 1])])[:, None], (1, width))


def glaze_distance(s, level, wander, drips, seed):
    """Signed distance in metres (about) to a poured glaze's edge, negative where there is glaze."""
    random = np.random.RandomState(seed)
    edge = level + wander * (2 * drawing.fractal_noise(s.u * 5, 0 * s.u, seed, 3, wrap_x=5) - 1)
    distance = edge - s.z
    for start in (np.arange(drips) + random.uniform(-0.3, 0.3, drips)) / drips:
        length, half = random.uniform(0.008, 0.046), random.uniform(0.0026, 0.0048)
        across = ((s.u - start + 0.5) % 1.0 - 0.5) * 2 * np.pi * s.radius
        across = across + 0.0016 * np.sin(s.z * 90 + 40 * start)
        tip = level - length
        along = np.maximum(np.maximum(tip - s.z, s.z - level - 0.01), 0)
        bead = half * (1 + 0.28 * drawing.smoothstep(0.012, 0.0, np.abs(s.z - tip)))
        distance = smooth_union(distance, np.hypot(across, along) - bead, 0.006)
    return np.where(s.inside, -0.02, distance)


def smooth_union(a, b, reach):
    h = np.clip(0.5 + 0.5 * (b - a) / reach, 0, 1)
    return b + (a - b) * h - reach * h * (1 - h)


def thickness(distance):
    """Of a glaze coat, 0..1 and more: none outside, a fat rolled edge, then an even coat."""
    coat = drawing.smoothstep(0.0006, -0.0022, distance)
    roll = drawing.smoothstep(0.0, -0.002, distance) * drawing.smoothstep(-0.008, -0.002, distance)
    return coat + 0.7 * roll


def pictures(points):
    """Colour, roughness and relief (metres) over the decal."""
    s = Surface(points)
    speck = drawing.value_noise(s.u * 190, s.z * 450, 3, wrap_x=190)
    mottle = drawing.fractal_noise(s.u * 12, s.z * 28, 7, 5, wrap_x=12)
    streak = drawing.fractal_noise(s.u * 70, s.z * 16, 11, 4, wrap_x=70)
    clay = CLAY * (0.80 + 0.4 * mottle)[..., None]
    clay = drawing.paint(clay, IRON, 0.85 * drawing.smoothstep(0.90, 0.96, speck))
    teal_edge = glaze_distance(s, 0.086, 0.010, 13, 21)
    cream_edge = np.where(s.inside, 0.02, glaze_distance(s, 0.186, 0.006, 10, 33))
    teal, cream = thickness(teal_edge), thickness(cream_edge)
    depth = np.clip(0.55 * teal + 0.75 * (streak - 0.5) + 0.35 * (mottle - 0.5), 0, 1)
    glaze = TEAL_THIN + (TEAL_DEEP - TEAL_THIN) * depth[..., None]
    glaze = drawing.paint(glaze, TEAL_THIN * 1.25, 0.5 * drawing.smoothstep(0.58, 0.72, streak))
    image = drawing.paint(clay, RUST, 0.8 * drawing.smoothstep(0.0030, 0.0, teal_edge))
    image = drawing.paint(image, glaze, drawing.smoothstep(0.0004, -0.0008, teal_edge))
    milk = drawing.paint(
        np.ones_like(image) * CREAM, TEAL_THIN, 0.30 * drawing.smoothstep(0.45, 0.75, streak)
    )
    milk = drawing.paint(milk, RUST * 1.2, 0.6 * drawing.smoothstep(0.93, 0.97, speck))
    image = drawing.paint(image, TEAL_DEEP * 0.7, 0.7 * drawing.smoothstep(0.0035, 0.0, cream_edge))
    image = drawing.paint(image, milk, drawing.smoothstep(0.0004, -0.0012, cream_edge))
    lip = drawing.smoothstep(0.2375, 0.2400, s.z)
    image = drawing.paint(image, RUST, 0.75 * lip)
    glazed = np.clip(np.maximum(teal, cream), 0, 1)
    roughness = 0.86 - 0.70 * glazed
    throwing = 0.00016 * np.sin(s.z * 2 * np.pi / 0.0062 + 6.28 * s.u) * (1 - 0.88 * glazed)
    grit = (
        0.00010
        * (drawing.fractal_noise(s.u * 160, s.z * 380, 13, 2, wrap_x=160) - 0.5)
        * (1 - glazed)
    )
    relief = 0.0007 * teal + 0.0007 * cream + throwing + grit
    return image, roughness, relief


def build(scratch):
    points = profile()
    image, roughness, relief = pictures(points)
    g = Graph("glaze")
    dust = g.math("MULTIPLY", g.ramp(g.crevice(0.03), 0.6, 1.0), 0.5)
    colour = g.mix(dust, g.picture(image, "colour", True), (0.02, 0.02, 0.02))
    recipe = g.recipe(
        colour,
        g.picture(roughness, "roughness", False),
        0.0,
        g.picture(relief, "relief", False),
    )
    a = Assembly("vase")
    a.add(turned(points, STEPS, caps=(True, True)), recipe)
    whole = a.finish()
    textures = bake.bake(whole, a.recipes, 1024, scratch, occlusion_m=0.06)
    export.dress(whole, export.baked_material("vase", textures))
    return False
