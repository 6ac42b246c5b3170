"""A wind-up toy robot of painted tin, 0.31 m tall, that idles, walks and waves."""

import math

from mathutils import Matrix

from models import bake, export, robot_materials, robot_motion
from models.assembly import Assembly
from models.shapes import ball, fillet, hose, loft, rounded_rectangle, shell, tube, turned

FRONT = Matrix.Rotation(math.pi / 2, 4, "X")  # a shape's z becomes the robot's front
BACK = Matrix.Rotation(math.pi, 4, "Z") @ FRONT
FACE_Y, FACE_Z = -0.052, 0.225
PIVOTS = {
    "body": (0, 0, 0.075),
    "head": (0, 0, 0.172),
    "eyes": (0, FACE_Y - 0.003, 0.230),
    "antenna": (0, 0.008, 0.271),
    "key": (0, 0.055, 0.118),
    "arm_left": (0.070, 0, 0.138),
    "arm_right": (-0.070, 0, 0.138),
    "leg_left": (0.034, 0, 0.036),
    "leg_right": (-0.034, 0, 0.036),
    "foot_left": (0.034, 0, 0.036),
    "foot_right": (-0.034, 0, 0.036),
}
ARM_TILT_RAD = math.radians(11)
UPPER_ARM_M = 0.046


def elbow(side):
    """Elbow in the rest pose; side is +1 for the robot's left."""
    x, y, z = PIVOTS["arm_left"]
    reach = UPPER_ARM_M
    return (side * (x + reach * math.sin(ARM_TILT_RAD)), y, z - reach * math.cos(ARM_TILT_RAD))


def at(x, y, z, turn=None):
    return Matrix.Translation((x, y, z)) @ (turn or Matrix())


def heart_outline(size, steps=28):
    points = []
    for i in range(steps):
        t = 2 * math.pi * i / steps
        y = 13 * math.cos(t) - 5 * math.cos(2 * t) - 2 * math.cos(3 * t) - math.cos(4 * t)
        points.append((-size * 16 * math.sin(t) ** 3 / 17, size * (y + 2.5) / 17))
    return points


def heart(size):
    rings = []
    for scale, z in ((1.0, -0.002), (1.0, 0.001), (0.9, 0.0026), (0.7, 0.0036), (0.35, 0.0042)):
        rings.append([(x * scale, y * scale, z) for x, y in heart_outline(size)])
    return loft(rings, charts="box")


def rivet(radius):
    """A low dome round z, open below."""
    angles = [math.radians(d) for d in (-25, 20, 55)]
    return turned(
        [(radius * math.cos(t), radius * math.sin(t)) for t in angles], 7, "box", (False, True)
    )


def build_head(a, r):
    profile = [(-0.036, 0.178), (0, 0.178), (0.001, 0.225), (-0.001, 0.271), (-0.036, 0.271)]
    head = shell(
        0.138, 0.104, 0.036, fillet(profile, [0, 0.024, 0, 0.028, 0], 5), caps=(True, True)
    )
    a.add(head, r["blue"], part="head")
    frame_profile = [
        (0.005, -0.006),
        (0.005, 0.0018),
        (0.0038, 0.003),
        (0.0008, 0.003),
        (0, -0.001),
    ]
    frame = shell(0.100, 0.062, 0.027, frame_profile, 7, caps=(False, False))
    a.add(frame, r["cream"], at(0, FACE_Y, FACE_Z, FRONT), "head", 1.3)
    dome = [
        (0.001, -0.003),
        (0, 0),
        (-0.003, 0.0012),
        (-0.009, 0.0022),
        (-0.017, 0.0028),
        (-0.026, 0.003),
    ]
    a.add(
        shell(0.100, 0.062, 0.027, dome, 7), r["glass"], at(0, FACE_Y, FACE_Z, FRONT), "head", 1.3
    )
    lens = [(0, -0.002), (0, 0.0006), (-0.0012, 0.0016), (-0.004, 0.0022), (-0.007, 0.0024)]
    for side in (-1, 1):
        eye = shell(0.021, 0.027, 0.0105, lens, 5)
        a.add(eye, r["eye"], at(side * 0.022, FACE_Y - 0.0028, 0.230, FRONT), "eyes", 2)
        glint = turned([(0.0036, -0.002), (0.0034, 0.0004), (0.002, 0.0008)], 14, charts="box")
        a.add(
            glint, r["glint"], at(side * 0.022 + 0.0042, FACE_Y - 0.0048, 0.2365, FRONT), "eyes", 2
        )
        cheek = turned([(0.0042, -0.002), (0.0042, 0.0003), (0.003, 0.0009)], 20, charts="box")
        a.add(cheek, r["cheek"], at(side * 0.0355, FACE_Y - 0.0022, 0.2105, FRONT), "head", 2)
        build_ear(a, r, side)
    smile = []
    for i in range(13):
        t = i / 6 - 1
        smile.append((0.0105 * t, FACE_Y - 0.0034, 0.2072 + 0.0048 * t * t))
    radii = [0.0006] + [0.0014] * 11 + [0.0006]
    a.add(tube(smile, radii, 8), r["eye"], part="head", density=2)
    build_vent(a, r)
    a.add(hose(0.024, 0.026, 3, 0.004, 20), r["rubber"], at(0, 0, 0.156), "head", 0.7)


