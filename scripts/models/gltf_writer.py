"""Writes small .gltf files with everything in data URIs; needs nothing but Python."""

import base64
import json
import struct
import zlib

FORMATS = {5121: "B", 5123: "H", 5125: "I", 5126: "f"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def png(width, height, pixel):
    """A PNG of RGBA8 from pixel(x, y) -> four numbers in 0..255."""
    rows = b"".join(
        b"\0" + bytes(channel for x in range(width) for channel in pixel(x, y))
        for y in range(height)
    )

    def chunk(name, data):
        body = name + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(rows, 9))
        + chunk(b"IEND", b"")
    )


class Gltf:
    """A glTF file under construction; every method returns the index of what it added."""

    def __init__(self, name):
        self.bytes = b""
        self.known = {}  # accessors by what they hold
        self.json = {
            "asset": {
                "version": "2.0",
                "generator": "scripts/make_test_models.py",
                "copyright": "Planecast authors, CC0-1.0",
            },
            "scene": 0,
            "scenes": [{"name": name, "nodes": []}],
        }

    def add(self, key, value):
        self.json.setdefault(key, []).append(value)
        return len(self.json[key]) - 1

    def use(self, extension):
        if extension not in self.json.setdefault("extensionsUsed", []):
            self.json["extensionsUsed"].append(extension)

    def view(self, data):
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        index = self.add(
            "bufferViews", {"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(data)}
        )
        self.bytes += data
        return index

    def accessor(self, values, kind, component=5126, normalized=False):
        flat = [v for value in values for v in (value if isinstance(value, (list, tuple)) else [value])]
        data = struct.pack(f"<{len(flat)}{FORMATS[component]}", *flat)
        key = (data, kind, component, normalized)
        if key in self.known:
            return self.known[key]
        entry = {
            "bufferView": self.view(data),
            "componentType": component,
            "count": len(flat) // WIDTHS[kind],
            "type": kind,
        }
        if normalized:
            entry["normalized"] = True
        if kind in ("VEC3", "SCALAR") and component == 5126:
            width = WIDTHS[kind]
            as_stored = struct.unpack(f"<{len(flat)}f", data)
            entry["min"] = [min(as_stored[i::width]) for i in range(width)]
            entry["max"] = [max(as_stored[i::width]) for i in range(width)]
        self.known[key] = self.add("accessors", entry)
        return self.known[key]

    def primitive(self, shape, material=None, mode=4, indexed=True):
        """A shape is a dictionary of attribute lists with "indices"."""
        kinds = {"TEXCOORD_0": "VEC2", "TEXCOORD_1": "VEC2", "TANGENT": "VEC4", "COLOR_0": "VEC4"}
        attributes = {
            name: self.accessor(values, kinds.get(name, "VEC3"))
            for name, values in shape.items()
            if name != "indices"
        }
        entry = {"attributes": attributes, "mode": mode}
        if indexed:
            entry["indices"] = self.accessor(shape["indices"], "SCALAR", 5123)
        if material is not None:
            entry["material"] = material
        return entry

    def mesh(self, *primitives, **more):
        return self.add("meshes", {"primitives": list(primitives), **more})

    def node(self, root=True, **fields):
        index = self.add("nodes", fields)
        if root:
            self.json["scenes"][0]["nodes"].append(index)
        return index

    def material(self, **fields):
        return self.add("materials", fields)

    def texture(self, width, height, pixel, **sampler):
        image = self.add(
            "images",
            {"bufferView": self.view(png(width, height, pixel)), "mimeType": "image/png"},
        )
        texture = {"source": image}
        if sampler:
            texture["sampler"] = self.add("samplers", sampler)
        return self.add("textures", texture)

    def animation(self, name, channels):
        """Channels: (node, path, interpolation, times, values, accessor type)."""
        samplers, targets = [], []
        for node, path, interpolation, times, values, kind in channels:
            samplers.append(
                {
                    "input": self.accessor(times, "SCALAR"),
                    "output": self.accessor(values, kind),
                    "interpolation": interpolation,
                }
            )
            targets.append({"sampler": len(samplers) - 1, "target": {"node": node, "path": path}})
        return self.add("animations", {"name": name, "samplers": samplers, "channels": targets})

    def write(self, path):
        self.json["buffers"] = [
            {
                "byteLength": len(self.bytes),
                "uri": "data:application/octet-stream;base64,"
                + base64.b64encode(self.bytes).decode(),
            }
        ]
        path.write_text(json.dumps(self.json, separators=(",", ":")) + "\n")
