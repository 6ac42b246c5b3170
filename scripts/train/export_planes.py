#!/usr/bin/env python3
"""Writes a checkpoint of train_planes.py as ONNX and checks that OpenCV reads it as it was meant."""
import argparse

import cv2
import numpy as np
import torch

from plane_network import HEIGHT, WIDTH, PlaneNetwork


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("checkpoint")
    parser.add_argument("onnx")
    options = parser.parse_args()
    network = PlaneNetwork()
    network.load_state_dict(torch.load(options.checkpoint))
    network.eval()
    picture = torch.rand(1, 3, HEIGHT, WIDTH, generator=torch.Generator().manual_seed(1)) - 0.5
    torch.onnx.export(network, picture, options.onnx, opset_version=11, input_names=["picture"],
                      output_names=["maps"])
    read = cv2.dnn.readNetFromONNX(options.onnx)
    read.setInput(picture.numpy())
    difference = np.abs(read.forward() - network(picture).detach().numpy()).max()
    print(f"largest difference between OpenCV and PyTorch: {difference:.2g}")
    if difference > 1e-3:
        raise SystemExit("OpenCV reads the network wrongly")


if __name__ == "__main__":
    main()
