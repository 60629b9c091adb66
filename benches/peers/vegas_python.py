"""vegas 6 with an integrand in C, called for a whole batch of points.

pip: vegas numpy
"""

import ctypes
import os
import sys
import time

import gvar
import numpy as np
import vegas
from integrand import read

HALVES = [5, 10]  # iterations that adapt, and as many that make the result
MOST_NUMBERS = 64


class Integrand(ctypes.Structure):
    """struct integrand of integrand.h."""

    _fields_ = [
        ("name", ctypes.c_char * 64),
        ("kind", ctypes.c_int),
        ("d", ctypes.c_size_t),
        ("p", ctypes.c_double * MOST_NUMBERS),
        ("c", ctypes.c_double * MOST_NUMBERS),
    ]


library = ctypes.CDLL(os.path.join(os.environ["PEERS_BUILD"], "libintegrand.so"))
pointer = ctypes.c_void_p
library.integrand_prepare.argtypes = [pointer]
library.integrand_eval_batch.argtypes = [pointer, pointer, ctypes.c_size_t, pointer]

suite, seeds, evaluations = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
print("# vegas", vegas.__version__)
for name, kind, d, p in read(suite):
    g = Integrand(kind=kind, d=d)
    g.p[: len(p)] = p
    address = ctypes.addressof(g)
    library.integrand_prepare(address)

    @vegas.lbatchintegrand
    def f(x):
        x = np.ascontiguousarray(x)
        y = np.empty(len(x))
        library.integrand_eval_batch(address, x.ctypes.data, len(x), y.ctypes.data)
        return y

    for iterations in HALVES:
        for seed in range(1, seeds + 1):
            start = time.perf_counter()
            gvar.ranseed(seed)
            integrator = vegas.Integrator([[0, 1]] * d)
            settings = {"nitn": iterations, "neval": evaluations / (2 * iterations)}
            adaptation = integrator(f, **settings)
            result = integrator(f, **settings)
            seconds = time.perf_counter() - start
            used = round(adaptation.sum_neval + result.sum_neval)
            value, error = float(result.mean), float(result.sdev)
            method = f"vegas 6 {iterations}+{iterations}"
            print(f"{name},{method},{seed},{value!r},{error!r},{used},{seconds:.9f}")
