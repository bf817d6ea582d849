"""The contestants from Python, driven over standard input by ajar_bench: a problem, then "list", "run NAME STEPS", "report".

Every contestant sees the base as two joints ahead of the arm, at zero in each step, and the target in the base frame. Its cost: hand error 1 per m
and per rad, secondary wishes 1e-4 (cost 1e-2 squared). Only solve() is timed; u = (turning, driving, joint rates).
"""

import ctypes
import json
import sys
import time
import traceback
import xml.etree.ElementTree as xml

import numpy as np
import pinocchio as pin

COST = 1e-2
ENDLESS = 1e3  # range of the two joints of the base


def eight_joint_urdf(problem):
    """The robot's URDF without shapes, its base on a turning and a sliding joint, rate limits of the problem."""
    robot = xml.parse(problem["urdf"]).getroot()
    for link in robot.iter("link"):
        for tag in ("visual", "collision"):
            for shape in link.findall(tag):
                link.remove(shape)
    compiler = xml.SubElement(xml.SubElement(robot, "mujoco"), "compiler")
    compiler.attrib.update(fusestatic="false", strippath="false")
    limits = dict(zip(problem["joints"] + ["base_turn", "base_drive"], problem["limits"]))
    for joint in robot.iter("joint"):
        if joint.get("name") in limits:
            joint.find("limit").set("velocity", repr(limits[joint.get("name")]))
        elif joint.get("type") == "continuous":  # wheels
            joint.set("type", "fixed")
    for name, kind, parent, child, axis in (("base_turn", "revolute", "floor", "turned", "0 0 1"),
                                            ("base_drive", "prismatic", "turned", "base_link", "1 0 0")):
        link = xml.SubElement(robot, "link", name=parent)
        if parent != "floor":
            inertial = xml.SubElement(link, "inertial")
            xml.SubElement(inertial, "mass", value="1")
            xml.SubElement(inertial, "inertia", ixx="1", iyy="1", izz="1", ixy="0", ixz="0", iyz="0")
        joint = xml.SubElement(robot, "joint", name=name, type=kind)
        xml.SubElement(joint, "parent", link=parent)
        xml.SubElement(joint, "child", link=child)
        xml.SubElement(joint, "axis", xyz=axis)
        xml.SubElement(joint, "limit", lower=str(-ENDLESS), upper=str(ENDLESS), velocity=repr(limits[name]), effort="100")
    return xml.tostring(robot, encoding="unicode")


class Placo:
    def __init__(self, problem, urdf):
        import placo
        import tempfile

        with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
            file.write(urdf)
            file.flush()
            self.robot = placo.RobotWrapper(file.name, placo.Flags.ignore_collisions)
        self.names = ["base_turn", "base_drive"] + problem["joints"]
        self.solver = placo.KinematicsSolver(self.robot)
        self.solver.mask_fbase(True)
        self.solver.dt = problem["period"]
        self.solver.enable_joint_limits(True)
        self.solver.enable_velocity_limits(True)
        self.hand = self.solver.add_frame_task(problem["hand_frame"], np.eye(4))
        self.hand.configure("hand", "soft", 1.0, 1.0)
        self.posture = self.solver.add_joints_task()
        self.posture.configure("posture", "soft", COST**2)
        self.q = self.robot.state.q.copy()

    def solve(self, q, target, wish, dt):
        self.q[7:] = q
        self.robot.state.q = self.q
        self.robot.update_kinematics()
        self.hand.T_world_frame = target
        self.posture.set_joints(dict(zip(self.names, q + dt * wish)))
        return self.solver.solve(False)[6:] / dt


class Pink:
    def __init__(self, problem, urdf):
        import pink
        from pink.tasks import FrameTask, PostureTask

        model = pin.buildModelFromXML(urdf)
        self.solve_ik = pink.solve_ik
        self.configuration = pink.Configuration(model, model.createData(), np.zeros(8))
        self.hand = FrameTask(problem["hand_frame"], 1.0, 1.0)
        self.posture = PostureTask(cost=COST)

    def solve(self, q, target, wish, dt):
        self.configuration.update(q)
        self.hand.set_target(pin.SE3(target))
        self.posture.set_target(q + dt * wish)
        return self.solve_ik(self.configuration, (self.hand, self.posture), dt, solver="quadprog", safety_break=False)


class Mink:
    def __init__(self, problem, urdf):
        import mink
        import mujoco

        model = mujoco.MjModel.from_xml_string(urdf)
        names = ["base_turn", "base_drive"] + problem["joints"]
        self.mink = mink
        self.configuration = mink.Configuration(model)
        self.hand = mink.FrameTask(problem["hand_frame"], "body", 1.0, 1.0)
        self.posture = mink.PostureTask(model, cost=COST)
        rates = dict(zip(names, problem["limits"][6:] + problem["limits"][:6]))
        self.limits = [mink.ConfigurationLimit(model), mink.VelocityLimit(model, rates)]

    def solve(self, q, target, wish, dt):
        self.configuration.update(q)
        self.hand.set_target(self.mink.SE3.from_matrix(target))
        self.posture.set_target(q + dt * wish)
        return self.mink.solve_ik(self.configuration, (self.hand, self.posture), dt, "quadprog", limits=self.limits)


CONTESTANTS = {"placo": Placo, "pink": Pink, "mink": Mink}


