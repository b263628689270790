"""The report of an arm with several modules, of real logs: kinematics against the tool that the log has,
forces, contacts and pictures against what the run says.

usage: skin_report_test.py FOLDER TACTUS, where FOLDER has the package tactus as built"""

import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = ROOT / "config/scenes"
sys.path[:0] = [sys.argv.pop(1), str(ROOT / "tools")]
sys.dont_write_bytecode = True

import tactus  # noqa: E402
from tactus_report import arm, contacts, errors, kinematics, page, runs, skin_figures  # noqa: E402

SKIN = "crops9_skin_in_turn"


def simulate(folder, scene, *settings):
    subprocess.run([TACTUS, "simulate", SCENES / f"{scene}.yaml", "-o", folder,
                    *(word for setting in settings for word in ("--set", setting))],
                   check=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # fmt: skip
    return pathlib.Path(folder) / pathlib.Path(scene).name


def table(run):
    """The columns of a run's CSV."""
    csv = run / "run.csv"
    subprocess.run([TACTUS, "export", run / "run.ulg", "-o", csv], check=True)
    with open(csv, encoding="utf-8") as lines:
        names = lines.readline().strip().split(",")
        wanted = [i for i, name in enumerate(names) if not name.endswith("_name")]
        values = np.loadtxt(lines, delimiter=",", usecols=wanted)
    return {names[i]: column for i, column in zip(wanted, values.T)}


class Kinematics(unittest.TestCase):
    def agrees(self, scene, *settings):
        with tempfile.TemporaryDirectory() as folder:
            run = simulate(folder, scene, "simulation.duration_s=3", *settings)
            log = tactus.read_log(run / "run.ulg")
            column = table(run)
        chain = kinematics.read_chain(arm.urdf_of(log), arm.tip_of(log))
        self.assertEqual(chain.moving(), log.joints)
        q = np.column_stack([column[f"q_{i + 1}"] for i in range(len(log.joints))])
        w = np.column_stack([column[f"w_{i + 1}"] for i in range(3)])
        self.assertGreater(np.ptp(w, axis=0).max(), 0.01, "the tool does not move")
        for cycle in range(0, len(q), 97):
            np.testing.assert_allclose(chain.way(q[cycle])[-1], w[cycle], atol=1e-12)

    def test_of_robots_is_that_of_the_log(self):
        for scene in ("free_motion", "robots/ur5e_free", "robots/kuka_iiwa7_free"):
            with self.subTest(scene):
                self.agrees(scene)

    def test_of_another_tip(self):
        self.agrees("free_motion", "robot.tip=link9")

    def test_of_links_that_are_fixed_beside_the_way(self):
        """Modules may sit on them."""
        urdf = (ROOT / "config/robots/planar3_skin/planar3.urdf").read_text(encoding="utf-8")
        chain = kinematics.read_chain(urdf, "tip")
        q = np.array([0.3, -0.5, 0.8])
        poses = chain.poses(q)
        along = poses["link2c"][:3, 3] - poses["link2"][:3, 3]
        np.testing.assert_allclose(along, poses["link2"][:3, :3] @ [0.222, 0, 0], atol=1e-12)
        self.assertEqual(len(chain.way(q)), len(chain.joints))

    def test_refuses_a_urdf_without_a_way(self):
        for urdf in ("<robot", "<robot/>", '<robot><link name="a"/></robot>', "<robot>\udcff</robot>"):
            with self.assertRaises(ValueError):
                kinematics.read_chain(urdf, "tcp")

    def test_reads_a_urdf_in_the_encoding_that_it_names(self):
        urdf = (ROOT / "config/robots/planar3_skin/planar3.urdf").read_text(encoding="utf-8")
        text = re.sub(r"<\?xml.*?\?>", "", urdf).strip()
        latin = f'<?xml version="1.0" encoding="ISO-8859-1"?><!-- \u00e9 -->{text}'.encode("latin-1")
        chain = kinematics.read_chain(latin.decode("utf-8", "surrogateescape"), "tip")
        self.assertEqual(chain.moving(), kinematics.read_chain(urdf, "tip").moving())


class Damaged(unittest.TestCase):
    """Logs of several modules, in what stands before the cycles."""

    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.log = simulate(cls.folder, f"whole_arm/{SKIN}", "simulation.duration_s=0.01") / "run.ulg"
        cls.whole = cls.log.read_bytes()

    def load(self, content):
        """What is wrong; None: nothing."""
        self.log.write_bytes(content)
        try:
            return runs.load_runs([self.folder]) and None
        except errors.InputError as error:
            return str(error)

    def test_are_refused_where_they_are_cut_off(self):
        self.assertIsNone(self.load(self.whole))
        for size in (0, 5, 16, 17, 300, 5000):
            said = self.load(self.whole[:size])
            self.assertRegex(said or "", r"^/.*/run\.ulg:1:\d+: \S.*, .*expected[^\n]*$")

    def test_give_one_line_or_no_picture(self):
        generator = np.random.default_rng(1)
        end = self.whole.index(b"\0cycle")
        self.assertGreater(end, 10000)
        refused = 0
        for place in generator.integers(16, end, 400):
            content = bytearray(self.whole)
            content[place] ^= 1 << generator.integers(8)
            said = self.load(bytes(content))
            self.assertNotIn("\n", said or "")
            refused += said is not None
        self.assertGreater(refused, 10)


class Skin(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.path = simulate(cls.folder.name, f"whole_arm/{SKIN}", "controller.variant=none")
        simulate(cls.folder.name, "scenario1_null_space", "simulation.duration_s=1")
        cls.runs = runs.load_runs([pathlib.Path(cls.folder.name)])
        cls.run_of_skin = next(run for run in cls.runs if run.name == SKIN)
        cls.page = page.build_page(cls.runs)

    def test_has_the_force_of_each_module(self):
        run, column = self.run_of_skin, table(self.path)
        self.assertEqual(run.modules, ["link3", "link4", "link6"])
        for force_N, name in zip(run.forces_N, ("force_sensor_N", "force_sensor_N_2", "force_sensor_N_3")):
            np.testing.assert_array_equal(force_N, column[name])
            self.assertGreater(force_N.max(), 1.0, name)
        np.testing.assert_array_equal(run.force_N, np.max(run.forces_N, axis=0))
        self.assertAlmostEqual(run.force_N.max(), run.summary["peak_force_N"], places=6)

    def test_lists_the_contacts_with_their_links(self):
        rows = [row for row in contacts.rows(self.runs) if row[0] == SKIN]
        self.assertEqual([row[1] for row in rows],
                         [contact["tactile_module"] for contact in self.run_of_skin.summary["contacts"]])
        self.assertEqual({row[1] for row in rows}, {"link3", "link4", "link6"})
        self.assertIn("<h2>Contacts</h2>", self.page)

    def test_draws_moments_of_touch_well_formed(self):
        found = skin_figures.moments(self.run_of_skin)
        self.assertGreaterEqual(len(found), 1)
        for number, (cycle, link) in enumerate(found):
            self.assertGreater(self.run_of_skin.forces_N[self.run_of_skin.modules.index(link)][cycle], 0.0)
            self.assertIn(f'id="skin-0-arm-{number}"', self.page)
        for svg in re.findall(r"<svg.*?</svg>", self.page, flags=re.DOTALL):
            xml.etree.ElementTree.fromstring(svg)
        self.assertNotIn('id="skin-1', self.page, "the other run has one module")

    def test_arrows_come_from_the_posts(self):
        """Without friction a push leads from a post's axis to that of the link."""
        run = self.run_of_skin
        chain, covers, obstacles = run.arm
        self.assertEqual(len(obstacles), 3)
        np.testing.assert_allclose(obstacles[1].start, [0.68, 0.08, 0.2], atol=1e-6)
        np.testing.assert_allclose(obstacles[1].end, [0.68, 0.08, 0.9], atol=1e-6)
        pushed = 0
        for force_N, post in zip((2, 1, 0), obstacles):
            cycle = int(np.flatnonzero(run.forces_N[force_N] > 3.0)[0])
            one = {cover.link: arrow for cover, arrow in zip(
                [c for c, f in zip(covers, run.forces_N) if f[cycle] > 0.0],
                skin_figures.arrows(chain, covers, run, cycle))}
            point, force = one[run.modules[force_N]]
            self.assertAlmostEqual(np.linalg.norm(force), run.forces_N[force_N][cycle], places=9)
            to_axis = post.start - point
            to_axis[2] = 0.0
            self.assertLess(np.linalg.norm(to_axis), 0.06, "where the post is")
            self.assertLess(to_axis[1] * force[1], 0.0, "pushed away from it")
            pushed += 1
        self.assertEqual(pushed, 3)


if __name__ == "__main__":
    TACTUS = sys.argv.pop(1)
    unittest.main()
