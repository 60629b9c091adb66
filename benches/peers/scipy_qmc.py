"""scipy's qmc_quad with its scrambled Sobol' points; the integrand in numpy, as its users write it.

pip: scipy numpy
"""

import sys
import time

import scipy
from integrand import read, vectorised
from scipy.integrate import qmc_quad
from scipy.stats import qmc

REPLICATES = 8  # qmc_quad's default
suite, seeds, evaluations = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
# The largest power of two, as the points want it.
points = 2 ** (evaluations.bit_length() - 1) // REPLICATES
print("# scipy", scipy.__version__)
for name, kind, d, p in read(suite):
    f = vectorised(kind, d, p)
    for seed in range(1, seeds + 1):
        start = time.perf_counter()
        engine = qmc.Sobol(d, seed=seed)
        result = qmc_quad(f, [0] * d, [1] * d, n_estimates=REPLICATES, n_points=points, qrng=engine)
        seconds = time.perf_counter() - start
        value, error = float(result.integral), float(result.standard_error)
        used = REPLICATES * points
        print(f"{name},scipy qmc_quad,{seed},{value!r},{error!r},{used},{seconds:.9f}")
