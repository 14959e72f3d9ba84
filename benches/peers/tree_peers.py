"""Forward dynamics of the tree that the bench `tree_peers` wrote: prints seconds a state, then accelerations.

python3 tree_peers.py FOLDER PEER

Building the model is not timed. The clock counts what the process had of a processor, over many
states in one call: Pinocchio's `abaInParallel` on one thread, and for MuJoCo, whose Python has no such
call, a loop in C over its own `mj_forward`. The accelerations are those of the first states.
"""

import ctypes
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

GRAVITY = [0.0, 0.0, -9.81]
COMPARED = 5
REPEATS = 5

LOOP = """
typedef void (*forward)(const void *, void *);
void many(forward f, const void *model, void *data, int n) { for (int i = 0; i < n; i++) f(model, data); }
"""


def bodies(folder):
    """Of each body: parent, axis, joint on the parent and on itself from the centres, mass, moments."""
    for row in np.fromfile(folder / "tree").reshape(-1, 14):
        yield int(row[0]), row[1:4], row[4:7], row[7:10], row[10], row[11:14]


def states(folder, hinges):
    both = np.fromfile(folder / "states").reshape(-1, 2, hinges)
    return both[:, 0].T, both[:, 1].T


def timed(run):
    start = time.process_time()
    value = run()
    return time.process_time() - start, value


def pinocchio(folder):
    import pinocchio as pin

    model = pin.Model()
    model.gravity.linear = np.array(GRAVITY)
    joints, owns = [], []
    for parent, axis, foot, own, mass, moments in bodies(folder):
        # Frames stand in the joints, ours in the centres.
        place = foot if parent < 0 else foot - owns[parent]
        joint = model.addJoint(
            0 if parent < 0 else joints[parent],
            pin.JointModelRevoluteUnaligned(axis),
            pin.SE3(np.eye(3), place),
            f"joint {len(joints)}",
        )
        model.appendBodyToJoint(joint, pin.Inertia(mass, -own, np.diag(moments)), pin.SE3.Identity())
        joints.append(joint)
        owns.append(own)
    q, v = (np.asfortranarray(x) for x in states(folder, model.nv))
    tau = np.zeros_like(v)
    pool = pin.ModelPool(model, 1)
    # Joints are numbered branch by branch there.
    order = [model.joints[joint].idx_v for joint in joints]
    inverse = np.argsort(order)
    q, v = np.asfortranarray(q[inverse]), np.asfortranarray(v[inverse])
    runs = [timed(lambda: pin.abaInParallel(1, pool, q, v, tau)) for _ in range(REPEATS)]
    return min(seconds for seconds, _ in runs) / q.shape[1], runs[0][1][order, :COMPARED].T


def mujoco(folder):
    import mujoco as mj

    spec = mj.MjSpec()
    spec.option.gravity = GRAVITY
    spec.option.disableflags |= mj.mjtDisableBit.mjDSBL_CONTACT
    spec.compiler.boundmass = 0
    made, owns = [], []
    for parent, axis, foot, own, mass, moments in bodies(folder):
        above = spec.worldbody if parent < 0 else made[parent]
        body = above.add_body(pos=foot if parent < 0 else foot - owns[parent])
        body.mass, body.ipos, body.inertia = mass, -own, moments
        body.explicitinertial = True
        body.add_joint(type=mj.mjtJoint.mjJNT_HINGE, axis=axis, name=f"joint {len(made)}")
        made.append(body)
        owns.append(own)
    model = spec.compile()
    data = mj.MjData(model)
    order = [model.joint(f"joint {k}").dofadr[0] for k in range(len(made))]
    q, v = states(folder, len(made))
    found = []
    for k in range(COMPARED):
        data.qpos[order], data.qvel[order] = q[:, k], v[:, k]
        mj.mj_forward(model, data)
        found.append(data.qacc[order].copy())
    (folder / "loop.c").write_text(LOOP)
    loop = folder / "loop.so"
    subprocess.run(["cc", "-O2", "-shared", "-fPIC", "-o", loop, folder / "loop.c"], check=True)
    many = ctypes.CDLL(str(loop)).many
    library = next(Path(mj.__file__).parent.glob("libmujoco.so*"))
    forward = ctypes.cast(ctypes.CDLL(str(library)).mj_forward, ctypes.c_void_p)
    arguments = forward, ctypes.c_void_p(model._address), ctypes.c_void_p(data._address), q.shape[1]
    seconds = min(timed(lambda: many(*arguments))[0] for _ in range(REPEATS))
    return seconds / q.shape[1], np.array(found)


def main():
    folder, peer = Path(sys.argv[1]), sys.argv[2]
    seconds, accelerations = {"pinocchio": pinocchio, "mujoco": mujoco}[peer](folder)
    print(repr(float(seconds)), *(repr(float(a)) for a in accelerations.flatten()))


main()
