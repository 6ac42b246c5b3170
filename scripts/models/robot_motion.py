"""Rig and clips of the robot: a tree of rigid parts, and three loops sampled at 24 frames a second.

A pose gives each part's movement from rest: an offset in metres, a rotation and a stretch in z, in
the axes of the model (x to the robot's left, front -y, z up). Feet are planted first and legs
follow: a leg stands on its ankle and points at its hip, its top end sliding inside the body.
"""

import math

import bpy
from mathutils import Quaternion, Vector

RATE_HZ = 24
PARENTS = {
    "head": "body",
    "eyes": "head",
    "antenna": "head",
    "key": "body",
    "arm_left": "body",
    "arm_right": "body",
    "forearm_left": "arm_left",
    "forearm_right": "arm_right",
}
HIP_HEIGHT_M = 0.078
TOE_Y_M, HEEL_Y_M, SOLE_Z_M = -0.046, 0.030, -0.036  # from the ankle
STRIDE_M, LIFT_M = 0.052, 0.013


class Pose:
    def __init__(self):
        self.offset = {}
        self.turn = {}
        self.stretch = {}

    def move(self, part, x=0.0, y=0.0, z=0.0):
        self.offset[part] = Vector((x, y, z))

    def rotate(self, part, pitch=0.0, roll=0.0, yaw=0.0):
        """Degrees about x (positive leans back), y and z."""
        turns = ((pitch, (1, 0, 0)), (roll, (0, 1, 0)), (yaw, (0, 0, 1)))
        rotation = Quaternion()
        for degrees, axis in turns:
            rotation = Quaternion(axis, math.radians(degrees)) @ rotation
        self.turn[part] = rotation


def wave(t, cycles=1.0, phase=0.0):
    """A sine of t in 0..1 with whole cycles, so that clips loop."""
    return math.sin(2 * math.pi * (cycles * t + phase))


def ease(t, start, end):
    t = min(max((t - start) / (end - start), 0.0), 1.0)
    return t * t * (3 - 2 * t)


def blink(t, *moments):
    """Eye opening, 1 open, near 0 at the moments."""
    closed = max(max(0.0, 1 - abs(t - m) / 0.022) for m in moments)
    return 1 - 0.92 * min(1.0, 1.5 * closed)


def idle(t):
    pose = Pose()
    pose.move("body", z=0.0012 * wave(t, 2))
    pose.rotate("body", pitch=-1.0 * wave(t, 2, 0.1), roll=1.2 * wave(t))
    look = 14 * (ease(t, 0.14, 0.22) - ease(t, 0.40, 0.48)) - 11 * (
        ease(t, 0.58, 0.64) - ease(t, 0.84, 0.92)
    )
    pose.rotate("head", pitch=1.6 * wave(t, 2, 0.2), roll=-3 * wave(t, 1, 0.05), yaw=look)
    pose.rotate("antenna", pitch=4 * wave(t, 4), roll=3 * wave(t, 3, 0.2))
    pose.stretch["eyes"] = blink(t, 0.17, 0.53, 0.61)
    for side, name in ((1, "left"), (-1, "right")):
        pose.rotate(
            f"arm_{name}", pitch=3 * wave(t, 2, 0.1 * side), roll=-side * (2 + 2 * wave(t, 2, 0.3))
        )
        pose.rotate(f"forearm_{name}", pitch=-8 - 3 * wave(t, 2, 0.2))
    pose.rotate("key", roll=360 * t)
    plant_feet(pose)
    return pose


def walk(t):
    """On the spot, as on a treadmill: a stride of STRIDE_M twice a loop."""
    pose = Pose()
    sway = wave(t, 1, 0.0)
    pose.move("body", x=0.006 * sway, z=0.0035 * math.cos(4 * math.pi * t + 0.9) - 0.002)
    pose.rotate("body", pitch=4, roll=3.5 * sway, yaw=5 * wave(t, 1, 0.25))
    pose.rotate(
        "head",
        pitch=-3 + 1.5 * wave(t, 2, 0.1),
        roll=-4.5 * wave(t, 1, -0.04),
        yaw=-5 * wave(t, 1, 0.25),
    )
    pose.rotate("antenna", pitch=9 * wave(t, 2, 0.1), roll=6 * wave(t, 1, -0.12))
    pose.stretch["eyes"] = 1.0
    for side, name in ((1, "left"), (-1, "right")):
        swing = side * wave(t, 1, 0.25)
        pose.rotate(f"arm_{name}", pitch=28 * swing, roll=-side * 4)
        pose.rotate(f"forearm_{name}", pitch=-26 - 12 * swing)
    pose.rotate("key", roll=360 * t)
    plant_feet(pose, lambda side: step(t if side > 0 else t + 0.5))
    return pose


