"""The Python module: shapes, round trips and refusals. Run by install_test.sh."""

import ctypes
import os
import tempfile
import unittest
import warnings
from pathlib import Path

import numpy as np

import osteon


def block():
    """A bone of 13 x 13 x 6 balls of 1 mm radius, its top at z = 1 mm."""
    xyz = np.stack(np.meshgrid(*[np.arange(-6, 7)] * 2, np.arange(-5, 1), indexing="ij"), -1).reshape(-1, 3)
    balls = np.column_stack([xyz, np.ones(len(xyz))])
    return osteon.Bone(balls_mm=balls, site=((0, 0, 0), (0, 0, 1), 0.003))


def above(z_mm):
    """A pose at this height in G."""
    X = np.eye(4)
    X[2, 3] = 1e-3 * z_mm
    return X


class Module(unittest.TestCase):
    def setUp(self):
        self.bone = block()
        self.tool = osteon.Tool(balls_mm=[[0, 0, 0, 3]])
        self.session = osteon.Session(self.bone, self.tool, lockstep=True)
        self.session.step(above(4.2))

    def feed(self, to_mm):
        for z in np.arange(4.2, to_mm, -0.005):
            self.session.step(above(z), 100.0, 0.001)

    def test_bone_tells_what_it_is(self):
        info = self.bone.info
        self.assertEqual(info["balls"], 13 * 13 * 6)
        self.assertEqual(info["materials"], ["cancellous"])
        self.assertGreater(info["volume_m3"], 1e-6)
        np.testing.assert_array_equal(info["colors"], [[224, 163, 128]])

    def test_log_gets_lines_until_it_is_removed(self):
        lines = []
        self.session.set_log(lambda level, text: lines.append((level, text)))
        self.session.change_tool(osteon.Tool(balls_mm=[[0, 0, 0, 2]]), above(4.2))
        self.assertEqual([level for level, _ in lines], ["info", "info"])
        self.assertIn("cpu", lines[0][1])
        self.session.set_log(None)
        self.session.change_tool(self.tool, above(4.2))
        self.assertEqual(len(lines), 2)

    def test_surface_changes_are_the_exported_mesh(self):
        self.feed(2.5)
        self.session.wait_for_surface()
        changed = self.session.surface_changes()
        triangles = sum(len(t) for _, _, t in changed)
        with tempfile.TemporaryDirectory() as folder:
            info = self.session.export_surface(folder + "/block.stl")
        self.assertEqual(info["triangles"], triangles)
        self.assertTrue(info["watertight"])
        self.assertEqual(self.session.surface_changes(), [])
        _, vertices, t = max(changed, key=lambda each: len(each[2]))
        self.assertLess(t.max(), len(vertices))
        np.testing.assert_allclose(np.linalg.norm(vertices["normal"], axis=1), 1, atol=1e-5)

    def test_wrench_pushes_out_and_is_limited(self):
        for z in np.arange(4.2, 1.0, -0.01):
            self.session.step(above(z))
            F = self.session.evaluate(above(z), np.zeros(6))
        self.assertEqual(F.shape, (6,))
        self.assertGreater(F[2], 10)
        self.assertLessEqual(np.linalg.norm(F[:3]), 200)

    def test_undo_restores_the_bone(self):
        self.session.mark()
        self.feed(2.5)
        self.assertGreater(self.session.figures["removed_volume_m3"], 0)
        with self.assertRaisesRegex(osteon.Error, "move the tool out"):
            self.session.undo(above(2.5))
        self.session.undo(above(4.2))
        self.assertEqual(self.session.figures["removed_volume_m3"], 0)

    def test_poses_keep_their_axes_there_and_back(self):
        for axis in np.eye(3).tolist() + [[0.6, 0, 0.8], [0, -1, 0]]:
            bone = osteon.Bone(balls_mm=[[0, 0, 0, 5]], site=((0.01, 0.02, 0.03), axis, 0.003))
            X = bone.approach(0.1)
            np.testing.assert_allclose(X[:3, 2], -np.array(axis), atol=1e-12)
            np.testing.assert_allclose(X[:3, 3], np.array([0.01, 0.02, 0.03]) + 0.1 * np.array(axis), atol=1e-12)
            session = osteon.Session(bone, self.tool, lockstep=True, surface=False)
            session.step(X)
            np.testing.assert_allclose(session.figures["proxy"], X, atol=1e-9)

    def test_plan_guides_and_scores(self):
        plan = osteon.Plan()
        info, reamers = plan.info, plan.reamers
        self.assertAlmostEqual(np.degrees(info["radiographic"]["inclination_rad"]), 40)
        self.assertEqual([round(1e3 * each["diameter_m"]) for each in reamers], [44, 46, 48, 50])
        axis = info["cup_axis"]
        X = np.eye(4)
        X[:3, 2] = -axis
        X[:3, 0] = np.cross(X[:3, 2], [1, 0, 0]) / np.linalg.norm(np.cross(X[:3, 2], [1, 0, 0]))
        X[:3, 1] = np.cross(X[:3, 2], X[:3, 0])
        guidance = osteon.Guidance(plan, 0, max_force_N=80)
        for height_m in np.arange(1e-3, -3e-3, -1e-5):
            X[:3, 3] = reamers[0]["apex_m"] + height_m * axis
            guided = guidance.evaluate(X, np.zeros(6), np.zeros(6))
        self.assertAlmostEqual(guided["depth_m"], 3e-3, places=4)
        self.assertGreater(guided["wrench"][:3] @ axis, 20)
        self.assertFalse(guided["inside"])
        guidance.set_model_age(0.1)
        self.assertEqual(guidance.evaluate(X)["share"], 0)
        guidance.set_gain(0)
        self.assertEqual(guidance.evaluate(X)["share"], 0)
        with self.assertRaisesRegex(osteon.Error, "accepted 0 … 3"):
            osteon.Guidance(plan, 4)
        session = osteon.Session(osteon.Bone(), osteon.Tool("reamer", 0.050), lockstep=True, surface=False)
        found = session.assess(plan)
        self.assertTrue(np.isnan(found["axis_error_rad"]))
        self.assertEqual(found["removed_m3"], 0)
        self.assertEqual(found["items"][0]["metric"], "axis_error")

    def test_bone_on_a_mount_gives_way(self):
        self.session.set_compliance(mount={"point_m": (0, 0, -0.02), "damping_ratio": 0.5})
        for z in list(np.arange(4.2, 3.0, -0.005)) + [3.0] * 1500:
            self.session.step(above(z))
            F = self.session.evaluate(above(z))
        deflection = self.session.deflection
        self.assertTrue(deflection["gives_way"])
        self.assertGreater(F[2], 5)
        np.testing.assert_allclose(-deflection["mount_m"][2], F[2] / 47.4e3, rtol=0.01)
        np.testing.assert_allclose(deflection["head"][2, 3], 3.0e-3 - deflection["mount_m"][2], atol=1e-6)
        self.session.set_compliance()
        self.assertFalse(self.session.deflection["gives_way"])
        with self.assertRaisesRegex(osteon.Error, "damping_ratio: found 0.01, accepted at least 0.05"):
            self.session.set_compliance(mount={"damping_ratio": 0.01})
        with self.assertRaises(TypeError):
            self.session.set_compliance(mount={"weight": 3})

    def test_structs_have_the_headers_sizes(self):
        for line in (Path(__file__).parent / "struct_sizes.txt").read_text().splitlines():
            name, size = line.split()
            # enums are plain numbers, and a vertex is a numpy dtype
            if name in ("OsteonEngine", "OsteonLogLevel", "OsteonResult"):
                continue
            if name == "OsteonVertex":
                found = osteon.VERTEX.itemsize
            else:
                name = {"OsteonSurfaceBuffers": "OsteonBuffers"}.get(name, name)
                found = ctypes.sizeof(getattr(osteon._library, "_" + name[len("Osteon"):]))
            self.assertEqual(found, int(size), name)

    def test_invalid_poses_and_twists_are_refused(self):
        mirrored, scaled, transposed = (above(4.2) for _ in range(3))
        mirrored[0, 0] = -1
        scaled[:3, :3] *= 1000
        transposed = above(4.2).T
        for wrong in (mirrored, scaled, transposed, np.zeros((4, 4)), np.full((4, 4), np.nan)):
            with self.assertRaisesRegex(ValueError, "accepted a rotation"):
                self.session.step(wrong)
        for count in (0, 3, 5, 7):
            with self.assertRaisesRegex(ValueError, f"twist: found {count} numbers, accepted 6"):
                self.session.evaluate(above(4.2), [0.0] * count)
        with self.assertRaisesRegex(ValueError, "other: found 3 numbers, accepted 6"):
            osteon.Guidance(osteon.Plan()).evaluate(above(4.2), other=[0.0] * 3)
        with self.assertRaisesRegex(ValueError, "without NUL"):
            osteon.Bone("acetabulum\0molar")
        with self.assertRaisesRegex(osteon.Error, "within 1 km"):
            self.session.step(above(1e9))

    def test_a_session_without_a_frame_has_no_proxy(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            proxy = osteon.Session(self.bone, self.tool, lockstep=True).figures["proxy"]
        self.assertTrue(np.isnan(proxy).all())

    def test_a_forked_child_is_refused(self):
        child = os.fork()
        if child == 0:
            try:
                osteon.Bone("molar")  # needs threads that the child does not have
            except osteon.Error as error:
                os._exit(0 if error.code == -7 and "forked" in str(error) else 1)
            os._exit(2)
        self.assertEqual(os.waitpid(child, 0)[1], 0)

    def test_errors_name_their_cause(self):
        with self.assertRaises(osteon.Error) as caught:
            osteon.Bone("no_such")
        self.assertEqual(caught.exception.code, -2)
        self.assertGreater(len(caught.exception.meaning), 10)
        with self.assertRaisesRegex(osteon.Error, "max_force_N"):
            osteon.Session(self.bone, self.tool, max_force_N=1000)
        with self.assertRaisesRegex(ValueError, "shape"):
            osteon.Tool(balls_mm=[1, 2, 3])
        with self.assertRaisesRegex(osteon.Error, "no_such"):
            osteon.Bone("no_such")
        with self.assertRaises(TypeError):
            osteon.Session(self.bone, self.tool, force=3)


if __name__ == "__main__":
    unittest.main()
