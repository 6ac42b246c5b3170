"""A Pilea in a terracotta pot with saucer, about 0.22 m tall; every leaf is real geometry."""

import math

import numpy as np
from mathutils import Matrix, Vector

from models import bake, drawing, export
from models.assembly import Assembly
from models.recipes import Graph
from models.shapes import Shape, fillet, loft, tube, turned

LEAVES = 25
GOLDEN_ANGLE_RAD = math.pi * (3 - math.sqrt(5))
SOIL_Z_M = 0.082
STEM_TOP_M = 0.168
# Where the stalk meets a leaf: this far from its centre, towards its upper edge, in radii.
NAVEL = 0.30
LEAF_TONES = (("#3f7f2c", "#79ad3f"), ("#4d8f31", "#8fbf4a"), ("#2f6d2b", "#64993a"))


def terracotta():
    g = Graph("terracotta")
    z = g.separate(g.position)["Z"]
    tone = g.mix(g.noise(0.05, 4.0), drawing.srgb("#c8744a"), drawing.srgb("#a8552f"))
    tone = g.mix(g.ramp(g.noise(0.0012, 1.0), 0.66, 0.74), tone, drawing.srgb("#7a3b22"))
    damp = g.math("ADD", g.noise(0.03, 5.0), g.lerp(z, 0.30, -0.05))
    lime = g.math("MULTIPLY", g.ramp(g.noise(0.022, 6.0, roughness=0.62), 0.50, 0.72), 0.55)
    tone = g.mix(g.math("MULTIPLY", g.ramp(damp, 0.80, 0.98), 0.35), tone, drawing.srgb("#6f3a24"))
    tone = g.mix(lime, tone, drawing.srgb("#e2c4ab"))
    worn = g.ramp(g.edge(0.004), 0.5, 0.9)
    tone = g.mix(g.math("MULTIPLY", worn, 0.35), tone, drawing.srgb("#dd9a74"))
    grime = g.math("MULTIPLY", g.ramp(g.crevice(0.012), 0.4, 1.0), 0.6)
    tone = g.mix(grime, tone, drawing.srgb("#3a2016"))
    turning = g.math(
        "SINE", g.math("ADD", g.math("MULTIPLY", z, 2100.0), g.math("MULTIPLY", g.noise(0.03), 5.0))
    )
    height = g.math(
        "ADD",
        g.math("MULTIPLY", turning, 0.00004),
        g.math("MULTIPLY", g.noise(0.0016, 3.0), 0.00020),
    )
    return g.recipe(tone, g.lerp(lime, 0.82, 0.95), 0.0, height)


def soil():
    g = Graph("soil")
    grain = g.noise(0.004, 6.0, roughness=0.7)
    tone = g.mix(grain, (0.008, 0.005, 0.003), (0.060, 0.038, 0.024))
    perlite = g.ramp(g.noise(0.0042, 0.0), 0.74, 0.78)
    tone = g.mix(perlite, tone, (0.55, 0.52, 0.46))
    return g.recipe(tone, 0.95, 0.0, g.math("MULTIPLY", grain, 0.004))


def bark():
    g = Graph("bark")
    tone = g.mix(g.noise(0.005, 5.0), drawing.srgb("#5d4a33"), drawing.srgb("#8c7a58"))
    return g.recipe(tone, 0.8, 0.0, g.math("MULTIPLY", g.noise(0.003, 3.0), 0.0006))


def stalk():
    g = Graph("stalk")
    tone = g.mix(g.noise(0.02), drawing.srgb("#6f8f3a"), drawing.srgb("#93ad55"))
    return g.recipe(tone, 0.5)