def step(phase):
    """Foot of one leg: stands and moves back for half of the loop, then swings to the front."""
    phase %= 1.0
    if phase < 0.5:
        forward, lift, swing = 0.5 - 2 * phase, 0.0, 0.0
    else:
        swing = 2 * phase - 1
        forward, lift = ease(swing, 0, 1) - 0.5, math.sin(math.pi * swing)
    toe_down = math.sin(math.pi * min(1.0, swing / 0.5)) if swing < 0.5 else 0.0
    toe_up = math.sin(math.pi * (swing - 0.5) / 0.5) if swing > 0.5 else 0.0
    return -STRIDE_M * forward, LIFT_M * lift, 16 * toe_down - 12 * toe_up


def greet(t):
    """Raises its right arm, waves four times and lowers it."""
    pose = Pose()
    up = ease(t, 0.04, 0.2) - ease(t, 0.82, 0.97)
    shake = up * wave(min(max((t - 0.2) / 0.62, 0.0), 1.0), 4)
    pose.move("body", z=0.001 * wave(t, 2))
    pose.rotate("body", roll=-4 * up, yaw=4 * up, pitch=-1.0 * up)
    pose.rotate("head", roll=9 * up + 1.2 * shake, yaw=-4 * up, pitch=-4 * up)
    pose.rotate("antenna", pitch=3 * wave(t, 4), roll=-9 * shake)
    pose.stretch["eyes"] = min(1 - 0.3 * up, blink(t, 0.1))
    pose.rotate("arm_right", roll=112 * up + 5 * shake, pitch=-12 * up)
    pose.rotate("forearm_right", roll=30 * up + 27 * shake, pitch=-8 * (1 - up))
    pose.rotate("arm_left", roll=-5 * up, pitch=6 * up)
    pose.rotate("forearm_left", pitch=-8 - 14 * up)
    pose.rotate("key", roll=360 * t)
    plant_feet(pose)
    return pose


CLIPS = {"Idle": (idle, 4.0), "Walk": (walk, 1.0), "Wave": (greet, 3.0)}


def plant_feet(pose, foot=lambda side: (0.0, 0.0, 0.0)):
    """Sets feet (backward m, lift m, toe-down degrees) and the legs between them and the body."""
    for side, name in ((1, "left"), (-1, "right")):
        back, lift, toe_down = foot(side)
        pose.rotate(f"foot_{name}", pitch=toe_down)
        turn = pose.turn[f"foot_{name}"]
        lowest = min((turn @ Vector((0, y, SOLE_Z_M))).z for y in (TOE_Y_M, HEEL_Y_M))
        pose.move(f"foot_{name}", y=back, z=lift + SOLE_Z_M - lowest)
        pose.offset[f"leg_{name}"] = pose.offset[f"foot_{name}"]


def point_legs(pose, pivots):
    """Turns each leg from its ankle towards its hip, once the body's pose is known."""
    body = Vector(pivots["body"])
    placed = body + pose.offset.get("body", Vector())
    for name in ("left", "right"):
        ankle = Vector(pivots[f"leg_{name}"])
        hip = Vector((ankle.x, 0, HIP_HEIGHT_M))
        moved_hip = placed + pose.turn.get("body", Quaternion()) @ (hip - body)
        direction = moved_hip - ankle - pose.offset[f"leg_{name}"]
        pose.turn[f"leg_{name}"] = Vector((0, 0, 1)).rotation_difference(direction)


def animate(objects, pivots):
    """Parents the parts and gives each one track per clip; tracks of a name become one clip."""
    root = bpy.data.objects.new("robot", None)
    bpy.context.scene.collection.objects.link(root)
    rest = {}
    for part, obj in objects.items():
        parent = PARENTS.get(part)
        obj.parent = objects[parent] if parent else root
        origin = Vector(pivots[parent]) if parent else Vector()
        rest[part] = Vector(pivots[part]) - origin
        obj.location = rest[part]
        obj.rotation_mode = "QUATERNION"
    for clip, (pose_at, seconds) in CLIPS.items():
        count = round(seconds * RATE_HZ)
        poses = [pose_at(i / count) for i in range(count + 1)]
        for pose in poses:
            point_legs(pose, pivots)
        for part, obj in objects.items():
            _write_track(obj, clip, part, rest[part], poses)


def _write_track(obj, clip, part, rest, poses):
    places, turns, stretches = [], [], []
    for pose in poses:
        places.append(rest + pose.offset.get(part, Vector()))
        turn = pose.turn.get(part, Quaternion()).copy()
        if turns:
            turn.make_compatible(turns[-1])
        turns.append(turn)
        stretches.append(Vector((1, 1, pose.stretch.get(part, 1.0))))
    action = bpy.data.actions.new(f"{clip}.{part}")
    for path, values in (
        ("location", places),
        ("rotation_quaternion", turns),
        ("scale", stretches),
    ):
        for axis in range(len(values[0])):
            curve = action.fcurves.new(path, index=axis)
            curve.keyframe_points.add(len(values))
            for i, value in enumerate(values):
                point = curve.keyframe_points[i]
                point.co = (i, value[axis])
                point.interpolation = "LINEAR"
    obj.animation_data_create()
    track = obj.animation_data.nla_tracks.new()
    track.name = clip
    track.strips.new(clip, 0, action)
    obj.animation_data.action = None
