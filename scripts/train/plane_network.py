"""The network of docs/segmentation.md: 192x144 RGB in, maps of a quarter of that size out."""
import torch.nn.functional as F
from torch import nn

WIDTH, HEIGHT = 192, 144
FINE = 3    # planarity, step to the right and step down (logits): four values a cell, 2x2 pixels
COARSE = 7  # normal (3), embedding (4)
OUTPUTS = 4 * FINE + COARSE


def conv(inputs, outputs, size=3, stride=1, dilation=1, groups=1):
    return nn.Sequential(
        nn.Conv2d(inputs, outputs, size, stride, size // 2 * dilation, dilation, groups, bias=False),
        nn.BatchNorm2d(outputs))


def separable(inputs, outputs, stride=1):
    return nn.Sequential(conv(inputs, inputs, stride=stride, groups=inputs), nn.ReLU(),
                         conv(inputs, outputs, 1))


class Residual(nn.Module):
    """Two separable convolutions: a sum costs as much as a depthwise convolution."""

    def __init__(self, channels):
        super().__init__()
        self.first = separable(channels, channels)
        self.second = separable(channels, channels)

    def forward(self, x):
        return F.relu(x + self.second(F.relu(self.first(x))))


class Bottleneck(nn.Module):
    """Where a picture is 12 wide, OpenCV's depthwise convolutions are slow and full ones are not."""

    def __init__(self, channels, inner, dilation):
        super().__init__()
        self.narrow = conv(channels, inner, 1)
        self.look = conv(inner, inner, dilation=dilation)
        self.widen = conv(inner, channels, 1)

    def forward(self, x):
        return F.relu(x + self.widen(F.relu(self.look(F.relu(self.narrow(x))))))


def twice(x):
    return F.interpolate(x, scale_factor=2, mode="bilinear", align_corners=False)


class PlaneNetwork(nn.Module):
    """N x 3 x 144 x 192, RGB / 255 - 0.5 -> N x 19 x 36 x 48.

    Nothing but the first convolution is computed at half the size: the fine maps come out as four
    values a cell."""

    def __init__(self, stem=16, quarter=40, eighth=96, sixteenth=192, inner=64):
        super().__init__()
        self.stem = conv(3, stem, stride=2)
        self.quarter = nn.Sequential(separable(stem, quarter, 2), nn.ReLU(),
                                     separable(quarter, quarter), nn.ReLU())
        self.eighth = nn.Sequential(separable(quarter, eighth, 2), nn.ReLU(),
                                    Residual(eighth), Residual(eighth))
        self.sixteenth = nn.Sequential(
            separable(eighth, sixteenth, 2), nn.ReLU(),
            *[Bottleneck(sixteenth, inner, dilation) for dilation in (1, 2, 3, 1)])
        self.whole = nn.Conv2d(sixteenth, eighth, 1)
        self.from_sixteenth = conv(sixteenth, eighth, 1)
        self.at_eighth = nn.Sequential(Residual(eighth), Residual(eighth))
        self.from_eighth = conv(eighth, quarter, 1)
        self.at_quarter = Residual(quarter)
        self.head = nn.Conv2d(quarter, OUTPUTS, 1)

    def forward(self, rgb):
        quarter = self.quarter(F.relu(self.stem(rgb)))
        eighth = self.eighth(quarter)
        x = self.sixteenth(eighth)
        x = self.from_sixteenth(x) + self.whole(F.adaptive_avg_pool2d(x, 1))
        x = self.at_eighth(F.relu(twice(x) + eighth))
        x = self.at_quarter(F.relu(twice(self.from_eighth(x)) + quarter))
        return self.head(x)


def fine_maps(out):
    """N x 3 x 2h x 2w: the values of each cell, row by row, as pixels."""
    return F.pixel_shuffle(out[:, :4 * FINE], 2)