def build_vent(a, r):
    """A grille on the back of the head: a cream plate with dark slots and four screws."""
    plate = fillet([(0, -0.004), (0, 0.0016), (-0.008, 0.0019)], [0, 0.001, 0], 2)
    y = -FACE_Y
    a.add(shell(0.070, 0.046, 0.010, plate), r["cream"], at(0, y, FACE_Z, BACK), "head")
    for row in range(-2, 3):
        slot = shell(0.042, 0.0046, 0.0023, [(0, 0.0005), (0, 0.0020), (-0.0006, 0.0023)], 3)
        a.add(slot, r["slot"], at(0, y, FACE_Z + 0.0075 * row, BACK), "head")
    for x in (-0.029, 0.029):
        for z in (-0.017, 0.017):
            a.add(rivet(0.0024), r["steel"], at(x, y + 0.0018, FACE_Z + z, BACK), "head")


def build_ear(a, r, side):
    turn = Matrix.Rotation(side * math.pi / 2, 4, "Y")
    ring = [(0.023, 0), (0.023, 0.009), (0.0175, 0.0095), (0.0155, 0.0065)]
    profile = fillet(ring, [0, 0.003, 0.002, 0], 2)
    a.add(turned(profile, 26), r["orange"], at(side * 0.066, 0, 0.225, turn), "head")
    hub = fillet([(0.0085, 0.005), (0.0085, 0.0125), (0.002, 0.0125)], [0, 0.003, 0], 2)
    a.add(turned(hub, 16), r["steel"], at(side * 0.066, 0, 0.225, turn), "head")


def build_antenna(a, r):
    base = fillet(
        [(0.014, -0.004), (0.013, 0.002), (0.006, 0.006), (0.004, 0.011)], [0, 0.003, 0.004, 0], 2
    )
    x, y, z = PIVOTS["antenna"]
    a.add(turned(base, 16), r["steel"], at(x, y, z), "antenna")
    rod = tube([(0, 0, 0.004), (0, 0, 0.026)], [0.0019, 0.0019], 8)
    a.add(rod, r["steel"], at(x, y, z), "antenna")
    a.add(ball(0.0085, 16), r["lamp"], at(x, y, z + 0.031), "antenna", 1.4)


def build_body(a, r):
    profile = [(-0.035, 0.058), (-0.003, 0.058), (0.005, 0.112), (0.001, 0.163), (-0.035, 0.165)]
    outline = fillet(profile, [0, 0.014, 0, 0.02, 0], 5)
    a.add(shell(0.112, 0.086, 0.035, outline, caps=(True, True)), r["teal"])
    rim = fillet(
        [(0.001, 0.0795), (0.0035, 0.0805), (0.0038, 0.0855), (0.0015, 0.0865)],
        [0, 0.001, 0.001, 0],
        2,
    )
    a.add(shell(0.113, 0.087, 0.036, rim, 6, caps=(False, False)), r["steel"])
    plate = fillet([(0, -0.006), (0, 0.0022), (-0.008, 0.0026)], [0, 0.0012, 0], 3)
    a.add(shell(0.078, 0.046, 0.009, plate), r["cream"], at(0, -0.0475, 0.121, FRONT), density=1.4)
    build_dial(a, r)
    a.add(heart(0.0115), r["heart"], at(0.0195, -0.0503, 0.1225, FRONT), density=1.6)
    for x in (-0.034, 0.034):
        for z in (0.103, 0.139):
            a.add(rivet(0.0023), r["steel"], at(x, -0.0502, z, FRONT))
    outline = rounded_rectangle(0.1125, 0.0865, 0.036, 3)
    for i, (x, y) in enumerate(outline):
        (x0, y0), (x1, y1) = outline[i - 1], outline[(i + 1) % len(outline)]
        outwards = Matrix.Rotation(math.atan2(x0 - x1, y1 - y0), 4, "Z") @ Matrix.Rotation(
            math.pi / 2, 4, "Y"
        )
        a.add(rivet(0.0024), r["steel"], at(x, y, 0.0725, outwards))
    for side in (-1, 1):
        hip = fillet([(0.021, 0.052), (0.021, 0.060)], [0, 0], 1)
        a.add(turned(hip, 20), r["rubber"], at(side * 0.034, 0, 0), density=0.6)
        turn = Matrix.Rotation(side * math.pi / 2, 4, "Y")
        collar = fillet([(0.019, -0.006), (0.019, 0.003), (0.013, 0.0055)], [0, 0.002, 0], 2)
        a.add(turned(collar, 22), r["steel"], at(side * 0.0575, 0, 0.138, turn))


