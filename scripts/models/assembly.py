"""Collects shapes into one mesh with an atlas, and takes it apart again after baking.

Baking one mesh lets every part throw occlusion on every other and share one set of textures;
the parts that move are separated afterwards, each with its origin at its pivot.
"""

import math

import bmesh
import bpy
from mathutils import Matrix, Vector

SHARP_EDGE_RAD = math.radians(48)  # rounded edges here turn by at most 45 degrees a step
ATLAS_MARGIN = 0.006  # of the atlas: 6 texels of 1024, so two mip levels stay clean


class Assembly:
    def __init__(self, name):
        self.name = name
        self.parts = []
        self.recipes = []
        self.bm = bmesh.new()
        self.atlas = self.bm.loops.layers.uv.new("atlas")
        self.decal = self.bm.loops.layers.uv.new("decal")
        self.part = self.bm.faces.layers.int.new("part")

    def add(self, shape, recipe, matrix=None, part="body", density=1.0):
        """density: texels a metre relative to the rest of the model; see where eyes rest."""
        matrix = matrix or Matrix()
        if recipe not in self.recipes:
            self.recipes.append(recipe)
        if part not in self.parts:
            self.parts.append(part)
        vertices = [self.bm.verts.new(matrix @ Vector(v)) for v in shape.vertices]
        for corners, uvs, decals in zip(shape.faces, shape.uvs, shape.decals):
            face = self.bm.faces.new([vertices[i] for i in corners])
            face.smooth = True
            face.material_index = self.recipes.index(recipe)
            face[self.part] = self.parts.index(part)
            for loop, uv, decal in zip(face.loops, uvs, decals):
                loop[self.atlas].uv = (uv[0] * density, uv[1] * density)
                loop[self.decal].uv = decal

    def finish(self):
        """The whole model as one object: triangles, weighted normals, packed atlas."""
        obj = self._object()
        bpy.context.view_layer.objects.active = obj
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.uv.select_all(action="SELECT")
        bpy.ops.uv.pack_islands(rotate=True, margin_method="FRACTION", margin=ATLAS_MARGIN)
        bpy.ops.object.mode_set(mode="OBJECT")
        self.bm = bmesh.new()
        self.bm.from_mesh(obj.data)
        self.part = self.bm.faces.layers.int["part"]
        bpy.data.objects.remove(obj)
        self._triangulate()
        return self._object()

    def _triangulate(self):
        bmesh.ops.triangulate(self.bm, faces=self.bm.faces[:], quad_method="SHORT_EDGE")
        for edge in self.bm.edges:
            if len(edge.link_faces) == 2:
                edge.smooth = edge.calc_face_angle(0.0) < SHARP_EDGE_RAD

    def _object(self):
        mesh = bpy.data.meshes.new(self.name)
        self.bm.to_mesh(mesh)
        self.bm.free()
        for recipe in self.recipes:
            mesh.materials.append(recipe.material)
        mesh.uv_layers["atlas"].active_render = True
        mesh.uv_layers.active = mesh.uv_layers["atlas"]
        mesh.use_auto_smooth = True
        mesh.auto_smooth_angle = math.pi
        obj = bpy.data.objects.new(self.name, mesh)
        bpy.context.scene.collection.objects.link(obj)
        _apply_weighted_normals(obj)
        return obj

    def split(self, whole, pivots):
        """Objects by part name, each moved so that its pivot (assembly space) is its origin."""
        objects = {}
        for index, part in enumerate(self.parts):
            bm = bmesh.new()
            bm.from_mesh(whole.data)
            layer = bm.faces.layers.int["part"]
            others = [f for f in bm.faces if f[layer] != index]
            bmesh.ops.delete(bm, geom=others, context="FACES")
            pivot = Vector(pivots.get(part, (0, 0, 0)))
            bmesh.ops.translate(bm, verts=bm.verts[:], vec=-pivot)
            mesh = whole.data.copy()
            mesh.name = f"{self.name}.{part}"
            bm.to_mesh(mesh)
            bm.free()
            obj = bpy.data.objects.new(part, mesh)
            obj.location = pivot
            bpy.context.scene.collection.objects.link(obj)
            objects[part] = obj
        bpy.data.objects.remove(whole)
        return objects


def _apply_weighted_normals(obj):
    """Flat sides stay flat next to rounded edges."""
    modifier = obj.modifiers.new("normals", "WEIGHTED_NORMAL")
    modifier.keep_sharp = True
    modifier.weight = 80
    graph = bpy.context.evaluated_depsgraph_get()
    mesh = bpy.data.meshes.new_from_object(
        obj.evaluated_get(graph), preserve_all_data_layers=True, depsgraph=graph
    )
    obj.modifiers.clear()
    obj.data = mesh
