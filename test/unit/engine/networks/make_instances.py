#!/usr/bin/env python3
"""Makes instances.onnx: a network of the PlaneRecNet kind, as small as can be. Three instances: where the
picture is red, green or blue; their scores are 0.9, 0.8 and 0.1 whatever the picture."""
import os

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

SIZE = 32


def logit(p):
    return float(np.log(p / (1 - p)))


def main():
    # Input: RGB / 255. A channel above one half gives a mask.
    weights = {
        "colour": 20.0 * np.eye(3, dtype=np.float32).reshape(3, 3, 1, 1),
        "half": np.full(3, -10.0, np.float32),
        "nothing": np.zeros((3, 3, 1, 1), np.float32),
        "certainty": np.array([logit(p) for p in (0.9, 0.8, 0.1)], np.float32),
    }
    nodes = [
        helper.make_node("AveragePool", ["image"], ["quarter"], kernel_shape=[4, 4], strides=[4, 4]),
        helper.make_node("Conv", ["quarter", "colour", "half"], ["claims"], kernel_shape=[1, 1]),
        helper.make_node("Sigmoid", ["claims"], ["masks"]),
        helper.make_node("GlobalAveragePool", ["quarter"], ["mean"]),
        helper.make_node("Conv", ["mean", "nothing", "certainty"], ["sure"], kernel_shape=[1, 1]),
        helper.make_node("Sigmoid", ["sure"], ["scores"]),
    ]
    graph = helper.make_graph(
        nodes, "instances",
        [helper.make_tensor_value_info("image", TensorProto.FLOAT, [1, 3, SIZE, SIZE])],
        [helper.make_tensor_value_info("masks", TensorProto.FLOAT, [1, 3, SIZE // 4, SIZE // 4]),
         helper.make_tensor_value_info("scores", TensorProto.FLOAT, [1, 3, 1, 1])],
        [numpy_helper.from_array(value, name) for name, value in weights.items()])
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 11)])
    model.ir_version = 6
    onnx.checker.check_model(model)
    onnx.save(model, os.path.join(os.path.dirname(os.path.abspath(__file__)), "instances.onnx"))


if __name__ == "__main__":
    main()
