"""Reads the shards of make_training_set: 192x144 BGR bytes, labels, normals (127 x, int8)."""
import os

import cv2
import numpy as np

from plane_network import HEIGHT, WIDTH

PIXELS = WIDTH * HEIGHT
SAMPLE_BYTES = 7 * PIXELS
IGNORED = 255
INSTANCES = 24  # at most, in a picture; what is smaller than these is not looked at
SMALL_SHARE = 0.04  # of the picture; pixels of smaller planes count more,
MOST_WEIGHT = 3.0   # at most so much


def open_shard(path):
    samples = os.path.getsize(path) // SAMPLE_BYTES
    return np.memmap(path, np.uint8, "r", shape=(samples, SAMPLE_BYTES))


def unpack(rows):
    """-> rgb (N,144,192,3) uint8, labels (N,144,192) uint8, normals (N,144,192,3) int8"""
    n = len(rows)
    bgr = rows[:, :3 * PIXELS].reshape(n, HEIGHT, WIDTH, 3)
    labels = rows[:, 3 * PIXELS:4 * PIXELS].reshape(n, HEIGHT, WIDTH)
    normals = rows[:, 4 * PIXELS:].view(np.int8).reshape(n, HEIGHT, WIDTH, 3)
    return bgr[..., ::-1], labels, normals


def steps(labels):
    """Whether the pixel to the right, and that below, has another label (N x 2 x h x w)."""
    out = np.zeros((len(labels), 2, *labels.shape[1:]), np.float32)
    out[:, 0, :, :-1] = labels[:, :, 1:] != labels[:, :, :-1]
    out[:, 1, :-1] = labels[:, 1:] != labels[:, :-1]
    return out


def pixel_weights(labels):
    """What errors count: more on small planes, of which recall counts each as much as a large one."""
    out = np.ones(labels.shape, np.float32)
    for i, picture in enumerate(labels):
        share = np.bincount(picture.ravel(), minlength=256) / picture.size
        table = np.clip(np.sqrt(SMALL_SHARE / np.maximum(share, 1e-6)), 1, MOST_WEIGHT)
        table[0], table[IGNORED] = 1, 0
        out[i] = table[picture]
    return out


def largest_instances(labels):
    """Labels 1.. of each picture by falling size, the rest 0."""
    out = np.zeros(labels.shape, np.int64)
    for i, picture in enumerate(labels):
        counts = np.bincount(picture.ravel(), minlength=256)
        counts[0] = counts[IGNORED] = 0
        order = np.argsort(-counts, kind="stable")[:INSTANCES]
        table = np.zeros(256, np.int64)
        for rank, label in enumerate(order):
            if counts[label] > 0:
                table[label] = rank + 1
        out[i] = table[picture]
    return out


def make_batch(rows, random=None, width=WIDTH):
    """Float arrays for training, pictures `width` wide, fine maps of half and coarse ones of a quarter
    of that size; with a generator also flipped and with other colours."""
    rgb, labels, normals = unpack(rows)
    height = width * HEIGHT // WIDTH
    if width != WIDTH:
        rgb = np.stack([cv2.resize(np.ascontiguousarray(x), (width, height)) for x in rgb])
    rgb = rgb.astype(np.float32) * np.float32(1 / 255)
    y = ((np.arange(height // 2) + 0.5) * 2 * HEIGHT / height).astype(int)[:, None]
    x = ((np.arange(width // 2) + 0.5) * 2 * WIDTH / width).astype(int)
    labels, normals = labels[:, y, x], normals[:, y, x]
    if random is not None:
        n = len(rows)
        flip = random.random(n) < 0.5
        rgb[flip] = rgb[flip, :, ::-1]
        labels[flip] = labels[flip, :, ::-1]
        normals[flip] = normals[flip, :, ::-1] * np.array([-1, 1, 1], np.int8)
        swap = random.random(n) < 0.3  # of the colours
        rgb[swap] = rgb[swap][..., random.permutation(3)]
        gain = random.uniform(0.75, 1.25, (n, 1, 1, 1)) * random.uniform(0.9, 1.1, (n, 1, 1, 3))
        shift = random.uniform(-0.08, 0.08, (n, 1, 1, 1))
        rgb = np.clip(rgb * gain.astype(np.float32) + shift.astype(np.float32), 0, 1)
    # A cell of the coarse maps is judged by one of its four pixels.
    row, column = (0, 0) if random is None else random.integers(2, size=2)
    coarse = labels[:, row::2, column::2]
    normals = normals[:, row::2, column::2].astype(np.float32) / 127.0
    return {
        "rgb": np.ascontiguousarray(rgb.transpose(0, 3, 1, 2)) - np.float32(0.5),
        "planar": ((labels > 0) & (labels < IGNORED)).astype(np.float32),
        "weight": pixel_weights(labels),
        "steps": steps(labels),
        "normals": np.ascontiguousarray(normals.transpose(0, 3, 1, 2)),
        "oriented": ((coarse > 0) & (coarse < IGNORED)).astype(np.float32),
        "instances": largest_instances(coarse),
    }
