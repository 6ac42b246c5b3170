#!/usr/bin/env python3
"""Trains the plane network on shards of make_training_set; see README.md beside this file."""
import argparse
import glob
import math
import os
import time

import numpy as np
import torch
import torch.nn.functional as F
from torch.optim.swa_utils import AveragedModel

from plane_network import FINE, WIDTH, PlaneNetwork, fine_maps
from plane_shards import INSTANCES, make_batch, open_shard

STEP_WEIGHT = 4.0  # of a step against none, which is twenty times as frequent
PULL = 0.25   # embeddings nearer than this to their instance's mean are left alone
PUSH = 2.0    # means farther apart than this are left alone
SHARDS_OPEN = 4
# What is planar is learned last and counts most.
WEIGHTS = {"planarity": 2.0, "steps": 1.0, "normal": 0.5, "pull": 1.0, "push": 1.0,
           "spread": 0.001}


def embedding_loss(embedding, instances):
    """Discriminative loss of De Brabandere et al. 2017, per picture over its instances."""
    n, channels = embedding.shape[:2]
    slots = INSTANCES + 1  # the first takes what is on no instance
    points = embedding.permute(0, 2, 3, 1).reshape(-1, channels)
    slot = (instances.reshape(n, -1) + slots * torch.arange(n).unsqueeze(1)).reshape(-1)
    count = torch.zeros(n * slots).index_add_(0, slot, torch.ones(len(slot)))
    sums = torch.zeros(n * slots, channels).index_add_(0, slot, points)
    means = sums / count.clamp(min=1).unsqueeze(1)
    there = (count > 0).float().reshape(n, slots)[:, 1:]
    off = F.relu((points - means[slot]).square().sum(1).add(1e-8).sqrt() - PULL).square()
    off = torch.zeros(n * slots).index_add_(0, slot, off) / count.clamp(min=1)
    off, count = off.reshape(n, slots)[:, 1:], count.reshape(n, slots)[:, 1:]
    means = means.reshape(n, slots, channels)[:, 1:]
    # Large instances count more than small ones, by the root of their size.
    weight = count.sqrt() * there
    pull = (off * weight).sum(1) / weight.sum(1).clamp(min=1)
    distance = (means.unsqueeze(1) - means.unsqueeze(2)).square().sum(3).add(1e-8).sqrt()
    pairs = there.unsqueeze(1) * there.unsqueeze(2) * (1 - torch.eye(INSTANCES))
    push = (F.relu(PUSH - distance).square() * pairs).sum((1, 2)) / pairs.sum((1, 2)).clamp(min=1)
    spread = (means.norm(dim=2) * there).sum(1) / there.sum(1).clamp(min=1)
    return pull.mean(), push.mean(), spread.mean()


def forward(network, batch, half):
    """Maps as float32; convolutions in bfloat16 where `half`, which is what makes two cores do."""
    rgb = batch["rgb"].contiguous(memory_format=torch.channels_last)
    if not half:
        return network(rgb)
    with torch.autocast("cpu", dtype=torch.bfloat16):
        return network(rgb).float()


def losses(out, batch):
    fine, coarse = fine_maps(out), out[:, 4 * FINE:]
    weight = batch["weight"]
    planarity = F.binary_cross_entropy_with_logits(fine[:, 0], batch["planar"], weight)
    # A step between pixels counts as much as the one of them that counts more.
    beyond = torch.stack([F.pad(weight[:, :, 1:], (0, 1)), F.pad(weight[:, 1:], (0, 0, 0, 1))], 1)
    of_step = torch.maximum(weight.unsqueeze(1), beyond)
    steps = F.binary_cross_entropy_with_logits(fine[:, 1:], batch["steps"], of_step,
                                               pos_weight=torch.tensor(STEP_WEIGHT))
    oriented = batch["oriented"]
    cosine = F.cosine_similarity(coarse[:, :3], batch["normals"], dim=1)
    normal = (2 * (1 - cosine) * oriented).sum() / oriented.sum().clamp(min=1)
    pull, push, spread = embedding_loss(coarse[:, 3:], batch["instances"])
    scale = weight.numel() / weight.sum()
    return {"planarity": planarity * scale, "steps": steps * scale, "normal": normal,
            "pull": pull, "push": push, "spread": spread}


