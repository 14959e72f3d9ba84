"""A tower of boxes in MuJoCo: python3 tower.py STEPS STEP x,y x,y ...

Prints the processor time of all steps but the last, s; then poses and velocities before the last step,
and velocities after it. Solver, cone and iterations are MuJoCo's defaults; boxes have the mass, friction
and size of the others' boxes.
"""

import sys
import time

import mujoco

steps, step = int(sys.argv[1]), float(sys.argv[2])
bodies = []
for height, offset in enumerate(sys.argv[3:]):
    x, y = offset.split(",")
    bodies.append(
        f'<body pos="{x} {y} {height + 0.5}"><freejoint/>'
        '<geom type="box" size="0.5 0.5 0.5" mass="1" friction="0.5"/></body>'
    )
model = mujoco.MjModel.from_xml_string(
    f'<mujoco><option timestep="{step}" gravity="0 0 -9.81"/><size memory="200M"/><worldbody>'
    '<geom type="plane" size="1000 1000 1" friction="0.5"/>'
    + "".join(bodies)
    + "</worldbody></mujoco>"
)
data = mujoco.MjData(model)
start = time.process_time()
mujoco.mj_step(model, data, nstep=steps - 1)
print(time.process_time() - start)
print(*data.qpos)
print(*data.qvel)
mujoco.mj_step(model, data)
print(*data.qvel)
