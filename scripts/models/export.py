"""The final glTF material round the baked textures, and the .glb file."""

import bpy

OCCLUSION_GROUP = "glTF Material Output"  # the exporter looks for a group of this name


def start_scene():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.world = bpy.data.worlds.new("world")
    bpy.context.scene.render.fps = 24


def baked_material(name, textures, double_sided=False):
    """A metallic-roughness material from the paths that bake() returned."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.use_backface_culling = not double_sided
    nodes, links = material.node_tree.nodes, material.node_tree.links
    surface = nodes["Principled BSDF"]

    def texture(channel, colour):
        node = nodes.new("ShaderNodeTexImage")
        node.image = bpy.data.images.load(str(textures[channel]))
        node.image.name = f"{name}_{channel}"
        node.image.colorspace_settings.name = "sRGB" if colour else "Non-Color"
        return node.outputs["Color"]

    links.new(texture("base", True), surface.inputs["Base Color"])
    channels = nodes.new("ShaderNodeSeparateColor")
    links.new(texture("orm", False), channels.inputs[0])
    links.new(channels.outputs["Green"], surface.inputs["Roughness"])
    links.new(channels.outputs["Blue"], surface.inputs["Metallic"])
    output = nodes.new("ShaderNodeGroup")
    output.node_tree = _occlusion_group()
    links.new(channels.outputs["Red"], output.inputs["Occlusion"])
    relief = nodes.new("ShaderNodeNormalMap")
    links.new(texture("normal", False), relief.inputs["Color"])
    links.new(relief.outputs[0], surface.inputs["Normal"])
    if "emissive" in textures:
        links.new(texture("emissive", True), surface.inputs["Emission"])
    return material


def _occlusion_group():
    group = bpy.data.node_groups.get(OCCLUSION_GROUP)
    if group is None:
        group = bpy.data.node_groups.new(OCCLUSION_GROUP, "ShaderNodeTree")
        group.inputs.new("NodeSocketFloat", "Occlusion")
        group.nodes.new("NodeGroupInput")
    return group


def dress(obj, material):
    """Leaves the object with one material and the atlas as its only texture coordinates."""
    mesh = obj.data
    mesh.materials.clear()
    mesh.materials.append(material)
    mesh.polygons.foreach_set("material_index", [0] * len(mesh.polygons))
    for name in ("decal",):
        if name in mesh.uv_layers:
            mesh.uv_layers.remove(mesh.uv_layers[name])


def write_glb(path, animated=False):
    bpy.ops.export_scene.gltf(
        filepath=str(path),
        export_format="GLB",
        export_copyright="Planecast authors, CC0-1.0",
        export_image_format="AUTO",
        export_tangents=True,
        export_apply=False,
        export_colors=False,
        export_animations=animated,
        export_nla_strips=True,
        export_force_sampling=True,
        export_optimize_animation_size=True,
        export_yup=True,
    )
