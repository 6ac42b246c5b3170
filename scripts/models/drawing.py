"""Pictures drawn with numpy: noise, anti-aliased shapes by signed distance, stroke letters.

Images are float arrays, linear 0..1, row 0 at the top; coordinates handed to the distance
functions are in pixels or any unit of the caller's, with y growing downwards.
"""

import numpy as np
from PIL import Image


def srgb(hex_code):
    """Linear RGB of a web colour such as "#2a9d8f"."""
    value = np.array([int(hex_code[i : i + 2], 16) / 255 for i in (1, 3, 5)])
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def to_srgb(linear):
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def grid(width, height):
    """Pixel centre coordinates x, y."""
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    return x, y


def value_noise(x, y, seed, wrap_x=None):
    """Smooth noise in 0..1 on a unit lattice; wrap_x (lattice cells) makes it periodic in x."""
    table = np.random.RandomState(seed).rand(256, 256)
    xi, yi = np.floor(x).astype(int), np.floor(y).astype(int)
    tx, ty = x - xi, y - yi
    tx, ty = tx * tx * (3 - 2 * tx), ty * ty * (3 - 2 * ty)

    def at(i, j):
        return table[j % 256, (i % wrap_x if wrap_x else i) % 256]

    top = at(xi, yi) * (1 - tx) + at(xi + 1, yi) * tx
    bottom = at(xi, yi + 1) * (1 - tx) + at(xi + 1, yi + 1) * tx
    return top * (1 - ty) + bottom * ty


def fractal_noise(x, y, seed, octaves=5, gain=0.5, wrap_x=None):
    """Octaves of value_noise, normalised to 0..1."""
    total, weight, amplitude = 0.0, 0.0, 1.0
    for octave in range(octaves):
        scale = 2**octave
        wrap = wrap_x * scale if wrap_x else None
        total = total + amplitude * value_noise(x * scale, y * scale, seed + octave, wrap)
        weight += amplitude
        amplitude *= gain
    return total / weight


def smoothstep(low, high, x):
    t = np.clip((x - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def cover(distance, softness=0.7):
    """Coverage 0..1 of a shape from its signed distance (negative inside)."""
    return smoothstep(softness, -softness, distance)


def paint(image, colour, mask):
    """Lays a colour (RGB, or a picture) over an image where mask is 1."""
    return image + (np.asarray(colour) - image) * mask[..., None]


def box_distance(x, y, cx, cy, half_w, half_h, radius=0.0):
    dx, dy = np.abs(x - cx) - half_w + radius, np.abs(y - cy) - half_h + radius
    outside = np.hypot(np.maximum(dx, 0), np.maximum(dy, 0))
    return outside + np.minimum(np.maximum(dx, dy), 0) - radius


def segment_distance(x, y, a, b):
    """Distance to the segment a-b, unsigned."""
    ax, ay = a
    dx, dy = b[0] - ax, b[1] - ay
    t = np.clip(((x - ax) * dx + (y - ay) * dy) / max(dx * dx + dy * dy, 1e-12), 0, 1)
    return np.hypot(x - ax - t * dx, y - ay - t * dy)


def arc(cx, cy, rx, ry, start_deg, end_deg, steps=18):
    """Points of an elliptic arc, angles clockwise from +x as y grows downwards."""
    angles = np.radians(np.linspace(start_deg, end_deg, steps))
    return [(cx + rx * np.cos(a), cy + ry * np.sin(a)) for a in angles]


# Strokes of capitals in a box 0.7 wide and 1 tall, y downwards; only those that we letter with.
LETTERS = {
    "A": [[(0.0, 1.0), (0.35, 0.0), (0.7, 1.0)], [(0.13, 0.66), (0.57, 0.66)]],
    "C": [arc(0.38, 0.5, 0.38, 0.5, -48, -312)],
    "E": [[(0.6, 0.0), (0.0, 0.0), (0.0, 1.0), (0.6, 1.0)], [(0.0, 0.48), (0.5, 0.48)]],
    "L": [[(0.0, 0.0), (0.0, 1.0), (0.58, 1.0)]],
    "N": [[(0.0, 1.0), (0.0, 0.0), (0.7, 1.0), (0.7, 0.0)]],
    "P": [
        [(0.0, 1.0), (0.0, 0.0), (0.34, 0.0)] + arc(0.34, 0.28, 0.3, 0.28, -90, 90) + [(0.0, 0.56)]
    ],
    "S": [
        arc(0.33, 0.25, 0.3, 0.25, -25, -180, 14)
        + arc(0.33, 0.25, 0.3, 0.25, 180, 90, 8)
        + arc(0.33, 0.75, 0.33, 0.25, -90, 0, 8)
        + arc(0.33, 0.75, 0.33, 0.25, 0, 155, 14)
    ],
    "T": [[(0.0, 0.0), (0.7, 0.0)], [(0.35, 0.0), (0.35, 1.0)]],
}


def letter_distance(x, y, letter, left, top, height):
    """Distance to the strokes of a letter whose box starts at (left, top)."""
    distance = np.full(np.shape(x), np.inf)
    for stroke in LETTERS[letter]:
        points = [(left + px * height, top + py * height) for px, py in stroke]
        for a, b in zip(points, points[1:]):
            distance = np.minimum(distance, segment_distance(x, y, a, b))
    return distance


def save(path, linear_or_data, colour, quality=90):
    """Writes JPEG by PIL; colour images are encoded as sRGB, data images as they are."""
    values = to_srgb(linear_or_data) if colour else np.clip(linear_or_data, 0, 1)
    pixels = (values * 255 + 0.5).astype(np.uint8)
    Image.fromarray(pixels).save(path, quality=quality, subsampling=0, optimize=True)