class Shuffler:
    """Batches from a few shards at a time, in an order that the seed fixes once all are there."""

    def __init__(self, pattern, seed, width):
        self.pattern = pattern
        self.width = width
        self.random = np.random.default_rng(seed)
        self.open = []

    def batch(self, size):
        if not self.open:
            paths = sorted(glob.glob(self.pattern))
            picked = self.random.choice(len(paths), min(SHARDS_OPEN, len(paths)), replace=False)
            self.open = [open_shard(paths[i]) for i in picked]
            self.left = [(s, i) for s, shard in enumerate(self.open) for i in range(len(shard))]
            self.random.shuffle(self.left)
        taken, self.left = self.left[:size], self.left[size:]
        rows = np.stack([self.open[s][i] for s, i in taken])
        if len(self.left) < size:
            self.open = []
        return {k: torch.from_numpy(v) for k, v in make_batch(rows, self.random, self.width).items()}


def validate(network, path, batch=20):
    network.eval()
    shard = open_shard(path)
    sums = {}
    with torch.no_grad():
        for first in range(0, len(shard), batch):
            data = make_batch(shard[first:first + batch])
            data = {k: torch.from_numpy(v) for k, v in data.items()}
            out = forward(network, data, False)
            values = losses(out, data)
            judged = data["weight"] > 0
            right = (fine_maps(out)[:, 0] > 0) == (data["planar"] > 0)
            values["accuracy"] = (right & judged).sum() / judged.sum()
            for k, v in values.items():
                sums[k] = sums.get(k, 0.0) + float(v) * min(batch, len(shard) - first)
    network.train()
    return {k: v / len(shard) for k, v in sums.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--shards", required=True, help="glob of the training shards")
    parser.add_argument("--validation", required=True, help="shard to report on")
    parser.add_argument("--output", required=True, help="checkpoint to write (.pt)")
    parser.add_argument("--start", help="checkpoint to begin with")
    parser.add_argument("--steps", type=int, default=10000)
    parser.add_argument("--batch", type=int, default=16)
    parser.add_argument("--width", type=int, default=WIDTH, help="of the pictures, 192 or 128")
    parser.add_argument("--decay", type=float, default=0.5,
                        help="share of the steps over which the rate falls to nothing")
    parser.add_argument("--average", type=float, default=0.0,
                        help="what is kept is a running mean of the weights; share of the past a step")
    parser.add_argument("--float32", action="store_true", help="where bfloat16 is not faster")
    parser.add_argument("--rate", type=float, default=3e-3)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1)
    options = parser.parse_args()

    torch.set_num_threads(options.threads)
    torch.manual_seed(options.seed)
    network = PlaneNetwork().to(memory_format=torch.channels_last)
    if options.start:
        network.load_state_dict(torch.load(options.start))
    network.train()
    kept = network
    if options.average > 0:
        kept = AveragedModel(network, use_buffers=True, avg_fn=lambda mean, value, _: torch.lerp(
            value.float(), mean.float(), options.average).to(mean.dtype))
    optimizer = torch.optim.AdamW(network.parameters(), lr=options.rate, weight_decay=1e-4)
    warm = 200
    falling = max(1, int(options.decay * options.steps))

    def rate(step):
        left = (options.steps - step) / falling
        return min(1.0, (step + 1) / warm, 0.5 * (1 - math.cos(math.pi * min(left, 1.0))))

    schedule = torch.optim.lr_scheduler.LambdaLR(optimizer, rate)
    shuffler = Shuffler(options.shards, options.seed, options.width)
    print(f"seed {options.seed}, {options.steps} steps of {options.batch}, "
          f"{sum(p.numel() for p in network.parameters())} parameters", flush=True)
    started, sums = time.time(), {}
    for step in range(1, options.steps + 1):
        batch = shuffler.batch(options.batch)
        values = losses(forward(network, batch, not options.float32), batch)
        loss = sum(WEIGHTS[k] * v for k, v in values.items())
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), 5.0)
        optimizer.step()
        schedule.step()
        if kept is not network:
            kept.update_parameters(network)
        for k, v in values.items():
            sums[k] = sums.get(k, 0.0) + float(v)
        if step % 100 == 0:
            text = " ".join(f"{k} {v / 100:.4f}" for k, v in sums.items())
            print(f"{step} {time.time() - started:.0f}s cpu {time.process_time():.0f}s {text}", flush=True)
            sums = {}
        if step % 500 == 0 or step == options.steps:
            result = network if kept is network else kept.module
            torch.save(result.state_dict(), options.output + ".part")
            os.replace(options.output + ".part", options.output)
            text = " ".join(f"{k} {v:.4f}" for k, v in validate(result, options.validation).items())
            print(f"{step} validation {text}", flush=True)


if __name__ == "__main__":
    main()
