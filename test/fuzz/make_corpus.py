#!/usr/bin/env python3
"""Writes the seeds of the fuzzers' corpora: one small, good file of each kind, so that mutation begins
where the readers look closest. What fuzzing has found lies beside them, named after what it did.

Usage: test/fuzz/make_corpus.py
"""

import base64
import json
import pathlib
import struct
import zlib

CORPUS = pathlib.Path(__file__).parent / "corpus"


def put(target, name, data):
    folder = CORPUS / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(data.encode() if isinstance(data, str) else data)


def png(width, height, bits, color, pixels):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, color, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(pixels)) + chunk(b"IEND", b""))


def bmp(width, height):
    row = (3 * width + 3) // 4 * 4
    return (b"BM" + struct.pack("<IHHI", 54 + row * height, 0, 0, 54)
            + struct.pack("<IiiHHIIiiII", 40, width, height, 1, 24, 0, row * height, 0, 0, 0, 0)
            + bytes(row * height))


def tiff(width, height):
    entries = [(256, 3, 1, width), (257, 3, 1, height), (258, 3, 1, 8), (259, 3, 1, 1), (262, 3, 1, 1),
               (273, 4, 1, 8), (277, 3, 1, 1), (278, 3, 1, height), (279, 4, 1, width * height)]
    pixels = bytes(width * height)
    table = struct.pack("<H", len(entries))
    for tag, kind, count, value in entries:
        table += struct.pack("<HHI", tag, kind, count) + (struct.pack("<HH", value, 0) if kind == 3
                                                          else struct.pack("<I", value))
    return b"II*\0" + struct.pack("<I", 8 + len(pixels)) + pixels + table + struct.pack("<I", 0)


def masks():
    put("mask", "grey8.png", png(4, 3, 8, 0, bytes([0, 0, 1, 2, 2] * 3)))
    put("mask", "grey16.png", png(4, 3, 16, 0, (b"\0" + struct.pack(">4H", 0, 500, 60000, 65535)) * 3))
    put("mask", "color.png", png(4, 3, 8, 2, (b"\0" + bytes(range(12))) * 3))
    put("mask", "picture.bmp", bmp(5, 3))
    put("mask", "picture.tif", tiff(5, 3))
    # 1x1, grey: the tables that every baseline JPEG has.
    put("mask", "dot.jpg", base64.b64decode(
        "/9j/4AAQSkZJRgABAQEASABIAAD/2wBDAP//////////////////////////////////////////////////////////////"
        "////////////////////////wAALCAABAAEBAREA/8QAFAABAAAAAAAAAAAAAAAAAAAACf/EABQQAQAAAAAAAAAAAAAAAAAA"
        "AAD/2gAIAQEAAD8AVN//2Q=="))


def triangle(**changes):
    data = struct.pack("<3H2x9f", 0, 1, 2, 0, 0, 0, 1, 0, 0, 0, 1, 0)
    model = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "children": [1]}, {"translation": [0, 1, 0], "rotation": [0, 0, 0, 1]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 1}, "indices": 0, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1], "baseColorTexture": {"index": 0}},
                       "alphaMode": "MASK", "doubleSided": True}],
        "textures": [{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33071, "minFilter": 9987}],
        "images": [{"uri": "data:image/png;base64," + base64.b64encode(png(1, 1, 8, 2, bytes(4))).decode()}],
        "buffers": [{"uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode(),
                     "byteLength": len(data)}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 6},
                        {"buffer": 0, "byteOffset": 8, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5123, "count": 3, "type": "SCALAR"},
                      {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3",
                       "min": [0, 0, 0], "max": [1, 1, 0]}],
    }
    model.update(changes)
    return model


