"""One task of one peer, on what the bench `python_peers` wrote: prints seconds and an answer.

python3 sparse_peers.py FOLDER TASK PEER

Reading the files and turning them into the peer's own format is not timed. The clock counts what the
process had of a processor. Each peer is given what suits it: PARDISO the triangle of a definite
matrix and no refinement, CHOLMOD its own choice of order and method, both all right-hand sides at
once.
"""

import sys
import time
from pathlib import Path

import numpy as np
import scipy.sparse as sparse

MODES = 20
FUNCTIONS = 100
STEP = 1e-3


def lower_triangle(folder, name):
    """The stored triangle of a symmetric matrix."""
    starts = np.fromfile(folder / f"{name}.starts", dtype=np.uint32).astype(np.int32)
    rows = np.fromfile(folder / f"{name}.rows", dtype=np.uint32).astype(np.int32)
    values = np.fromfile(folder / f"{name}.values", dtype=np.float64)
    n = len(starts) - 1
    return sparse.csc_matrix((values, rows, starts), shape=(n, n))


def whole(triangle):
    """Both triangles."""
    return (triangle + sparse.tril(triangle, -1).T).tocsc()


class Cholmod:
    def __init__(self, triangle):
        from sksparse.cholmod import cholesky

        # CHOLMOD reads one triangle of a symmetric matrix.
        self.factor = cholesky(triangle)

    def solve(self, b):
        return self.factor(b)


class Pardiso:
    """Positive definite, nested dissection, no iterative refinement."""

    def __init__(self, triangle):
        from pypardiso import PyPardisoSolver

        # Columns of the lower triangle are rows of the upper one.
        self.rows = sparse.csr_matrix(
            (triangle.data, triangle.indices, triangle.indptr), shape=triangle.shape
        )
        self.solver = PyPardisoSolver(mtype=2)
        for place, value in [(1, 1), (2, 2), (8, 0)]:
            self.solver.set_iparm(place, value)
        self.solver.set_phase(12)
        self.solver._call_pardiso(self.rows, np.zeros((triangle.shape[0], 1)))

    def solve(self, b):
        self.solver.set_phase(33)
        return self.solver._call_pardiso(self.rows, np.asfortranarray(b))


class SuperLu:
    def __init__(self, triangle):
        from scipy.sparse.linalg import splu

        self.factor = splu(
            whole(triangle),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )

    def solve(self, b):
        return self.factor.solve(b)


FACTORS = {"cholmod": Cholmod, "pardiso": Pardiso, "superlu": SuperLu}


def modes(folder, peer):
    from scipy.sparse.linalg import LinearOperator, eigsh

    stiffness, mass = lower_triangle(folder, "stiffness"), whole(lower_triangle(folder, "mass"))
    start = time.process_time()
    factor = FACTORS[peer](stiffness)
    inverse = LinearOperator(stiffness.shape, matvec=lambda b: factor.solve(b).ravel())
    values = eigsh(stiffness, k=MODES, M=mass, sigma=0.0, OPinv=inverse, return_eigenvectors=True)[0]
    return time.process_time() - start, values.max()


def heat(folder, peer):
    weights = lower_triangle(folder, "weights")
    areas = sparse.diags(np.fromfile(folder / "areas", dtype=np.float64)).tocsc()
    n = weights.shape[0]
    b = np.zeros((n, FUNCTIONS), order="F")
    b[np.arange(FUNCTIONS), np.arange(FUNCTIONS)] = areas.diagonal()[:FUNCTIONS]
    start = time.process_time()
    factor = FACTORS[peer]((areas + STEP * weights).tocsc())
    u = factor.solve(b)
    return time.process_time() - start, u[0, 0]


def assembly(folder, _):
    import igl

    vertices = np.fromfile(folder / "mesh.vertices", dtype=np.float64).reshape(-1, 3)
    triangles = np.fromfile(folder / "mesh.triangles", dtype=np.int64).reshape(-1, 3)
    start = time.process_time()
    weights = igl.cotmatrix(vertices, triangles)
    mass = igl.massmatrix(vertices, triangles, igl.MASSMATRIX_TYPE_BARYCENTRIC)
    seconds = time.process_time() - start
    return seconds, -weights[0, 0] + mass[0, 0]


# libigl has no refill: it builds anew.
TASKS = {"modes": modes, "heat": heat, "assembly": assembly, "refill": assembly}


if __name__ == "__main__":
    where, task, peer = sys.argv[1:4]
    seconds, answer = TASKS[task](Path(where), peer)
    print(repr(float(seconds)), repr(float(answer)))
