#!/usr/bin/env python3
"""Makes a checkpoint for train_planes.py --start from a file of export_planes.py.

The file has its normalisations folded into the convolutions; they are set up anew from pictures of a
shard, so that the network computes the same and can be trained further."""
import argparse

import onnx
import torch
from onnx import numpy_helper
from torch import nn

from plane_network import PlaneNetwork
from plane_shards import make_batch, open_shard


def set_normalisation(module, inputs):
    """Statistics of what comes in, and the scale and shift that undo them; then the folded bias."""
    variances, means = torch.var_mean(inputs[0], (0, 2, 3), unbiased=False)
    module.running_mean.copy_(means)
    module.running_var.copy_(variances)
    module.weight.copy_((variances + module.eps).sqrt())
    module.bias.add_(means)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("onnx")
    parser.add_argument("shard", help="of make_training_set or shard_from_masks.py")
    parser.add_argument("checkpoint")
    parser.add_argument("--pictures", type=int, default=200)
    options = parser.parse_args()
    graph = onnx.load(options.onnx).graph
    values = {i.name: torch.from_numpy(numpy_helper.to_array(i).copy()) for i in graph.initializer}
    folded = [[values[name] for name in node.input[1:]] for node in graph.node if node.op_type == "Conv"]

    network = PlaneNetwork().eval()
    order = []  # of the convolutions, as they are computed: what the file's order is, too
    hooks = [m.register_forward_hook(lambda module, *_: order.append(module))
             for m in network.modules() if isinstance(m, nn.Conv2d)]
    rows = open_shard(options.shard)
    rows = rows[::max(1, len(rows) // options.pictures)][:options.pictures]
    picture = torch.from_numpy(make_batch(rows)["rgb"])
    with torch.no_grad():
        network(picture[:1])
        for hook in hooks:
            hook.remove()
        following = {m[0]: m[1] for m in network.modules()
                     if isinstance(m, nn.Sequential) and len(m) == 2 and isinstance(m[1], nn.BatchNorm2d)}
        for module, (weight, bias) in zip(order, folded, strict=True):
            module.weight.copy_(weight)
            holder = module if module.bias is not None else following[module]
            holder.bias.copy_(bias)
        for normalisation in following.values():
            normalisation.register_forward_pre_hook(set_normalisation)
        network(picture)
    torch.save(network.state_dict(), options.checkpoint)


if __name__ == "__main__":
    main()
