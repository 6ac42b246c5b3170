"""Bakes the recipes of an assembled model into its atlas with Cycles on the CPU."""

from pathlib import Path

import bpy
import numpy as np

from models import drawing

MARGIN_PX = 8


def set_up_cycles():
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.seed = 1
    scene.cycles.use_denoising = False
    scene.cycles.use_adaptive_sampling = False
    scene.render.bake.margin = MARGIN_PX
    scene.render.bake.margin_type = "EXTEND"


def bake(obj, recipes, size, folder, occlusion_m, samples=16):
    """Writes the model's textures as JPEG files into folder; returns their paths by channel.

    Channels: base (sRGB), orm (occlusion, roughness, metallic), normal (tangent space, +Y up) and,
    where a recipe glows, emissive. occlusion_m: reach of the ambient occlusion.
    """
    set_up_cycles()
    bpy.ops.object.select_all(action="DESELECT")
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    paths = {}

    def write(channel, array, colour, quality):
        paths[channel] = Path(folder) / f"{obj.name}_{channel}.jpg"
        drawing.save(paths[channel], array, colour, quality)

    for recipe in recipes:
        _emit(recipe, recipe.colour)
    write("base", _run(obj, recipes, size, "EMIT", samples), True, 86)
    for recipe in recipes:
        _emit(recipe, _orm(recipe, occlusion_m))
    write("orm", _run(obj, recipes, size, "EMIT", 3 * samples), False, 70)
    for recipe in recipes:
        _relief(recipe)
    write("normal", _run(obj, recipes, size, "NORMAL", samples), False, 92)
    if any(recipe.emission is not None for recipe in recipes):
        for recipe in recipes:
            _emit(recipe, recipe.emission or (0.0, 0.0, 0.0))
        write("emissive", _run(obj, recipes, size, "EMIT", samples), True, 90)
    return paths


def _run(obj, recipes, size, kind, samples):
    image = bpy.data.images.new("bake", size, size, float_buffer=True, is_data=True)
    for recipe in recipes:
        nodes = recipe.material.node_tree.nodes
        target = nodes.new("ShaderNodeTexImage")
        target.image = image
        nodes.active = target
    bpy.context.scene.cycles.samples = samples
    bpy.ops.object.bake(type=kind, use_clear=True)
    pixels = np.empty(size * size * 4, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(size, size, 4)[::-1, :, :3]


def _output(recipe, shader):
    tree = recipe.material.node_tree
    for node in [n for n in tree.nodes if n.type == "OUTPUT_MATERIAL"]:
        tree.nodes.remove(node)
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(shader, output.inputs["Surface"])


def _connect(tree, socket, value):
    if isinstance(value, bpy.types.NodeSocket):
        tree.links.new(value, socket)
    elif socket.type == "RGBA":
        socket.default_value = (*tuple(value)[:3], 1.0)
    else:
        socket.default_value = value


def _emit(recipe, value):
    tree = recipe.material.node_tree
    emission = tree.nodes.new("ShaderNodeEmission")
    _connect(tree, emission.inputs["Color"], value)
    _output(recipe, emission.outputs[0])


def _orm(recipe, occlusion_m):
    tree = recipe.material.node_tree
    occlusion = tree.nodes.new("ShaderNodeAmbientOcclusion")
    occlusion.samples = 8
    occlusion.inputs["Distance"].default_value = occlusion_m
    pack = tree.nodes.new("ShaderNodeCombineXYZ")
    _connect(tree, pack.inputs["X"], occlusion.outputs["AO"])
    _connect(tree, pack.inputs["Y"], recipe.roughness)
    _connect(tree, pack.inputs["Z"], recipe.metallic)
    return pack.outputs[0]


def _relief(recipe):
    tree = recipe.material.node_tree
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    if recipe.height is not None:
        bump = tree.nodes.new("ShaderNodeBump")
        bump.inputs["Distance"].default_value = 1.0
        _connect(tree, bump.inputs["Height"], recipe.height)
        tree.links.new(bump.outputs[0], diffuse.inputs["Normal"])
    _output(recipe, diffuse.outputs[0])
