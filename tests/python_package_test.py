"""What the package promises, from outside."""

import ast
import dataclasses
import inspect
import pathlib
import unittest

import numpy as np

import calibrato


def grid():
    return np.array([[0.05 * i, 0.05 * j, 0.0] for i in range(7) for j in range(6)])


def views_through(f, num=12):
    """Corners seen by a pinhole without distortion, projected by numpy."""
    rng = np.random.default_rng(1)
    views = []
    for k in range(num):
        angle = rng.uniform(-0.5, 0.5, 3)
        theta = np.linalg.norm(angle)
        axis = angle / theta
        K = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
        R = np.eye(3) + np.sin(theta) * K + (1 - np.cos(theta)) * K @ K
        p = (grid() - grid().mean(axis=0)) @ R.T + [0.0, 0.0, 0.6 + 0.02 * k]
        pixels = f * p[:, :2] / p[:, 2:] + [320.0, 240.0]
        views.append(calibrato.View(pixels, grid(), stamp_ns=k))
    return views


class Package(unittest.TestCase):
    def test_finds_a_lens_that_numpy_projected_through(self):
        result = calibrato.calibrate_camera(views_through(500.0), (640, 480), model="pinhole-none")
        self.assertEqual(result.names, ["fu", "fv", "pu", "pv"])
        np.testing.assert_allclose(result.parameters, [500.0, 500.0, 320.0, 240.0], atol=1e-5)
        self.assertEqual(result.num_views, 12)

    def test_views_keep_what_they_are_given(self):
        view = views_through(500.0, 1)[0]
        self.assertEqual(view.pixels.shape, (42, 2))
        np.testing.assert_array_equal(view.points, grid())
        self.assertEqual(view.corner_ids, list(range(42)))

    def test_says_what_is_wrong_with_an_input(self):
        with self.assertRaisesRegex(calibrato.InputError, "not of one length"):
            calibrato.View(np.zeros((3, 2)), np.zeros((4, 3)))
        with self.assertRaises(ValueError):
            calibrato.calibrate_camera(views_through(500.0), (640, 480), model="pinhole-radtam")
        rig = calibrato.paper_rig()
        del rig["imu"]
        with self.assertRaisesRegex(calibrato.InputError, "imu"):
            calibrato.information(rig, {}, "intrinsic")

    def test_refuses_corners_that_are_not_finite(self):
        for bad in (np.nan, np.inf):
            pixels, points = np.zeros((42, 2)), grid()
            pixels[3, 1] = bad
            with self.assertRaisesRegex(calibrato.InputError, "not finite"):
                calibrato.View(pixels, grid())
            points[3, 1] = bad
            with self.assertRaisesRegex(calibrato.InputError, "not finite"):
                calibrato.View(np.zeros((42, 2)), points)

    def test_refuses_samples_that_are_not_finite_and_stamps_that_do_not_ascend(self):
        camera = calibrato.calibrate_camera(views_through(500.0), (640, 480), model="pinhole-none")
        imu = calibrato.paper_rig()["imu"]
        stamps = np.arange(5) * 5_000_000
        good = calibrato.Recording([], 0, stamps, np.zeros((5, 3)), np.zeros((5, 3)))
        bad = np.zeros((5, 3))
        bad[2, 1] = np.nan
        for sensor in ("gyro", "accel"):
            recording = dataclasses.replace(good, **{sensor: bad})
            with self.assertRaisesRegex(calibrato.InputError, f"not finite, {sensor} row 2"):
                calibrato.calibrate_camera_imu(recording, camera, imu)
        for wrong in (stamps[[0, 1, 1, 3, 4]], stamps[[0, 3, 1, 2, 4]]):
            recording = dataclasses.replace(good, imu_stamps_ns=wrong)
            with self.assertRaisesRegex(calibrato.InputError, "do not ascend, gyro row 2"):
                calibrato.calibrate_camera_imu(recording, camera, imu)

    def test_refuses_a_camera_without_parameters(self):
        camera = calibrato.CameraResult("failed", "pinhole-none", ["fu", "fv", "pu", "pv"], None,
                                        None, float("nan"), float("nan"), 0)
        stamps = np.arange(5) * 5_000_000
        recording = calibrato.Recording([], 0, stamps, np.zeros((5, 3)), np.zeros((5, 3)))
        with self.assertRaisesRegex(calibrato.InputError, "no parameters"):
            calibrato.calibrate_camera_imu(recording, camera, calibrato.paper_rig()["imu"])

    def test_the_same_seed_gives_the_same_recording(self):
        rig = calibrato.paper_rig()
        motion = calibrato.handcrafted_motion(rig, "extrinsic")
        first = calibrato.simulate(rig, motion, seed=4)
        again = calibrato.simulate(rig, motion, seed=4)
        other = calibrato.simulate(rig, motion, seed=5)
        np.testing.assert_array_equal(first.gyro, again.gyro)
        np.testing.assert_array_equal(first.views[0].pixels, again.views[0].pixels)
        self.assertFalse(np.array_equal(first.gyro, other.gyro))

    def test_expects_what_calibrations_scatter_by(self):
        """The standard deviation that a motion is expected to leave, against 30 calibrations."""
        rig = calibrato.paper_rig()
        motion = calibrato.handcrafted_motion(rig, "intrinsic")
        expected = calibrato.information(rig, motion, "intrinsic").sigmas["fu"]
        found = []
        for seed in range(30):
            recording = calibrato.simulate(rig, motion, seed=seed)
            result = calibrato.calibrate_camera(recording.views, (640, 480), model="pinhole-none")
            found.append(result.parameters[0])
        # A standard deviation from 30 draws is known to 13 %: four of those.
        self.assertLess(abs(np.std(found, ddof=1) / expected - 1.0), 4 * 0.13)

    def test_stubs_name_all_that_there_is(self):
        stub = pathlib.Path(calibrato.__file__).with_suffix(".pyi")
        tree = ast.parse(stub.read_text())
        named = {node.name: node for node in tree.body
                 if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
        self.assertEqual(sorted(named), sorted(calibrato.__all__))
        for name, node in named.items():
            if isinstance(node, ast.FunctionDef):
                there = list(inspect.signature(getattr(calibrato, name)).parameters)
                said = [arg.arg for arg in node.args.args + node.args.kwonlyargs]
                self.assertEqual(said, there, name)


if __name__ == "__main__":
    unittest.main()
