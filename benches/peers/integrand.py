"""The suite, and its integrands in numpy; see the table of kinds in README.md."""

import numpy as np


def read(path):
    """The integrands of a suite: (name, kind, d, p) each."""
    for line in open(path):
        name, kind, d, _, *p = line.split()
        yield name, int(kind), int(d), np.array(p, dtype=float)


def vectorised(kind, d, p):
    """f of an array whose first axis is the coordinate."""
    a, u = p[:d, None], p[d : 2 * d, None]
    tau = 2 * np.pi
    if kind == 0:
        return lambda x: p[0] * np.sin(p[0] * x[0]) * np.cos(p[0] * x[0])
    if kind == 1:
        return lambda x: np.cos(tau * p[d] + p[:d] @ x)
    if kind == 2:
        return lambda x: 1 / np.prod(a**-2 + (x - u) ** 2, axis=0)
    if kind == 4:
        return lambda x: np.exp(-(p[:d] ** 2 @ (x - u) ** 2))
    if kind == 5:
        return lambda x: np.exp(-(p[:d] @ np.abs(x - u)))
    if kind == 7:
        peaks = p[1:].reshape(-1, 3)

        def normals(x):
            y = 0
            for w, c, s in peaks:
                r2 = np.sum((x - c) ** 2, axis=0)
                y = y + w * (tau * s * s) ** (-d / 2) * np.exp(r2 / (-2 * s * s))
            return y

        return normals
    if kind == 9:
        s, r, x1, y1, x2, y2 = p
        factor = 1 / (tau * s * s * np.pi * r * r)

        def lobe_and_disk(x):
            lit = (x[0] - x2) ** 2 + (x[1] - y2) ** 2 < r * r
            return factor * np.exp(((x[0] - x1) ** 2 + (x[1] - y1) ** 2) / (-2 * s * s)) * lit

        return lobe_and_disk
    raise ValueError(f"no integrand of kind {kind}")