def build_dial(a, r):
    where = at(-0.0165, -0.0500, 0.1215, FRONT)
    rim = fillet(
        [(0.0172, -0.002), (0.0172, 0.0022), (0.0148, 0.0022), (0.0142, 0.0008)],
        [0, 0.001, 0.0008, 0],
        2,
    )
    a.add(turned(rim, 32, caps=(False, False)), r["steel"], where)
    a.add(turned([(0.0146, 0.0002), (0.0145, 0.0008)], 32), r["dial"], where, density=2.2)


def build_key(a, r):
    x, y, z = PIVOTS["key"]
    where = at(x, y, z, BACK)
    shaft = fillet([(0.0045, -0.014), (0.0045, 0.014), (0.001, 0.0155)], [0, 0.002, 0], 2)
    a.add(turned(shaft, 12), r["brass"], where, "key", 0.8)
    for side in (-1, 1):
        ring = []
        for i in range(19):
            t = 2 * math.pi * i / 18
            ring.append((side * (0.0145 - 0.0115 * math.cos(t)), 0.0105 * math.sin(t), 0.010))
        a.add(tube(ring, [0.0033] * 19, 8), r["brass"], where, "key", 0.8)
    socket = fillet([(0.012, 0), (0.012, 0.004), (0.006, 0.006)], [0, 0.0015, 0], 2)
    a.add(turned(socket, 18), r["steel"], at(x, 0.0465, z, BACK))


def build_arm(a, r, name, side):
    upper, lower = f"arm_{name}", f"forearm_{name}"
    down = Matrix.Rotation(math.pi, 4, "X")  # a limb's z points along the limb
    tilt = Matrix.Rotation(-side * ARM_TILT_RAD, 4, "Y") @ down
    x, y, z = PIVOTS[upper]
    a.add(ball(0.0165, 20), r["orange"], at(x, y, z), upper)
    a.add(hose(0.0105, 0.042, 6, 0.0028, 14), r["rubber"], at(x, y, z, tilt), upper, 0.7)
    where = Matrix.Translation(elbow(side)) @ tilt
    a.add(ball(0.0115, 14), r["steel"], where, lower)
    cuff = [(0.008, 0.003), (0.0125, 0.006), (0.0185, 0.034), (0.0165, 0.0365), (0.014, 0.033)]
    a.add(turned(fillet(cuff, [0, 0.003, 0.002, 0.001, 0], 2), 22), r["orange"], where, lower)
    a.add(turned([(0.010, 0.028), (0.010, 0.0375), (0.007, 0.040)], 16), r["steel"], where, lower)
    claw, radii = [], []
    for i in range(17):
        t = math.radians(-42 + 264 * i / 16)
        claw.append((0.0135 * math.cos(t), 0, 0.052 - 0.0135 * math.sin(t)))
        radii.append(0.0052 * min(1.0, 0.5 + 0.4 * min(i, 16 - i)))
    a.add(tube(claw, radii, 10, 1.45), r["cream"], where, lower)


def build_leg(a, r, name, side):
    x, y, z = PIVOTS[f"leg_{name}"]
    a.add(hose(0.0145, 0.037, 5, 0.003, 16), r["rubber"], at(x, y, z - 0.006), f"leg_{name}", 0.7)
    sole = fillet(
        [(-0.004, 0), (0.001, 0), (0.001, 0.0085), (-0.004, 0.0085)], [0, 0.002, 0.002, 0], 1
    )
    foot = f"foot_{name}"
    a.add(
        shell(0.053, 0.080, 0.0255, sole, 6, caps=(True, False)),
        r["rubber"],
        at(x, y - 0.008, 0),
        foot,
        0.7,
    )
    upper = fillet(
        [(0, 0.008), (0, 0.022), (-0.012, 0.035), (-0.024, 0.037)], [0, 0.008, 0.01, 0], 3
    )
    a.add(shell(0.052, 0.079, 0.025, upper, 6), r["orange"], at(x, y - 0.008, 0), foot)
    cuff = fillet([(0.0195, 0.030), (0.0195, 0.0405), (0.0155, 0.0415)], [0, 0.002, 0], 2)
    a.add(turned(cuff, 20), r["steel"], at(x, y, 0), foot)


def build(scratch):
    """Makes the scene; returns whether it is animated."""
    a, r = Assembly("robot"), robot_materials.recipes(FACE_Z)
    build_body(a, r)
    build_head(a, r)
    build_antenna(a, r)
    build_key(a, r)
    for name, side in (("left", 1), ("right", -1)):
        build_arm(a, r, name, side)
        build_leg(a, r, name, side)
    whole = a.finish()
    textures = bake.bake(whole, a.recipes, 1024, scratch, occlusion_m=0.035)
    export.dress(whole, export.baked_material("robot", textures))
    pivots = PIVOTS | {"forearm_left": elbow(1), "forearm_right": elbow(-1)}
    robot_motion.animate(a.split(whole, pivots), pivots)
    return True
