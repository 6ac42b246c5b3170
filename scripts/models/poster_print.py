"""The picture on the poster: a lake between mountains at dawn, as a screen print in flat inks."""

import numpy as np

from models import drawing

PAPER = drawing.srgb("#f4ead6")
SKY = ("#1d4a63", "#2f6478", "#54818a", "#85a097", "#b9b99c", "#e3c79a", "#f4cd96", "#f8d9a8")
SUN = drawing.srgb("#f4683c")
RIDGES = ("#e8a583", "#b9787c", "#6d5a78", "#37466b", "#1c2f4d")
PINES = drawing.srgb("#10202f")
CAPTION = "PLANECAST"


def picture(width, height):
    """Linear RGB, height rows; drawn at twice the size and halved."""
    w, h = 2 * width, 2 * height
    x, y = drawing.grid(w, h)
    x, y = x / w, y / h * (h / w)  # unit: picture width
    tall = h / w
    soft = 1.0 / w
    horizon = 0.66 * tall
    image = sky(x, y, horizon)
    sun_at = (0.62, 0.36 * tall)
    image = drawing.paint(
        image, SUN, drawing.cover(np.hypot(x - sun_at[0], y - sun_at[1]) - 0.15, soft)
    )
    image = clouds(image, x, y, soft)
    image = ridges(image, x, y, horizon, soft)
    image = lake(image, y, horizon, sun_at, x, soft)
    image = pines(image, x, y, tall, soft)
    image = birds(image, x, y, soft)
    image = margin_and_caption(image, x, y, tall, soft)
    grain = drawing.fractal_noise(x * 420, y * 420, 90, 2) - 0.5
    mottle = drawing.fractal_noise(x * 24, y * 24, 95, 4) - 0.5
    image = image * (1 + 0.10 * grain + 0.07 * mottle)[..., None]
    return image.reshape(height, 2, width, 2, 3).mean(axis=(1, 3))


def sky(x, y, horizon):
    """Flat tones from night to dawn, each edge a little wavy, as a print has them."""
    t = np.clip(1.6 * y / horizon + 0.012 * np.sin(5 * x + 9 * y), 0, 0.999)
    return np.array([drawing.srgb(ink) for ink in SKY])[(t * len(SKY)).astype(int)]


def clouds(image, x, y, soft):
    for cx, cy, length in (
        (0.22, 0.33, 0.20),
        (0.34, 0.36, 0.16),
        (0.80, 0.47, 0.22),
        (0.70, 0.50, 0.12),
    ):
        bar = drawing.box_distance(x, y, cx, cy, length / 2, 0.010, 0.010)
        image = drawing.paint(image, PAPER, 0.85 * drawing.cover(bar, soft))
    return image


def ridges(image, x, y, horizon, soft):
    for i, ink in enumerate(RIDGES):
        depth = i / (len(RIDGES) - 1)
        line = crest_line(x * (2.2 + 1.3 * depth) + 7.3 * i, i, peaked=i < 2)
        crest = horizon - 0.36 * (1 - 0.78 * depth) * (0.30 + 0.95 * line) + 0.03 * depth
        image = drawing.paint(image, drawing.srgb(ink), drawing.cover(crest - y, soft))
        if i < 2:
            image = snow(image, x, y, crest, i, soft)
    return image


def crest_line(along, i, peaked):
    """Height of a range in 0..1; far ranges are folded noise, which has peaks and saddles."""
    row = np.zeros_like(along) + 3.1 * i
    if not peaked:
        return drawing.fractal_noise(along, row, 20 + i, 5, 0.47)
    coarse = 1 - np.abs(2 * drawing.value_noise(along * 1.1, row, 20 + i) - 1)
    fine = 1 - np.abs(2 * drawing.fractal_noise(along * 3.7, row, 30 + i, 4, 0.45) - 1)
    return 0.72 * coarse + 0.28 * fine


