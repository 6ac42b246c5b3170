#!/usr/bin/env python3
"""Makes a training shard of an RGB-D sequence in TUM's format and plane masks of it."""
import argparse
import os

import cv2
import numpy as np

from plane_network import HEIGHT, WIDTH
from plane_shards import IGNORED

MIN_SHARE = 0.005  # of the picture, as in the generated rooms: smaller planes are ignored


def read_list(path):
    """[(time, file)] of a TUM list."""
    entries = []
    with open(path) as lines:
        for line in lines:
            fields = line.split()
            if len(fields) >= 2 and not line.startswith("#"):
                entries.append((float(fields[0]), os.path.join(os.path.dirname(path), fields[1])))
    return entries


def nearest(entries, time, most=0.02):
    best = min(entries, key=lambda entry: abs(entry[0] - time))
    return best[1] if abs(best[0] - time) <= most else None


def plane_normal(points):
    """Unit normal towards the camera of the plane through the points (N x 3)."""
    normal = np.linalg.svd(points - points.mean(0), full_matrices=False)[2][2]
    return normal if normal @ points.mean(0) < 0 else -normal


def sample(color, depth_m, mask, camera):
    fx, fy, cx, cy = camera
    squeezed = (WIDTH, HEIGHT)
    labels = np.zeros((HEIGHT, WIDTH), np.uint8)
    normals = np.zeros((HEIGHT, WIDTH, 3), np.int8)
    small_mask = cv2.resize(mask, squeezed, interpolation=cv2.INTER_NEAREST)
    small_depth = cv2.resize(depth_m, squeezed, interpolation=cv2.INTER_NEAREST)
    labels[(small_mask == 0) & (small_depth <= 0)] = IGNORED
    v, u = np.mgrid[:mask.shape[0]:4, :mask.shape[1]:4]
    z = depth_m[::4, ::4]
    points = np.stack([(u - cx) / fx * z, (v - cy) / fy * z, z], -1)
    following = 1
    for instance in np.unique(small_mask[small_mask > 0]):
        there = small_mask == instance
        of_instance = points[(mask[::4, ::4] == instance) & (z > 0)]
        large = there.sum() >= MIN_SHARE * WIDTH * HEIGHT and len(of_instance) >= 12
        labels[there] = following if large and following < IGNORED else IGNORED
        if large:
            normals[there] = np.rint(127 * plane_normal(of_instance)).astype(np.int8)
            following += 1
    small = cv2.resize(color, squeezed, interpolation=cv2.INTER_AREA)
    return small.tobytes() + labels.tobytes() + normals.tobytes()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sequence", help="folder with rgb.txt and depth.txt")
    parser.add_argument("masks", help="folder with mask.txt")
    parser.add_argument("shard")
    parser.add_argument("--camera", type=float, nargs=4, required=True,
                        metavar=("FX", "FY", "CX", "CY"))
    parser.add_argument("--depth-factor", type=float, default=5000, help="units of a metre")
    parser.add_argument("--every", type=int, default=3, help="frames that are taken")
    options = parser.parse_args()
    depths = read_list(os.path.join(options.sequence, "depth.txt"))
    masks = read_list(os.path.join(options.masks, "mask.txt"))
    written = 0
    with open(options.shard, "wb") as out:
        for time, color in read_list(os.path.join(options.sequence, "rgb.txt"))[::options.every]:
            depth, mask = nearest(depths, time), nearest(masks, time)
            if depth is None or mask is None:
                continue
            depth_m = cv2.imread(depth, cv2.IMREAD_UNCHANGED).astype(np.float32)
            depth_m[depth_m == 65535] = 0
            out.write(sample(cv2.imread(color), depth_m / options.depth_factor,
                             cv2.imread(mask, cv2.IMREAD_UNCHANGED), options.camera))
            written += 1
    print(f"{options.shard}: {written} samples")


if __name__ == "__main__":
    main()
