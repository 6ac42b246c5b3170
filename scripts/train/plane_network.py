"""The network of docs/segmentation.md: 192x144 RGB in, maps of half that size out."""
import torch.nn.functional as F
from torch import nn

WIDTH, HEIGHT = 192, 144
OUTPUTS = 9  # planarity and boundary (logits), normal (3), embedding (4)


def conv(inputs, outputs, stride=1, dilation=1, groups=1):
    return nn.Sequential(
        nn.Conv2d(inputs, outputs, 3, stride, dilation, dilation, groups, bias=False),
        nn.BatchNorm2d(outputs))


class Residual(nn.Module):
    def __init__(self, channels, dilation=1):
        super().__init__()
        self.first = conv(channels, channels, dilation=dilation)
        self.second = conv(channels, channels, dilation=dilation)

    def forward(self, x):
        return F.relu(x + self.second(F.relu(self.first(x))))


def twice(x):
    return F.interpolate(x, scale_factor=2, mode="bilinear", align_corners=False)


class PlaneNetwork(nn.Module):
    """N x 3 x 144 x 192, RGB / 255 - 0.5 -> N x 9 x 72 x 96.

    Most of the depth is at a sixteenth of the size, where it costs least: a convolution at half
    the size takes as long as five there."""

    def __init__(self, stem=12, quarter=24, eighth=48, sixteenth=64, decoder=24, last=12):
        super().__init__()
        self.stem = conv(3, stem, stride=2)
        self.quarter = conv(stem, quarter, stride=2)
        self.eighth = nn.Sequential(conv(quarter, eighth, stride=2), nn.ReLU(), Residual(eighth))
        self.sixteenth = nn.Sequential(
            conv(eighth, sixteenth, stride=2), nn.ReLU(),
            *[Residual(sixteenth, dilation) for dilation in (1, 2, 4, 1)])
        self.whole = nn.Conv2d(sixteenth, decoder, 1)
        self.from_sixteenth = nn.Conv2d(sixteenth, decoder, 1)
        self.from_eighth = nn.Conv2d(eighth, decoder, 1)
        self.from_quarter = nn.Conv2d(quarter, decoder, 1)
        self.at_eighth = conv(decoder, decoder)
        self.at_quarter = conv(decoder, decoder)
        self.to_half = nn.Conv2d(decoder, last, 1)
        self.from_stem = nn.Conv2d(stem, last, 1)
        self.at_half = conv(last, last, groups=last)
        self.head = nn.Conv2d(last, OUTPUTS, 1)

    def forward(self, rgb):
        stem = F.relu(self.stem(rgb))
        quarter = F.relu(self.quarter(stem))
        eighth = self.eighth(quarter)
        sixteenth = self.sixteenth(eighth)
        x = F.relu(self.from_sixteenth(sixteenth) + self.whole(F.adaptive_avg_pool2d(sixteenth, 1)))
        x = F.relu(self.at_eighth(F.relu(twice(x) + self.from_eighth(eighth))))
        x = F.relu(self.at_quarter(F.relu(twice(x) + self.from_quarter(quarter))))
        x = F.relu(twice(self.to_half(x)) + self.from_stem(stem))
        x = F.relu(self.at_half(x))
        return self.head(x)
