"""The test models, one function each: what it is for stands in its first line."""

import math

from .gltf_writer import Gltf
from .plain_shapes import ball, box, grid, square


def checker(x, y):
    return (230, 120, 40, 255) if (x // 4 + y // 4) % 2 else (40, 80, 150, 255)


def row_of(gltf, meshes, distance=1.2):
    for i, mesh in enumerate(meshes):
        gltf.node(mesh=mesh, translation=[distance * (i - (len(meshes) - 1) / 2), 0.5, 0])


def metal_rough(gltf):
    """Metal and dielectric from smooth to rough."""
    meshes = []
    for metallic in (0.0, 1.0):
        for roughness in (0.1, 0.4, 0.9):
            material = gltf.material(
                pbrMetallicRoughness={
                    "baseColorFactor": [0.9, 0.5, 0.2, 1],
                    "metallicFactor": metallic,
                    "roughnessFactor": roughness,
                }
            )
            meshes.append(gltf.mesh(gltf.primitive(ball(), material)))
    row_of(gltf, meshes)


def maps(gltf):
    """Base colour, normal, occlusion and emissive textures on a ball and a box."""

    def dents(x, y):
        nx, ny = 0.5 * math.sin(x * math.pi / 4), 0.5 * math.sin(y * math.pi / 4)
        nz = math.sqrt(1 - nx * nx - ny * ny)
        return tuple(round(127.5 * (c + 1)) for c in (nx, ny, nz)) + (255,)

    base = gltf.texture(32, 32, checker)
    normal = gltf.texture(32, 32, dents)
    dark = gltf.texture(32, 32, lambda x, y: (60 if y > 16 else 255, 200, 0, 255))
    glow = gltf.texture(32, 32, lambda x, y: (0, 255, 0, 255) if x % 16 == 0 else (0, 0, 0, 255))
    material = gltf.material(
        pbrMetallicRoughness={
            "baseColorTexture": {"index": base},
            "metallicRoughnessTexture": {"index": dark},
        },
        normalTexture={"index": normal, "scale": 0.8},
        occlusionTexture={"index": dark, "strength": 0.7},
        emissiveTexture={"index": glow},
        emissiveFactor=[1, 1, 1],
    )
    row_of(gltf, [gltf.mesh(gltf.primitive(shape, material)) for shape in (ball(), box(0.45))])


def alpha_modes(gltf):
    """Opaque, masked and blended squares before a box."""

    def ramp(x, y):
        return (220, 60, 60, 8 * x)

    texture = gltf.texture(32, 32, ramp)
    meshes = []
    for mode in ("OPAQUE", "MASK", "BLEND"):
        material = gltf.material(
            pbrMetallicRoughness={"baseColorTexture": {"index": texture}, "metallicFactor": 0},
            alphaMode=mode,
            doubleSided=True,
        )
        meshes.append(gltf.mesh(gltf.primitive(square(), material)))
    row_of(gltf, meshes)
    bar = gltf.mesh(gltf.primitive(box(0.5), gltf.material()))
    gltf.node(mesh=bar, translation=[0, 0.5, -0.8], scale=[3.4, 0.3, 0.3])


def vertex_colors(gltf):
    """Colours at the corners, multiplied with a factor."""
    shape = box(0.5)
    shape["COLOR_0"] = [(p[0] + 0.5, p[1] + 0.5, p[2] + 0.5, 1.0) for p in shape["POSITION"]]
    material = gltf.material(
        pbrMetallicRoughness={"baseColorFactor": [1, 0.8, 0.8, 1], "metallicFactor": 0}
    )
    gltf.node(mesh=gltf.mesh(gltf.primitive(shape, material)), translation=[0, 0.5, 0])


def primitive_modes(gltf):
    """Points, lines, loops, strips and fans of the same eight corners."""
    circle = [
        (0.45 * math.cos(math.pi * k / 4), 0.45 * math.sin(math.pi * k / 4), 0.0)
        for k in range(8)
    ]
    zigzag = [circle[k] for k in (0, 1, 7, 2, 6, 3, 5, 4)]
    material = gltf.material(
        pbrMetallicRoughness={"baseColorFactor": [0.9, 0.2, 0.1, 1], "metallicFactor": 0},
        doubleSided=True,
    )
    for mode in range(7):
        corners = zigzag if mode == 5 else circle
        if mode == 4:
            corners = [circle[k] for k in (0, 1, 2, 2, 3, 4, 4, 5, 6)]
        mesh = gltf.mesh(gltf.primitive({"POSITION": corners}, material, mode, indexed=False))
        gltf.node(mesh=mesh, translation=[mode % 4 - 1.5, 1.5 - mode // 4, 0])


def texture_sets(gltf):
    """The second coordinate set, KHR_texture_transform, wrap modes and filters."""
    gltf.use("KHR_texture_transform")
    turned = {"offset": [0.2, 0.1], "rotation": 0.5, "scale": [2, 3]}
    infos = (
        ({"texCoord": 1}, {"wrapS": 10497, "wrapT": 10497}),
        ({"extensions": {"KHR_texture_transform": turned}}, {"wrapS": 33648, "wrapT": 33648}),
        ({"extensions": {"KHR_texture_transform": turned}}, {"wrapS": 33071, "wrapT": 33071}),
        ({}, {"magFilter": 9728, "minFilter": 9728}),
    )
    meshes = []
    for info, sampler in infos:
        texture = gltf.texture(16, 16, lambda x, y: (16 * x, 16 * y, 90, 255), **sampler)
        shape = square()
        shape["TEXCOORD_1"] = [(2 * v, 2 * u) for u, v in shape["TEXCOORD_0"]]
        material = gltf.material(
            pbrMetallicRoughness={"baseColorTexture": {"index": texture, **info}, "metallicFactor": 0}
        )
        meshes.append(gltf.mesh(gltf.primitive(shape, material)))
    row_of(gltf, meshes, 1.1)


def unlit_and_glow(gltf):
    """KHR_materials_unlit and KHR_materials_emissive_strength."""
    gltf.use("KHR_materials_unlit")
    gltf.use("KHR_materials_emissive_strength")
    plain = gltf.material(
        pbrMetallicRoughness={"baseColorFactor": [0.2, 0.6, 0.9, 1]},
        extensions={"KHR_materials_unlit": {}},
    )
    glowing = gltf.material(
        pbrMetallicRoughness={"baseColorFactor": [0, 0, 0, 1]},
        emissiveFactor=[0.1, 0.05, 0.01],
        extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 8}},
    )
    row_of(gltf, [gltf.mesh(gltf.primitive(ball(), m)) for m in (plain, glowing)])


def layers(gltf):
    """Clear coat, sheen, tinted specular, high index of refraction, transmission."""
    extensions = {
        "KHR_materials_clearcoat": {"clearcoatFactor": 1.0, "clearcoatRoughnessFactor": 0.1},
        "KHR_materials_sheen": {"sheenColorFactor": [0.9, 0.8, 1.0], "sheenRoughnessFactor": 0.4},
        "KHR_materials_specular": {"specularFactor": 1.0, "specularColorFactor": [1.0, 0.3, 0.1]},
        "KHR_materials_ior": {"ior": 2.4},
        "KHR_materials_transmission": {"transmissionFactor": 0.9},
    }
    meshes = []
    for name, values in extensions.items():
        gltf.use(name)
        material = gltf.material(
            pbrMetallicRoughness={
                "baseColorFactor": [0.5, 0.05, 0.1, 1] if "transm" not in name else [0.8, 1, 0.9, 1],
                "metallicFactor": 0,
                "roughnessFactor": 0.6 if "transm" not in name else 0.1,
            },
            extensions={name: values},
        )
        meshes.append(gltf.mesh(gltf.primitive(ball(), material)))
    row_of(gltf, meshes, 1.1)


def lamps(gltf):
    """KHR_lights_punctual: a red point light and a green spot on a grey floor."""
    gltf.use("KHR_lights_punctual")
    gltf.json["extensions"] = {
        "KHR_lights_punctual": {
            "lights": [
                {"type": "point", "color": [1, 0.1, 0.1], "intensity": 3},
                {
                    "type": "spot",
                    "color": [0.1, 1, 0.2],
                    "intensity": 20,
                    "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.35},
                },
            ]
        }
    }
    grey = gltf.material(
        pbrMetallicRoughness={
            "baseColorFactor": [0.2, 0.2, 0.2, 1],
            "metallicFactor": 0,
            "roughnessFactor": 0.8,
        }
    )
    floor = gltf.mesh(gltf.primitive(grid(4, 4, 8, 8), grey))
    down = [-math.sqrt(0.5), 0, 0, math.sqrt(0.5)]
    gltf.node(mesh=floor, rotation=down, translation=[0, 0, 2])
    row_of(gltf, [gltf.mesh(gltf.primitive(ball(), grey))])
    light = lambda k: {"KHR_lights_punctual": {"light": k}}
    gltf.node(translation=[-1, 0.8, 0.5], extensions=light(0))
    gltf.node(translation=[1, 2, 0.5], rotation=down, extensions=light(1))


def instances(gltf):
    """EXT_mesh_gpu_instancing, and a mirrored node of the same mesh."""
    gltf.use("EXT_mesh_gpu_instancing")
    texture = gltf.texture(16, 16, checker)
    material = gltf.material(
        pbrMetallicRoughness={"baseColorTexture": {"index": texture}, "metallicFactor": 0}
    )
    mesh = gltf.mesh(gltf.primitive(box(0.3), material))
    places = [(math.sin(k), 0.4 + 0.1 * k, math.cos(k)) for k in range(6)]
    turns = [(0, math.sin(0.3 * k), 0, math.cos(0.3 * k)) for k in range(6)]
    attributes = {
        "TRANSLATION": gltf.accessor(places, "VEC3"),
        "ROTATION": gltf.accessor(turns, "VEC4"),
    }
    gltf.node(mesh=mesh, extensions={"EXT_mesh_gpu_instancing": {"attributes": attributes}})
    gltf.node(mesh=mesh, translation=[0, 0.4, 0], scale=[-1, 1.5, 1])


def variants(gltf):
    """KHR_materials_variants: without a choice the primitive's own material."""
    gltf.use("KHR_materials_variants")
    gltf.json["extensions"] = {
        "KHR_materials_variants": {"variants": [{"name": "red"}, {"name": "blue"}]}
    }
    colors = [[0.7, 0.7, 0.7, 1], [0.8, 0.1, 0.1, 1], [0.1, 0.2, 0.8, 1]]
    materials = [
        gltf.material(pbrMetallicRoughness={"baseColorFactor": c, "metallicFactor": 0})
        for c in colors
    ]
    primitive = gltf.primitive(ball(), materials[0])
    primitive["extensions"] = {
        "KHR_materials_variants": {
            "mappings": [
                {"material": materials[1], "variants": [0]},
                {"material": materials[2], "variants": [1]},
            ]
        }
    }
    gltf.node(mesh=gltf.mesh(primitive), translation=[0, 0.5, 0])


def morph(gltf):
    """Two morph targets, weights animated linearly."""
    primitive = gltf.primitive(box(0.4), gltf.material(pbrMetallicRoughness={"metallicFactor": 0}))
    positions = box(0.4)["POSITION"]
    wide = [(0.6 * p[0] if p[1] > 0 else 0.0, 0.0, 0.0) for p in positions]
    tall = [(0.0, 0.8 if p[1] > 0 else 0.0, 0.0) for p in positions]
    primitive["targets"] = [{"POSITION": gltf.accessor(t, "VEC3")} for t in (wide, tall)]
    node = gltf.node(mesh=gltf.mesh(primitive, weights=[0.5, 0.0]), translation=[0, 0.4, 0])
    weights = [0, 0, 1, 0, 1, 1]
    gltf.animation("grow", [(node, "weights", "LINEAR", [0, 1, 2], weights, "SCALAR")])


def skin(gltf):
    """A strip bent by two joints; one turns by spherical interpolation."""
    shape = grid(0.6, 2.0, 4, 16)
    material = gltf.material(
        pbrMetallicRoughness={"baseColorFactor": [0.3, 0.7, 0.3, 1], "metallicFactor": 0},
        doubleSided=True,
    )
    primitive = gltf.primitive(shape, material)
    lift = [min(max(p[1] - 0.5, 0.0), 1.0) for p in shape["POSITION"]]
    joints = [0, 1, 0, 0] * len(lift)
    primitive["attributes"]["JOINTS_0"] = gltf.accessor(joints, "VEC4", 5121)
    primitive["attributes"]["WEIGHTS_0"] = gltf.accessor([(1 - w, w, 0, 0) for w in lift], "VEC4")
    upper = gltf.node(root=False, translation=[0, 1, 0])
    lower = gltf.node(children=[upper])
    inverse = [[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -y, 0, 1] for y in (0, 1)]
    bind = gltf.accessor(inverse, "MAT4")
    gltf.add("skins", {"joints": [lower, upper], "inverseBindMatrices": bind})
    gltf.node(mesh=gltf.mesh(primitive), skin=0)
    turns = [(0, 0, 0, 1), (0, 0, math.sin(0.6), math.cos(0.6)), (0, 0, 0, 1)]
    gltf.animation("bend", [(upper, "rotation", "LINEAR", [0, 1, 2], turns, "VEC4")])


def paths(gltf):
    """Step, linear and cubic-spline translation side by side."""
    material = gltf.material(
        pbrMetallicRoughness={"baseColorFactor": [0.9, 0.7, 0.1, 1], "metallicFactor": 0}
    )
    mesh = gltf.mesh(gltf.primitive(ball(0.3), material))
    channels = []
    for i, interpolation in enumerate(("STEP", "LINEAR", "CUBICSPLINE")):
        x = 0.8 * (i - 1)
        node = gltf.node(mesh=mesh, translation=[x, 0.3, 0])
        keys = [(x, 0.3, 0), (x, 1.5, 0), (x, 0.6, 0.5)]
        if interpolation == "CUBICSPLINE":
            keys = [k for key in keys for k in ((0, 2, 0), key, (0, 2, 0))]
        channels.append((node, "translation", interpolation, [0, 1, 2], keys, "VEC3"))
    gltf.animation("move", channels)
    low = gltf.mesh(gltf.primitive(box(0.5), material))
    gltf.node(mesh=low, scale=[2.6, 0.05, 0.6])


def sparse(gltf):
    """Sparse positions over a buffer, and sparse over nothing."""
    base = gltf.accessor(grid(2, 1, 8, 4)["POSITION"], "VEC3")
    places = gltf.view(bytes((20, 0, 24, 0)))
    values = gltf.accessor([(-0.5, 1.3, 0.3), (0.6, 1.4, 0.3)], "VEC3")
    view = gltf.json["accessors"][values]["bufferView"]
    gltf.json["accessors"][base]["sparse"] = {
        "count": 2,
        "indices": {"bufferView": places, "componentType": 5123},
        "values": {"bufferView": view},
    }
    material = gltf.material(
        pbrMetallicRoughness={"baseColorFactor": [0.5, 0.3, 0.7, 1], "metallicFactor": 0},
        doubleSided=True,
    )
    indices = gltf.accessor(grid(2, 1, 8, 4)["indices"], "SCALAR", 5123)
    gltf.node(
        mesh=gltf.mesh({"attributes": {"POSITION": base}, "indices": indices, "material": material})
    )


MODELS = {
    function.__name__: function
    for function in (
        metal_rough, maps, alpha_modes, vertex_colors, primitive_modes, texture_sets,
        unlit_and_glow, layers, lamps, instances, variants, morph, skin, paths, sparse,
    )
}


def build(name):
    gltf = Gltf(name)
    MODELS[name](gltf)
    return gltf
