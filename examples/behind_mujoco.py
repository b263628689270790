#!/usr/bin/python3
"""The controller of a scene in MuJoCo: an arm with masses under position servos runs into a post that
gives way like a spring, and yields.

usage: behind_mujoco.py [SCENE.yaml] [--duration S] [--stiffness N/M]

Any other engine takes MuJoCo's place as the class Mujoco does: positions and what presses on the tactile
module in, joint velocities out. Ends with 4 where MuJoCo is not installed, 3 after a fault."""

import argparse
import pathlib
import sys

import numpy as np

import tactus

CONFIG = pathlib.Path(__file__).resolve().parents[1] / "config"
SCENES = CONFIG / "scenes" if CONFIG.is_dir() else pathlib.Path("/usr/share/tactus/scenes")
SCENE = SCENES / "scenario1_tactus.yaml"
NO_MUJOCO = 4
POST_RADIUS_M = 0.005
POST_KG, POST_RATIO = 0.5, 1.0  # with its spring critically damped
SERVO_HZ, SERVO_RATIO = 10.0, 1.0


class Mujoco:
    """The arm of a scene's URDF with one tactile module, and a post at (x, y), m."""

    def __init__(self, scene, post_xy, stiffness_N_per_m):
        import mujoco

        self.mujoco = mujoco
        radius_m, length_m = (scene.numbers[f"tactile_module.{name}"]
                              for name in ("cover_radius_m", "length_m"))
        urdf = next(path for path in scene.files if path.endswith(".urdf"))
        spec = mujoco.MjSpec.from_file(urdf)
        spec.option.timestep = scene.period_s / 2
        spec.option.gravity = [0, 0, 0]  # as of an arm that bears its weight
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        for geom in spec.geoms:
            geom.contype = geom.conaffinity = 0
        self.link = scene.modules[0]
        spec.body(self.link).add_geom(
            name="cover", type=mujoco.mjtGeom.mjGEOM_CAPSULE, size=[radius_m, 0, 0],
            fromto=[0, 0, 0, length_m, 0, 0], mass=0, condim=1, contype=1, conaffinity=2)
        post = spec.worldbody.add_body(name="post", pos=[*post_xy, 0])
        for axis in ([1, 0, 0], [0, 1, 0]):
            post.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis, stiffness=stiffness_N_per_m,
                           damping=2 * POST_RATIO * np.sqrt(POST_KG * stiffness_N_per_m))
        post.add_geom(type=mujoco.mjtGeom.mjGEOM_CAPSULE, size=[POST_RADIUS_M, 0, 0],
                      fromto=[0, 0, -2, 0, 0, 2], mass=POST_KG, condim=1, contype=2, conaffinity=1)
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        joints = [self.model.joint(name) for name in scene.joints]
        self.q_at = [joint.qposadr[0] for joint in joints]
        self.v_at = [joint.dofadr[0] for joint in joints]
        self.q_set = scene.q_start.copy()
        self.data.qpos[self.q_at] = self.q_set
        mujoco.mj_forward(self.model, self.data)

    def positions(self):
        return self.data.qpos[self.q_at].copy()

    def tactile(self, module_poses):
        """F_y, F_z, M_y, M_z of what presses on the cover, in the module's frame."""
        force, moment = np.zeros(3), np.zeros(3)
        pose = module_poses[0]
        cover = self.model.geom("cover").id
        for number, contact in enumerate(self.data.contact):
            wrench = np.zeros(6)
            self.mujoco.mj_contactForce(self.model, self.data, number, wrench)
            sign = 1 if contact.geom2 == cover else -1  # the force is that on the second one
            on_cover = pose[:3, :3].T @ (sign * contact.frame.reshape(3, 3).T @ wrench[:3])
            force += on_cover
            moment += np.cross(pose[:3, :3].T @ (contact.pos - pose[:3, 3]), on_cover)
        return [[force[1], force[2], moment[1], moment[2]]]

    def step(self, dq, period_s):
        """Servos of all joints, by the masses that they move, follow the integrated command."""
        steps = round(period_s / self.model.opt.timestep)
        wanted, torques = np.zeros(self.model.nv), np.zeros(self.model.nv)
        w = 2 * np.pi * SERVO_HZ
        for _ in range(steps):
            self.q_set += dq * period_s / steps
            wanted[self.v_at] = (w**2 * (self.q_set - self.positions())
                                 + 2 * SERVO_RATIO * w * (dq - self.data.qvel[self.v_at]))
            self.mujoco.mj_mulM(self.model, self.data, torques, wanted)
            self.data.qfrc_applied[self.v_at] = torques[self.v_at]
            self.mujoco.mj_step(self.model, self.data)


def run(scene, world, duration_s):
    """The loop of any engine. Returns the log's fields of each cycle as arrays, and the controller."""
    controller = tactus.Controller(scene, world.positions())
    cycles = []
    for _ in range(round(duration_s / scene.period_s)):
        q = world.positions()
        dq = controller.update(q, world.tactile(controller.module_poses(q)))
        world.step(dq, scene.period_s)
        cycles.append(controller.record())
    return {field: np.array([cycle[field] for cycle in cycles]) for field in cycles[0]}, controller


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", nargs="?", default=SCENE)
    parser.add_argument("--duration", type=float, default=9.0, help="s")
    parser.add_argument("--stiffness", type=float, default=1000.0, help="of the post, N/m")
    arguments = parser.parse_args()
    try:
        scene = tactus.Scene(arguments.scene)
        if len(scene.modules) != 1:
            print(f"{arguments.scene}: {len(scene.modules)} tactile modules, expected one", file=sys.stderr)
            return 1
        world = Mujoco(scene, (0.70771, 0.00265), arguments.stiffness)
    except ModuleNotFoundError as error:
        print(f"{error}; install MuJoCo: pip install mujoco", file=sys.stderr)
        return NO_MUJOCO
    except tactus.ConfigError as error:
        print(error, file=sys.stderr)
        return 1
    fields, controller = run(scene, world, arguments.duration)
    force = fields["force_sensor_N"]
    error_m = np.linalg.norm([fields[f"tool_error_{axis}_m"] for axis in "xyz"], axis=0)
    touch = f"touched at {fields['t_s'][np.argmax(force > 0.1)]:.2f} s" if force.max() > 0.1 else "no touch"
    print(f"{touch}, force {force.max():.2f} N at most, {force[-1]:.2f} N at the end; "
          f"tool {1e3 * error_m.max():.1f} mm off its path at most; {controller.fault or 'completed'}")
    return 3 if controller.fault else 0


if __name__ == "__main__":
    sys.exit(main())
