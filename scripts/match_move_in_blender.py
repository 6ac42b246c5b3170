"""Opens a match-move scene (scene.glb) in Blender so that its camera fits the footage.

    blender -P scripts/match_move_in_blender.py -- scene.glb [--footage augmented.mp4] [--save FILE.blend]
    blender -b -P scripts/match_move_in_blender.py -- scene.glb --pixels IN.json OUT.json

Sets frame rate, picture size, frame range, field of view and principal point, which glTF has no or
only approximate words for; the footage, if given, is put behind the camera's view. Frame 0 is the
first picture. With --pixels it only computes where points are seen: IN.json is
{"frames": [...], "points": [[x, y, z], ...]} in the reconstruction's world, OUT.json gets
[[[u, v], ...] of each frame], pixel centres at whole numbers.
"""

import json
import math
import struct
import sys

import bpy
import numpy
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Matrix, Quaternion, Vector


# Debian 12's importer asks for a name that its own numpy no longer has.
if not hasattr(numpy, "bool"):
    numpy.bool = bool


def read_json_chunk(path):
    """The glTF document of a .glb file."""
    with open(path, "rb") as file:
        magic, _, _ = struct.unpack("<4sII", file.read(12))
        length, kind = struct.unpack("<I4s", file.read(8))
        if magic != b"glTF" or kind != b"JSON":
            sys.exit(f"{path}: not a .glb file")
        return json.loads(file.read(length))


def set_up_scene(scene, world, camera):
    """Blender places glTF's keys by the scene's frame rate, so this comes before the import."""
    fps = world["fps"]
    scene.render.fps = max(1, round(fps))
    scene.render.fps_base = scene.render.fps / fps
    scene.render.resolution_x = camera["width"]
    scene.render.resolution_y = camera["height"]
    scene.render.resolution_percentage = 100
    # Blender has one focal length; a pixel that is not square takes the other.
    aspect = camera["fx"] / camera["fy"]
    scene.render.pixel_aspect_x = max(1.0, 1.0 / aspect)
    scene.render.pixel_aspect_y = max(1.0, aspect)
    scene.frame_start = 0
    scene.frame_end = max(0, world["frames"] - 1)


def set_up_camera(data, camera):
    """Exact field of view and principal point; one unit of shift is the sensor's fitted side."""
    width, height = camera["width"], camera["height"]
    data.sensor_fit = "HORIZONTAL"
    data.angle_x = 2.0 * math.atan(width / (2.0 * camera["fx"]))
    data.shift_x = ((width - 1) / 2.0 - camera["cx"]) / width
    data.shift_y = (camera["cy"] - (height - 1) / 2.0) / width * camera["fx"] / camera["fy"]


def show_footage(data, path, frames):
    clip = bpy.data.images.load(path)
    clip.source = "MOVIE"
    background = data.background_images.new()
    background.image = clip
    background.image_user.frame_start = 0
    background.image_user.frame_offset = 0
    background.image_user.frame_duration = frames
    data.show_background_images = True


def pixels_of(scene, camera, world_node, request):
    """Where the points are seen at each frame."""
    # Blender turns glTF's y up to its own z up.
    blender_from_gltf = Matrix.Rotation(math.pi / 2.0, 4, "X")
    x, y, z, w = world_node["rotation"]
    turn = blender_from_gltf @ Quaternion((w, x, y, z)).to_matrix().to_4x4()
    seen = []
    for frame in request["frames"]:
        scene.frame_set(frame)
        row = []
        for point in request["points"]:
            view = world_to_camera_view(scene, camera, turn @ Vector(point))
            row.append([view.x * scene.render.resolution_x - 0.5,
                        (1.0 - view.y) * scene.render.resolution_y - 0.5])
        seen.append(row)
    return seen


def main(arguments):
    path = arguments.pop(0)
    options = {"--footage": 1, "--save": 1, "--pixels": 2}
    given = {}
    while arguments:
        name = arguments.pop(0)
        if name not in options:
            sys.exit(f"unknown option {name}")
        given[name] = [arguments.pop(0) for _ in range(options[name])]
    document = read_json_chunk(path)
    world_node = document["nodes"][document["scenes"][document["scene"]]["nodes"][0]]
    intrinsics = document["cameras"][0]["extras"]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    set_up_scene(scene, world_node["extras"], intrinsics)
    bpy.ops.import_scene.gltf(filepath=path)
    camera = next(o for o in bpy.data.objects if o.type == "CAMERA")
    scene.camera = camera
    set_up_camera(camera.data, intrinsics)
    if "--footage" in given:
        show_footage(camera.data, given["--footage"][0], scene.frame_end + 1)
    if "--pixels" in given:
        with open(given["--pixels"][0], encoding="utf-8") as file:
            request = json.load(file)
        with open(given["--pixels"][1], "w", encoding="utf-8") as file:
            json.dump(pixels_of(scene, camera, world_node, request), file)
    if "--save" in given:
        bpy.ops.wm.save_as_mainfile(filepath=given["--save"][0])


main(sys.argv[sys.argv.index("--") + 1:])
