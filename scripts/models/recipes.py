"""Procedural materials as Blender node graphs, baked to textures later.

A Recipe offers sockets for the channels that are baked: colour and emission (linear RGB),
roughness and metallic (0..1), height (metres; becomes the normal map). Lengths are metres in the
assembled model's space, so a recipe looks the same on every part.
"""

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np


@dataclass
class Recipe:
    material: Any
    colour: Any
    roughness: Any
    metallic: Any
    height: Any
    emission: Any


class Graph:
    """A thin pen for node graphs: values may be sockets, numbers or RGB triples."""

    def __init__(self, name):
        self.material = bpy.data.materials.new(name)
        self.material.use_nodes = True
        self.tree = self.material.node_tree
        self.tree.nodes.clear()
        self.position = self.node("ShaderNodeTexCoord").outputs["Object"]

    def node(self, kind, inputs=None, **attributes):
        node = self.tree.nodes.new(kind)
        for name, value in attributes.items():
            setattr(node, name, value)
        for name, value in (inputs or {}).items():
            self.feed(node.inputs[name], value)
        return node

    def feed(self, socket, value):
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        elif socket.type == "RGBA":
            rgb = (value,) * 3 if isinstance(value, (int, float)) else tuple(value)
            socket.default_value = (*rgb[:3], 1.0)
        else:
            socket.default_value = value

    def math(self, operation, a, b=0.0, clamp=False):
        inputs = {0: a, 1: b}
        return self.node("ShaderNodeMath", inputs, operation=operation, use_clamp=clamp).outputs[0]

    def mix(self, factor, a, b, blend="MIX"):
        inputs = {"Fac": factor, "Color1": a, "Color2": b}
        return self.node("ShaderNodeMixRGB", inputs, blend_type=blend).outputs["Color"]

    def lerp(self, factor, a, b):
        inputs = {"Value": factor, "To Min": a, "To Max": b}
        return self.node("ShaderNodeMapRange", inputs).outputs["Result"]

    def ramp(self, value, low, high):
        """0 at low, 1 at high, smooth between; low may exceed high."""
        inputs = {"Value": value, "From Min": low, "From Max": high}
        node = self.node("ShaderNodeMapRange", inputs, interpolation_type="SMOOTHSTEP")
        return node.outputs["Result"]

    def noise(self, feature_m, detail=3.0, stretch=(1.0, 1.0, 1.0), roughness=0.5):
        """Fractal noise about 0.5; feature_m is the size of its largest lumps."""
        where = self.node("ShaderNodeMapping", {"Vector": self.position, "Scale": stretch})
        inputs = {
            "Vector": where.outputs[0],
            "Scale": 1.0 / feature_m,
            "Detail": detail,
            "Roughness": roughness,
        }
        return self.node("ShaderNodeTexNoise", inputs).outputs["Fac"]

    def edge(self, reach_m):
        """0 on flat ground, rising where the solid is thin within reach: near convex edges."""
        inputs = {"Distance": reach_m}
        node = self.node("ShaderNodeAmbientOcclusion", inputs, inside=True, samples=8)
        return self.math("SUBTRACT", 1.0, node.outputs["AO"])

    def crevice(self, reach_m):
        """0 in the open, 1 deep between surfaces."""
        node = self.node("ShaderNodeAmbientOcclusion", {"Distance": reach_m}, samples=8)
        return self.math("SUBTRACT", 1.0, node.outputs["AO"])

    def separate(self, vector):
        return self.node("ShaderNodeSeparateXYZ", {"Vector": vector}).outputs

    def picture(self, array, name, colour):
        """A numpy picture (row 0 on top) laid over the decal coordinates."""
        height, width = array.shape[:2]
        image = bpy.data.images.new(name, width, height, float_buffer=True, is_data=True)
        pixels = np.ones((height, width, 4), np.float32)
        pixels[..., :3] = array if array.ndim == 3 else array[..., None]
        image.pixels.foreach_set(pixels[::-1].ravel())
        image.pack()
        uv = self.node("ShaderNodeUVMap", uv_map="decal").outputs["UV"]
        settings = {
            "image": image,
            "extension": "EXTEND",
            "interpolation": "Cubic",
        }  # smooth slopes
        node = self.node("ShaderNodeTexImage", {"Vector": uv}, **settings)
        return node.outputs["Color"] if colour else self.separate(node.outputs["Color"])[0]

    def recipe(self, colour, roughness=0.5, metallic=0.0, height=None, emission=None):
        return Recipe(self.material, colour, roughness, metallic, height, emission)