def snow(image, x, y, crest, i, soft):
    """Caps on the far peaks, thicker the higher they are, their lower edge ragged."""
    height = np.clip((np.min(crest) + 0.13 - crest) / 0.13, 0, 1)
    tooth = np.abs((x * 26 + 0.9 * drawing.value_noise(x * 15, x * 0, 44 + i)) % 1.0 - 0.5) * 2
    ragged = 0.075 * height * (0.35 + 0.65 * tooth)
    cap = np.maximum(crest - y, y - crest - ragged + 0.003)
    return drawing.paint(image, PAPER, 0.92 * drawing.cover(cap, soft))


def lake(image, y, horizon, sun_at, x, soft):
    water = drawing.srgb("#2c6f86") * (1.1 - 0.55 * np.clip((y - horizon) / 0.4, 0, 1))[..., None]
    image = drawing.paint(image, water, drawing.cover(horizon - y, soft))
    for row in range(11):
        depth = row / 10
        cy = horizon + 0.012 + 0.021 * row + 0.004 * (row % 3)
        half = 0.125 * (1 - 0.55 * depth) * (0.75 + 0.4 * ((row * 37) % 10) / 10)
        shift = 0.02 * np.sin(row * 2.3)
        bar = drawing.box_distance(x, y, sun_at[0] + shift, cy, half, 0.0042 + 0.001 * depth, 0.004)
        image = drawing.paint(image, SUN * 1.05, drawing.cover(bar, soft) * (y > horizon))
    return image


def pines(image, x, y, tall, soft):
    """A dark bank in front, with a stand of pines on either side."""
    bank = tall * 0.905 - 0.05 * (2 * x - 0.95) ** 2 + 0.012 * np.sin(13 * x)
    image = drawing.paint(image, PINES, drawing.cover(bank - y, soft))
    random = np.random.RandomState(5)
    for i in range(17):
        cx = random.uniform(0.0, 0.30) if i < 10 else random.uniform(0.80, 1.0)
        reach = 0.34 - 0.75 * cx if i < 10 else 0.13 + 0.75 * (cx - 0.80)
        size = max(0.09, reach * random.uniform(0.75, 1.1))
        foot = tall * 0.905 - 0.05 * (2 * cx - 0.95) ** 2 + 0.02
        image = drawing.paint(
            image,
            PINES * (0.8 + 0.5 * random.rand()),
            drawing.cover(pine(x, y, cx, foot, size), soft),
        )
    return image


def pine(x, y, cx, foot, size):
    """Signed distance, nearly, of tiers that widen downwards."""
    down = np.clip((y - foot + size) / size, 0, 1)
    tier = (down * 6) % 1.0
    half = size * 0.20 * down**0.9 * (0.55 + 0.45 * tier) * (down < 0.92)
    half = np.maximum(half, size * np.minimum(0.018, 0.3 * down))
    side = np.abs(x - cx) - half
    return np.maximum(np.maximum(side, foot - size - y), y - foot)


def birds(image, x, y, soft):
    for cx, cy, size in ((0.30, 0.20, 0.030), (0.37, 0.235, 0.022), (0.25, 0.25, 0.019)):
        for side in (-1, 1):
            bend = [
                (cx, cy),
                (cx + side * 0.45 * size, cy - 0.42 * size),
                (cx + side * size, cy - 0.22 * size),
            ]
            for a, b in zip(bend, bend[1:]):
                line = drawing.segment_distance(x, y, a, b) - 0.0026
                image = drawing.paint(image, PAPER, drawing.cover(line, soft))
    return image


def margin_and_caption(image, x, y, tall, soft):
    border = 0.035
    foot = 0.115
    inside = drawing.box_distance(
        x, y, 0.5, (tall + border - foot) / 2, 0.5 - border, (tall - border - foot) / 2
    )
    image = drawing.paint(image, PAPER, drawing.cover(-inside, soft))
    size, pitch = 0.036, 0.072
    left = 0.5 - pitch * (len(CAPTION) - 1) / 2 - 0.35 * size
    for i, letter in enumerate(CAPTION):
        ink = (
            drawing.letter_distance(x, y, letter, left + i * pitch, tall - foot * 0.68, size)
            - 0.0034
        )
        image = drawing.paint(image, drawing.srgb("#1c2f4d"), drawing.cover(ink, soft))
    return image
