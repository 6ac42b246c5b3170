"""Three-vectors as lists, for the integration tests: they need nothing beyond plain Python."""


def subtract(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def rotate_back(quaternion, v):
    """R(q)^T v for q = (x, y, z, w)."""
    x, y, z, w = quaternion
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return [sum(rows[k][i] * v[k] for k in range(3)) for i in range(3)]