def glb(model, binary=b""):
    text = json.dumps(model).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    if binary:
        chunks += struct.pack("<II", len(binary), 0x004E4942) + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def models():
    put("gltf", "triangle.gltf", json.dumps(triangle()))
    put("gltf", "triangle.glb", glb(triangle()))
    skinned = triangle(
        skins=[{"joints": [1], "skeleton": 1}], cameras=[{"type": "perspective", "perspective": {
            "yfov": 0.8, "znear": 0.1}}],
        animations=[{"name": "move", "samplers": [{"input": 2, "output": 1, "interpolation": "STEP"}],
                     "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}]}],
        extensionsUsed=["KHR_lights_punctual", "EXT_mesh_gpu_instancing"],
        extensions={"KHR_lights_punctual": {"lights": [{"type": "spot", "color": [1, 1, 1], "spot": {}}]}})
    skinned["accessors"].append({"componentType": 5126, "count": 3, "type": "SCALAR", "sparse": {
        "count": 2, "indices": {"bufferView": 0, "componentType": 5123},
        "values": {"bufferView": 1}}})
    skinned["nodes"][0]["skin"] = 0
    skinned["nodes"][1].update({"camera": 0, "extensions": {
        "KHR_lights_punctual": {"light": 0},
        "EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 1}}}})
    put("gltf", "skinned.glb", glb(skinned))
    put("gltf", "node_cycle.gltf", json.dumps(triangle(nodes=[{"children": [1]}, {"children": [0], "mesh": 0}])))
    packed = triangle(extensionsUsed=["EXT_meshopt_compression"])
    packed["bufferViews"][1]["extensions"] = {"EXT_meshopt_compression": {
        "buffer": 0, "byteOffset": 0, "byteLength": 44, "byteStride": 12, "count": 3, "mode": "ATTRIBUTES"}}
    put("gltf", "meshopt.gltf", json.dumps(packed))
    draco = triangle(extensionsUsed=["KHR_draco_mesh_compression"])
    draco["meshes"][0]["primitives"][0]["extensions"] = {"KHR_draco_mesh_compression": {
        "bufferView": 1, "attributes": {"POSITION": 0}}}
    put("gltf", "draco.gltf", json.dumps(draco))


def settings():
    put("scene", "scene.yaml", """light: {sun: {direction: [0, 1, 0], color: [1, 1, 1]}, sky: 0.5}
shadows: true
occlusion: both
objects:
  - model: m.glb
    place: {frame: 3, pixel: [10, 20]}
    size: 0.3
    yaw: 30
    face: keep
    animation: Walk
  - {model: m.glb, place: {plane: floor, at: [0.5, 0.5]}, animation: 1}
  - {model: m.glb, place: {position: [0, 0, 1], normal: [0, -1, 0]}}
scale: {edge: {frame: 0, from: [0, 0], to: [9, 9], length: 0.1}}
""")
    put("scene", "distance.yaml", "light: estimate\nobjects: [{model: m.glb, place: {plane: 0}}]\n"
                                  "scale: {plane_distance: 1.2, frame: 4}\n")
    put("scene", "golden.yaml", "cases:\n  - name: a\n    synth: {scene: tabletop, frames: 4, width: 64, height: 48}\n"
                                "    frames: [1, 2]\n    mode: rgbd\n    tolerance: {channel: 5, share: 0.001}\n")
    put("scene", "benchmark.yaml", "title: t\nmodes: [rgbd]\nseeds: [1, 2]\ncurves: [{x: frames, y: seconds}]\n"
                                   "variants: [{name: default}, {name: b, options: [--causal]}]\n"
                                   "sequences: [{name: a, synth: tabletop}, {name: b, path: x}]\n")
    put("scene", "deep.yaml", "[" * 2000)
    put("camera", "own.yaml", "model: fisheye\nwidth: 640\nheight: 480\nfx: 525.0\nfy: 525.0\ncx: 320.0\n"
                              "cy: 240.0\ndistortion: [0.1, 0.2, 0, 0]\nfps: 30\ndepth_factor: 5000\n")
    put("camera", "opencv.yaml", "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n"
                                 "  rows: 3\n  cols: 3\n  dt: d\n  data: [500, 0, 320, 0, 500, 240, 0, 0, 1]\n"
                                 "distortion_coefficients: {data: [0.1, 0, 0, 0, 0]}\n")
    put("camera", "euroc.yaml", "T_BS: {rows: 4, data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}\n"
                                "resolution: [752, 480]\nintrinsics: [458.6, 457.2, 367.2, 248.3]\n"
                                "distortion_model: radial-tangential\ndistortion_coefficients: [-0.2, 0.07, 0, 0]\n")
    for number, words in enumerate((
            "run\nseq\n--scene\ns.yaml\n-o\nout\n--frames\n0:20\n--size\n320x240\n--mode\nrgbd\n--seed\n7",
            "evaluate\ntrajectory\n--estimate\na\n--groundtruth\nb\n--align\nsim3\n--json\n-",
            "synth\ntabletop\n-o\nx\n--width\n64\n--lens\nwide", "model\na.glb\n--views\n8\n--time\n0.5",
            "golden\ncheck\nd\n--only\na\nb", "calibrate\nv\n--squares\n10x7\n--marker\n0.5", "track\n--help",
            "completion\nbash", "--version", "segment\nx\n-o\ny\n--threads\n2")):
        put("command_line", f"words_{number}", words)


def lists():
    put("lists", "rgb", b"\0# color\n0.033333 rgb/0.png\n0.066667 rgb/1.png\n")
    put("lists", "associations", b"\x011.0 depth/1.png 1.0 rgb/1.png\n2.0 depth/2.png 2.0 rgb/2.png\n")
    put("lists", "euroc", b"\x02#timestamp [ns],filename\n1403636579763555584,1403636579763555584.png\n")
    put("lists", "depth", b"\x030.001 depth/0.png\n0.101 depth/1.png\n")
    put("lists", "mask", b"\x040.0 mask/0.png\n")
    put("poses", "tum", "# timestamp tx ty tz qx qy qz qw\n0.0 0 0 0 0 0 0 1\n0.1 1e-3 -2 3.5 0.5 0.5 0.5 0.5\n")
    put("poses", "euroc", "#timestamp,p\n1403636579763555584,4.6,-1.7,0.8,0.5,0.1,-0.8,0.1,0,0,0\n")


def results():
    put("planes", "plane.json", json.dumps({
        "units": "metres", "up": [0, -1, 0], "up_confidence": 0.9, "planes": [{
            "id": 0, "normal": [0, 0, -1], "offset": 2.0, "class": "wall", "inliers": 9, "rms": 0.01,
            "area": 1.0, "polygon": [[0, 0, 2], [1, 0, 2], [1, 1, 2]], "holes": [[[0.1, 0.1, 2]]],
            "label": 1, "first_frame": 0, "merged_from": [3], "origin": [0, 0, 2], "x_axis": [1, 0, 0]}]}))
    put("tables", "frames", b'\0index,timestamp,state,reason,inliers\n0,0.0,tracked,,90\n1,0.1,lost,"a, ""b""",0\n')
    put("tables", "times", b"\x01index,Tracking ms,\"a,b ms\"\n0,1.5,\n1,,2.25\n")
    put("tables", "timings", b'\x02{"unit": "ms", "rows": [{"name": "a", "count": 1, "mean": 1, "median": 1, "p95": 1}]}')
    put("tables", "summary", b'\x03{"point_plane_rms": {"before": 0.1, "after": 0.05}}')
    put("tables", "points", b"\x04ply\nformat binary_little_endian 1.0\ncomment planecast map points\n"
        b"element vertex 1\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\n"
        b"property uchar green\nproperty uchar blue\nproperty int plane\nproperty float image_red\n"
        b"property float image_green\nproperty float image_blue\nend_header\n"
        + struct.pack("<3d3Bi3f", 1, 2, 3, 9, 9, 9, 0, 1, 2, 3))


def map_body():
    """A map of two keyframes, one landmark and one plane, as map.bin holds it behind its header."""
    def text(value):
        return struct.pack("<Q", len(value)) + value
    def ints(values):
        return struct.pack(f"<Q{len(values)}i", len(values), *values)
    identity = struct.pack("<12d", 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0)
    def features():
        keypoint = struct.pack("<6fifi", 10, 10, 10, 10, 0, 1, 0, 2, 1)
        return struct.pack("<Q", 1) + keypoint + bytes(32)
    def keyframe(number, parent):
        return (struct.pack("<iid", number, number, number / 30) + identity + struct.pack("<id", parent, 1.0)
                + features() + ints([0]) + ints([1]))
    landmark = (struct.pack("<i6d", 0, 0, 0, 2, 0, 0, -1) + bytes(32) + struct.pack("<2d", 1, 3)
                + struct.pack("<Q4i", 2, 0, 0, 1, 0) + struct.pack("<4i3f", 0, 2, 2, 0, 1, 2, 3))
    plane = (struct.pack("<i3dd3d3dBd", 0, 0, 0, -1, 2, 0, 0, 2, 1, 0, 0, 0, 0.01)
             + struct.pack("<6i", 1, 0, 1, 0, 0, 0) + ints([0, 1]) + ints([]) + struct.pack("<Q", 0))
    def store(next_id, values):
        return struct.pack("<iQ", next_id, len(values)) + b"".join(values)
    slam = (store(2, [keyframe(0, -1), keyframe(1, 0)]) + store(1, [landmark]) + store(1, [plane])
            + struct.pack("<QQQ", 0, 0, 0))
    camera = struct.pack("<iii9dB", 0, 64, 48, 60, 60, 32, 24, 0, 0, 0, 0, 0, 0)
    about = struct.pack("<Bd", 1, 2.0) + text(b"rgbd") + text(b"none") + struct.pack("<Q", 1) + text(b"warning")
    picture = png(64, 48, 8, 0, bytes(65) * 48)
    pictures = struct.pack("<i", 0) + text(picture)
    return b"".join(tag + text(body) for tag, body in (
        (b"CAMR", camera), (b"ABOU", about), (b"SLAM", slam), (b"PICT", pictures), (b"LATR", b"x")))


if __name__ == "__main__":
    models()
    masks()
    settings()
    lists()
    results()
    put("map", "two_keyframes", map_body())