def leaf_pictures():
    """How far from dark to light green each texel is, and the veins' relief; tip at the bottom."""
    size = 320
    x, y = drawing.grid(size, size)
    x, y = x / size * 2 - 1, y / size * 2 - 1
    navel_y = -NAVEL
    dx, dy = x, y - navel_y
    reach = np.hypot(dx, dy)
    angle = np.arctan2(dx, dy)
    light = 0.32 + 0.20 * (drawing.fractal_noise(x * 3 + 9, y * 3 + 9, 51, 4) - 0.5)
    veins = np.zeros_like(x)
    for i in range(11):
        aim = math.radians(-150 + 30 * i)
        bent = (
            angle - aim + 0.10 * np.sin(3 * reach) * math.copysign(1, aim or 1) * (abs(aim) > 0.01)
        )
        off = np.abs(np.sin(bent)) * reach * (np.cos(bent) > 0) + 9 * (np.cos(bent) <= 0)
        width = 0.022 * np.clip(1.25 - reach, 0.2, 1)
        veins = np.maximum(
            veins, drawing.smoothstep(2.4 * width, 0.3 * width, off) * np.clip(1.35 - reach, 0, 1)
        )
    light = light + 0.34 * veins + 0.60 * drawing.smoothstep(0.14, 0.03, reach)
    rim = np.hypot(x, y)
    light = (
        light + 0.22 * drawing.smoothstep(0.90, 1.0, rim) - 0.12 * drawing.smoothstep(0.2, 0.8, rim)
    )
    relief = -veins - 0.8 * drawing.smoothstep(0.12, 0.0, reach)
    return np.clip(light, 0, 1), relief


def leaf_recipes():
    light, relief = leaf_pictures()
    recipes = []
    for i, (dark, bright) in enumerate(LEAF_TONES):
        g = Graph(f"leaf {i}")
        tone = g.mix(
            g.picture(light, f"light {i}", False), drawing.srgb(dark), drawing.srgb(bright)
        )
        tone = g.mix(
            0.5, tone, g.mix(g.noise(0.06, 1.0), 0.75 * drawing.srgb(dark), drawing.srgb(bright))
        )
        height = g.math("MULTIPLY", g.picture(relief, f"relief {i}", False), 0.0005)
        recipes.append(g.recipe(tone, 0.38, 0.0, height))
    return recipes


def leaf(radius, cup, wave, phase):
    """A round blade in x-y, tip at -y, upper side +z; its stalk meets it at the origin."""
    rings, sectors = 4, 24
    shape = Shape()
    hub = (0.0, NAVEL * radius)

    def point(share, sector):
        angle = 2 * math.pi * sector / sectors
        stretch = radius * share * (1 + 0.05 * math.cos(angle + math.pi / 2))
        x, y = stretch * math.cos(angle), 1.06 * stretch * math.sin(angle)
        z = -cup * radius * share**2 + wave * radius * share**3 * math.sin(3 * angle + phase)
        z += 0.07 * radius * (1 - math.exp(-((share / 0.25) ** 2)))
        return (x - hub[0], y - hub[1], z)

    def corner(ring, sector):
        return 0 if ring == 0 else 1 + (ring - 1) * sectors + sector % sectors

    shape.vertices.append(point(0, 0))
    for ring in range(1, rings + 1):
        shape.vertices += [point(ring / rings, sector) for sector in range(sectors)]
    for ring in range(rings):
        for sector in range(sectors):
            corners = [corner(ring, sector), corner(ring + 1, sector), corner(ring + 1, sector + 1)]
            if ring:
                corners.append(corner(ring, sector + 1))
            flat = [np.array(shape.vertices[c][:2]) + hub for c in corners]
            decals = [
                (0.5 + 0.5 * p[0] / (1.06 * radius), 0.5 + 0.5 * p[1] / (1.12 * radius))
                for p in flat
            ]
            shape.add_face(corners, [tuple(p) for p in flat], decals)
    return shape


def curve(a, b, c, count):
    """A quadratic Bezier from a to c."""
    points = []
    for i in range(count):
        t = i / (count - 1)
        points.append(tuple((1 - t) ** 2 * a + 2 * t * (1 - t) * b + t * t * c))
    return points