def painted_metal(name, colour, wear=0.5, reach_m=0.012, second=None, split_z=0.0):
    """Enamel over steel, chipped at edges, dusty in crevices. second: colour below split_z."""
    g = Graph(name)
    base = g.mix(
        g.ramp(g.noise(0.03), 0.3, 0.7), [0.9 * c for c in colour], [1.06 * c for c in colour]
    )
    if second is not None:
        below = g.ramp(g.separate(g.position)["Z"], split_z + 0.0002, split_z - 0.0002)
        base = g.mix(below, base, second)
    fray = g.math("MULTIPLY", g.math("SUBTRACT", g.noise(0.006, 6.0, roughness=0.65), 0.5), 1.1)
    patch = g.math("MULTIPLY", g.math("SUBTRACT", g.noise(0.035, 1.0), 0.5), 0.8)
    edge = g.math("ADD", g.math("ADD", g.edge(reach_m), fray), patch)
    start = 0.7 - 0.5 * wear
    chip = g.ramp(edge, start, start + 0.04)
    rim = g.ramp(edge, start - 0.05, start)
    steel = g.mix(g.noise(0.004, 4.0), (0.42, 0.40, 0.38), (0.66, 0.64, 0.61))
    painted = g.mix(g.math("MULTIPLY", rim, 0.35), base, [0.5 * c + 0.3 for c in colour])
    dust = g.math("MULTIPLY", g.ramp(g.crevice(0.008), 0.25, 0.95), 0.55)
    body = g.mix(dust, g.mix(chip, painted, steel), (0.045, 0.035, 0.028))
    roughness = g.math("ADD", g.lerp(g.noise(0.02, 5.0), 0.24, 0.42), g.math("MULTIPLY", dust, 0.5))
    roughness = g.lerp(chip, roughness, 0.42)
    peel = g.math("MULTIPLY", g.noise(0.0025, 1.0), 0.00003)
    height = g.math("SUBTRACT", peel, g.math("MULTIPLY", chip, 0.00018))
    return g.recipe(body, roughness, g.math("MULTIPLY", chip, 0.8), height)


def rubber(name, colour=(0.022, 0.023, 0.026), scuffed=0.6):
    g = Graph(name)
    light = [2.6 * c + 0.01 for c in colour]
    scuff = g.ramp(g.math("ADD", g.edge(0.003), g.noise(0.01, 5.0)), 0.75, 1.15)
    base = g.mix(g.math("MULTIPLY", scuff, scuffed), colour, light)
    height = g.math("MULTIPLY", g.noise(0.0018, 2.0), 0.00008)
    return g.recipe(base, g.lerp(scuff, 0.62, 0.78), 0.0, height)


def bare_metal(name, colour, tarnish, roughness=0.34):
    """Brushed metal, tarnished where it is not rubbed clean."""
    g = Graph(name)
    old = g.math("ADD", g.ramp(g.noise(0.012, 5.0), 0.42, 0.75), g.ramp(g.crevice(0.006), 0.2, 0.9))
    base = g.mix(g.math("MULTIPLY", old, 0.7, clamp=True), colour, tarnish)
    height = g.math("MULTIPLY", g.noise(0.003, 3.0), 0.00004)
    return g.recipe(base, g.lerp(old, roughness, roughness + 0.22), 0.85, height)


def dark_glass(name, low_z, high_z):
    """Smoked glass; a faint sheen painted in, as light probes of low order show no reflections."""
    g = Graph(name)
    xyz = g.separate(g.position)
    slant = g.math("ADD", xyz["Z"], g.math("MULTIPLY", xyz["X"], 0.45))
    sheen = g.math("MULTIPLY", g.ramp(slant, low_z, high_z), 0.9)
    base = g.mix(sheen, (0.0035, 0.006, 0.010), (0.016, 0.028, 0.040))
    return g.recipe(base, 0.07, 0.0, None)


def glowing(name, colour, base=None):
    """A lamp behind frosted glass: bright all over, a little less at the rim."""
    g = Graph(name)
    rim = g.ramp(g.edge(0.006), 0.45, 1.0)
    light = g.mix(rim, colour, [0.55 * c for c in colour])
    return g.recipe(base or [0.35 * c for c in colour], 0.2, 0.0, None, light)