def turn(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def pose(rotation, position):
    out = np.eye(4)
    out[:3, :3] = rotation
    out[:3, 3] = position
    return out


class Run:
    """The closed loop of one contestant, as the C++ side poses it to its own."""

    def __init__(self, name, problem, urdf):
        self.name, self.p = name, problem
        self.contestant = CONTESTANTS[name](problem, urdf)
        self.model = pin.buildModelFromXML(urdf)
        self.data = self.model.createData()
        self.frame = self.model.getFrameId(problem["hand_frame"])
        self.R0 = np.reshape(problem["start_rotation"], (3, 3))
        self.p0 = np.array(problem["start_position"])
        self.hinge = self.p0 - [0.0, problem["radius"], 0.0]
        self.q0 = np.array(problem["start_q"])
        self.limits = np.array(problem["limits"][6:] + problem["limits"][:6])
        self.hot, self.cold, self.allocations, self.steps = [], [], 0, 0
        self.path = self.rotation = self.limited = 0.0
        self.excess = -np.inf
        self.begin()

    def begin(self):
        self.k, self.base, self.q = 0, np.array(self.p["start_base"]), self.q0.copy()

    def angle(self, k):
        return -k * self.p["period"] * self.p["speed"] / self.p["radius"]

    def target(self, k):
        R = turn(self.angle(k))
        return pose(R @ self.R0, self.hinge + R @ (self.p0 - self.hinge))

    def wishes(self, k):
        p, base, heading = self.p, self.base, self.angle(k)
        error = (base[2] - heading + np.pi) % (2.0 * np.pi) - np.pi
        reach = self.target(k)[:2, 3] - base[:2]
        distance = np.hypot(*reach)
        bearing = np.cos(np.arctan2(reach[1], reach[0]) - base[2])
        approach = reach @ [np.cos(heading), np.sin(heading)] * p["speed"] / distance
        drive = (approach + p["distance"] * (distance - p["wanted"])) * bearing / (bearing**2 + p["sideways"])
        return np.r_[-p["speed"] / p["radius"] - p["heading"] * error, drive, p["posture"] * (self.q0 - self.q)]

    def turn(self, steps):
        dt = self.p["period"]
        for i in range(steps):
            if self.k >= self.p["steps"]:
                self.begin()
            base = pose(turn(self.base[2]), [self.base[0], self.base[1], 0.0])
            wanted = self.target(self.k + 1)
            local, wish, q8 = np.linalg.inv(base) @ wanted, self.wishes(self.k), np.r_[0.0, 0.0, self.q]
            before = heap_count()
            start = time.perf_counter_ns()
            u = self.contestant.solve(q8, local, wish, dt)
            us = 1e-3 * (time.perf_counter_ns() - start)
            self.allocations += heap_count() - before
            if i == 0:
                self.cold.append(us)
            elif i >= 5:
                self.hot.append(us)
            self.follow(u, wanted)

    def follow(self, u, wanted):
        dt = self.p["period"]
        self.k += 1
        self.steps += 1
        half = 0.5 * u[0] * dt
        chord = u[1] * dt * np.sinc(half / np.pi)
        self.base = self.base + [chord * np.cos(self.base[2] + half), chord * np.sin(self.base[2] + half), 2.0 * half]
        self.q = self.q + dt * u[2:]
        pin.framesForwardKinematics(self.model, self.data, np.r_[0.0, 0.0, self.q])
        hand = pose(turn(self.base[2]), [self.base[0], self.base[1], 0.0]) @ self.data.oMf[self.frame].homogeneous
        self.path = max(self.path, np.linalg.norm(wanted[:3, 3] - hand[:3, 3]))
        self.rotation = max(self.rotation, np.linalg.norm(pin.log3(wanted[:3, :3] @ hand[:3, :3].T)))
        over = (np.abs(u) - self.limits).max()
        self.excess = max(self.excess, over)
        self.limited += over > -1e-6

    def row(self):
        quantile = lambda share: float(np.quantile(self.hot, share)) if self.hot else None
        return {"contestant": self.name, "problem": self.p["name"], "median_us": quantile(0.5), "p99_us": quantile(0.99),
                "p999_us": quantile(0.999), "cold_us": float(np.median(self.cold)), "path_error_m": self.path,
                "rotation_error_rad": self.rotation, "limit_excess": max(self.excess, 0.0),
                "limited_share": self.limited / self.steps, "allocations": self.allocations / self.steps}


def main():
    problem = json.loads(sys.stdin.readline())
    urdf = eight_joint_urdf(problem)
    runs = {name: Run(name, problem, urdf) for name in CONTESTANTS}
    say = lambda text: print(text, file=answers, flush=True)
    say("ready")
    for line in sys.stdin:
        word, *rest = line.split()
        if word == "list":
            say(json.dumps(list(runs)))
        elif word == "run":
            runs[rest[0]].turn(int(rest[1]))
            say("done")
        else:
            say(json.dumps([run.row() for run in runs.values()]))


answers = sys.stdout
sys.stdout = sys.stderr  # libraries that print must not disturb the answers
heap_count = ctypes.CDLL(None).ajar_heap_count
heap_count.restype = ctypes.c_long
try:
    main()
except Exception as error:  # the other side prints one line
    traceback.print_exc()
    print("error:", repr(error)[:300], file=answers, flush=True)