def grow(a, random):
    """Leaves from the oldest, low and wide, to the youngest, small and upright."""
    blades, stem = leaf_recipes(), stalk()
    for i in range(LEAVES):
        youth = i / (LEAVES - 1)
        azimuth = i * GOLDEN_ANGLE_RAD + random.uniform(-0.15, 0.15)
        out = Vector((math.cos(azimuth), math.sin(azimuth), 0))
        up = Vector((0, 0, 1))
        root = up * (SOIL_Z_M + 0.022 + (STEM_TOP_M - SOIL_Z_M - 0.024) * youth) + out * 0.004
        length = 0.118 * (1 - 0.62 * youth) * random.uniform(0.88, 1.12)
        rise = math.radians(24 + 54 * youth + random.uniform(-7, 7))
        reach = out * math.cos(rise) + up * math.sin(rise)
        end = root + reach * length
        middle = root + (reach + 0.38 * up).normalized() * (0.62 * length)
        radius = 0.0345 * (1 - 0.50 * youth**1.3) * random.uniform(0.86, 1.1)
        tilt = math.radians(66 - 44 * youth + random.uniform(-10, 10))
        normal = (up * math.cos(tilt) + out * math.sin(tilt)).normalized()
        thick = 0.0017 - 0.0006 * youth
        a.add(
            tube(curve(root, middle, end, 8), [thick * (1.25 - 0.45 * t / 7) for t in range(8)], 6),
            stem,
            density=0.6,
        )
        tip = out * math.cos(tilt) - up * math.sin(tilt)
        side = tip.cross(normal).normalized()
        frame = Matrix((side, -tip, normal)).transposed().to_4x4()
        frame = (
            Matrix.Translation(end) @ frame @ Matrix.Rotation(random.uniform(-0.35, 0.35), 4, "Z")
        )
        blade = leaf(
            radius, random.uniform(0.10, 0.22), random.uniform(0.02, 0.06), random.uniform(0, 6.3)
        )
        a.add(blade, blades[random.randint(len(blades))], frame, density=1.3)


def add_pot(a):
    clay = terracotta()
    pot = [(0.030, 0.0075), (0.0375, 0.0075), (0.0505, 0.072), (0.0545, 0.0722), (0.0565, 0.0945)]
    pot += [(0.0515, 0.0955), (0.0490, 0.076)]
    radii = [0, 0.002, 0.0012, 0.0016, 0.002, 0.0016, 0]
    a.add(turned(fillet(pot, radii, 3), 48, caps=(True, False)), clay)
    saucer = [
        (0.030, 0.0),
        (0.046, 0.0),
        (0.0535, 0.0135),
        (0.0505, 0.0142),
        (0.0445, 0.0050),
        (0.020, 0.0050),
    ]
    a.add(
        turned(fillet(saucer, [0, 0.002, 0.0012, 0.0012, 0.003, 0], 3), 48, caps=(True, True)), clay
    )
    rings = []
    for share in (1.0, 0.82, 0.62, 0.42, 0.22, 0.08):
        ring = []
        for k in range(32):
            angle = 2 * math.pi * k / 32
            x, y = 0.0500 * share * math.cos(angle), 0.0500 * share * math.sin(angle)
            lump = drawing.fractal_noise(np.array(x * 90 + 40), np.array(y * 90 + 40), 61, 3)
            ring.append((x, y, SOIL_Z_M - 0.003 + 0.006 * float(lump) + 0.004 * (1 - share)))
        rings.append(ring)
    a.add(loft(rings, False, True, charts="box"), soil(), density=0.8)
    bend = [
        (0, 0, SOIL_Z_M - 0.004),
        (0.003, 0.001, 0.105),
        (-0.001, 0.002, 0.13),
        (0, 0, STEM_TOP_M),
    ]
    a.add(tube(bend, [0.0062, 0.0056, 0.0048, 0.0028], 12), bark(), density=0.6)


def build(scratch):
    a = Assembly("plant")
    add_pot(a)
    grow(a, np.random.RandomState(8))
    whole = a.finish()
    textures = bake.bake(whole, a.recipes, 1024, scratch, occlusion_m=0.05)
    export.dress(whole, export.baked_material("plant", textures, double_sided=True))
    return False
