"""A scene of bodies in contact by drake's error-controlled steps: python3 cenic.py FILE ACCURACY...

The file has a line each for

    gravity x y z
    duration SECONDS MOMENTS
    floor friction nx ny nz
    body mass Ix Iy Iz KIND a b c friction qw qx qy qz      the shape and how it is turned on the body
    at x y z qw qx qy qz vx vy vz wx wy wz                  how the body before starts, in axes of space

A box has half sizes, a cylinder its half length and radius, an ellipsoid half axes. Each accuracy prints a line:
seconds of the processor, steps, and the pose of each body (x y z qw qx qy qz) at each moment, or `failed` and why.
"""

import sys
import time

import numpy as np
from pydrake.geometry import (
    AddCompliantHydroelasticProperties,
    AddCompliantHydroelasticPropertiesForHalfSpace,
    AddContactMaterial,
    Box,
    Cylinder,
    Ellipsoid,
    HalfSpace,
    ProximityProperties,
)
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction
from pydrake.multibody.tree import SpatialInertia, UnitInertia
from pydrake.common.eigen_geometry import Quaternion
from pydrake.multibody.math import SpatialVelocity
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, SimulatorConfig
from pydrake.systems.framework import DiagramBuilder

# Pa: bodies of the weight and size of these sink into each other by some millionths of their size.
STIFFNESS = 1e8


def proximity(friction):
    made = ProximityProperties()
    coulomb = CoulombFriction(friction, friction)
    AddContactMaterial(dissipation=10.0, friction=coulomb, properties=made)
    return made


def run(lines, accuracy):
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
    plant.set_name("plant")
    bodies = []
    for words in lines:
        kind, numbers = words[0], words[1:]
        if kind == "gravity":
            plant.mutable_gravity_field().set_gravity_vector([float(w) for w in numbers])
        elif kind == "duration":
            duration, moments = float(numbers[0]), int(numbers[1])
        elif kind == "floor":
            friction, normal = float(numbers[0]), np.array([float(w) for w in numbers[1:]])
            made = proximity(friction)
            AddCompliantHydroelasticPropertiesForHalfSpace(0.1, STIFFNESS, made)
            pose = HalfSpace.MakePose(normal, [0, 0, 0])
            plant.RegisterCollisionGeometry(plant.world_body(), pose, HalfSpace(), f"floor{len(bodies)}", made)
        elif kind == "body":
            mass, ix, iy, iz = map(float, numbers[:4])
            a, b, c, friction = map(float, numbers[5:9])
            turn = Quaternion(np.array([float(w) for w in numbers[9:13]]))
            inertia = SpatialInertia(mass, [0, 0, 0], UnitInertia(ix / mass, iy / mass, iz / mass))
            name = f"b{len(bodies)}"
            body = plant.AddRigidBody(name, inertia)
            shape = {
                "box": lambda: Box(2 * a, 2 * b, 2 * c),
                "cylinder": lambda: Cylinder(b, 2 * a),
                "ellipsoid": lambda: Ellipsoid(a, b, c),
            }[numbers[4]]()
            made = proximity(friction)
            AddCompliantHydroelasticProperties(0.2 * max(a, b, c), STIFFNESS, made)
            place = RigidTransform(RotationMatrix(turn), [0, 0, 0])
            plant.RegisterCollisionGeometry(body, place, shape, name, made)
            bodies.append([body])
        elif kind == "at":
            bodies[-1].append(np.array([float(w) for w in numbers]))
    plant.Finalize()
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    inner = plant.GetMyMutableContextFromRoot(context)
    for body, at in bodies:
        pose = RigidTransform(Quaternion(at[3:7] / np.linalg.norm(at[3:7])), at[:3])
        plant.SetFreeBodyPose(inner, body, pose)
        plant.SetFreeBodySpatialVelocity(inner, body, SpatialVelocity(w=at[10:13], v=at[7:10]))
    simulator = Simulator(diagram, context)
    config = SimulatorConfig(integration_scheme="cenic", accuracy=accuracy, max_step_size=0.1)
    ApplySimulatorConfig(config, simulator)
    integrator = simulator.get_integrator()
    simulator.Initialize()
    places = []
    start = time.process_time()
    for k in range(1, moments + 1):
        simulator.AdvanceTo(duration * k / moments)
        for body, _ in bodies:
            pose = plant.EvalBodyPoseInWorld(inner, body)
            places.extend(pose.translation())
            places.extend(pose.rotation().ToQuaternion().wxyz())
    took = time.process_time() - start
    return took, integrator.get_num_steps_taken(), places


def main():
    with open(sys.argv[1]) as file:
        lines = [line.split() for line in file if line.strip()]
    for accuracy in sys.argv[2:]:
        try:
            took, steps, places = run(lines, float(accuracy))
            print(took, steps, *(repr(float(x)) for x in places), flush=True)
        except Exception as error:
            print("failed", str(error).split("\n")[0], flush=True)


main()
