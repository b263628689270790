"""The reference robot as it is, but with times that a machine without real time can keep."""
import json
import pathlib

import yaml

REPOSITORY = pathlib.Path(__file__).resolve().parents[3]
ROBOT = REPOSITORY / "config/robots/crops9/robot.yaml"
SCENE = REPOSITORY / "config/scenes/scenario1_null_space.yaml"  # with tactile module
PERIOD_S = 0.02  # the longest there is
SLOW_BUS = {
    "heartbeat_period_s": 0.1,
    "heartbeat_timeout_s": 10,
    "sdo_timeout_s": 2,
    "boot_timeout_s": 30,
}


def with_numbers(value):
    """PyYAML takes 1e7 for text."""
    if isinstance(value, dict):
        return {key: with_numbers(item) for key, item in value.items()}
    if isinstance(value, list):
        return [with_numbers(item) for item in value]
    try:
        return float(value) if isinstance(value, str) else value
    except ValueError:
        return value


class SlowScene:
    def __init__(self, folder):
        robot = with_numbers(yaml.safe_load(ROBOT.read_text()))
        robot["urdf"] = str(ROBOT.parent / robot["urdf"])
        robot["can"] |= SLOW_BUS
        robot["real_time"] |= {"priority": 40, "max_late_cycles": 1000}  # see run_peers
        robot["tactile_module"] |= {"sample_period_s": 0.02, "max_sample_age_s": 1}  # see tactile.py
        self.home = robot["home"]
        self.drives = robot["drives"]["joints"]  # in the order of the joints
        scene = {
            "extends": str(SCENE),
            "robot": "robot.yaml",
            "period_s": PERIOD_S,
            "real_time": {"required": False},
        }
        folder.mkdir(parents=True, exist_ok=True)
        self.path = folder / "slow.yaml"
        self.path.write_text(json.dumps(scene))
        (folder / "robot.yaml").write_text(json.dumps(robot))

    def counts_per_unit(self, joint):
        drive = self.drives[joint]
        return drive.get("counts_per_m", drive.get("counts_per_rad")) * drive.get("sign", 1)

    def counts(self, joint, q):
        drive = self.drives[joint]
        offset = drive.get("offset_m", drive.get("offset_rad", 0))
        return self.counts_per_unit(joint) * (q - offset)

    def initial_positions(self):
        """Arguments of drives.py: the arm stands at home."""
        return [
            f"{drive['interface']}:{drive['node_id']}={round(self.counts(joint, q))}"
            for joint, (drive, q) in enumerate(zip(self.drives, self.home))
        ]
