"""calibrato from Python: calibrate, simulate, expect and plan.

Rigs and motions are dictionaries with the keys of RIG.yaml and MOTION.yaml (docs/formats.md). Arrays
are numpy's: corners one a row. Frames, units and signs are those of docs/conventions.md. What is
wrong with an input is said by InputError, a ValueError.
"""

import dataclasses
import json

import numpy as np

from calibrato._calibrato import InputError, View
from calibrato import _calibrato

__all__ = [
    "CameraImuResult", "CameraResult", "Information", "InputError", "Recording", "View",
    "calibrate_camera", "calibrate_camera_imu", "handcrafted_motion", "information", "load_motion",
    "load_rig", "paper_rig", "path_length_m", "plan", "save_motion", "simulate",
]


@dataclasses.dataclass
class Recording:
    """What was recorded: views of the board, and an IMU whose two sensors share their stamps."""

    views: list
    num_frames: int
    imu_stamps_ns: np.ndarray
    gyro: np.ndarray
    accel: np.ndarray


def _sigmas(covariance):
    return None if covariance is None else np.sqrt(np.diag(covariance))


@dataclasses.dataclass
class CameraResult:
    """A calibrated camera. Parameters are None without a start, the covariance where some parameter
    can take any value."""

    termination: str
    model: str
    names: list
    parameters: np.ndarray
    covariance: np.ndarray
    reprojection_rms_px: float
    noise_stddev_px: float
    num_views: int

    @property
    def sigmas(self):
        """Standard deviations of the parameters."""
        return _sigmas(self.covariance)


@dataclasses.dataclass
class CameraImuResult:
    """Where the camera is from the IMU, and when. names are those of the covariance."""

    termination: str
    T_cam_imu: np.ndarray
    time_offset_s: float
    names: list
    covariance: np.ndarray
    reprojection_rms_px: float

    @property
    def sigmas(self):
        """Standard deviations by name."""
        if self.covariance is None:
            return None
        return dict(zip(self.names, _sigmas(self.covariance)))


@dataclasses.dataclass
class Information:
    """What a motion is expected to leave unknown."""

    names: list
    covariance: np.ndarray
    num_frames: float

    @property
    def sigmas(self):
        """Standard deviations by name."""
        return dict(zip(self.names, _sigmas(self.covariance)))


def paper_rig():
    """The paper's rig and scene."""
    return json.loads(_calibrato.paper_rig())


def load_rig(path):
    """RIG.yaml."""
    return json.loads(_calibrato.read_rig(str(path)))


def load_motion(path):
    """MOTION.yaml."""
    return json.loads(_calibrato.read_motion(str(path)))


def save_motion(motion, path):
    """Writes MOTION.yaml, for `calibrato export` and `calibrato simulate`."""
    with open(path, "w", encoding="utf-8") as file:
        file.write(_calibrato.yaml(json.dumps(motion)))


def handcrafted_motion(rig, task):
    """The paper's handcrafted motion, before the rig's board. task: intrinsic, extrinsic, joint."""
    return json.loads(_calibrato.handcrafted_motion(json.dumps(rig), task))


def path_length_m(motion):
    """The paper's path length, turns counted as 1 m/rad [m]."""
    return _calibrato.path_length_m(json.dumps(motion))


def simulate(rig, motion, *, carrier="free", fidelity="fast", seed=1, scale_to_fit=False):
    """A recording of the rig making the motion. carrier: free, arm; fidelity: fast, physical."""
    made = _calibrato.simulate(json.dumps(rig), json.dumps(motion), carrier, fidelity, seed,
                               scale_to_fit)
    made["imu_stamps_ns"] = np.array(made["imu_stamps_ns"], dtype=np.int64)
    return Recording(**made)


def calibrate_camera(views, resolution, *, model="pinhole-radtan", reject_outliers=True):
    """Intrinsics from views of a planar board. resolution: (width, height) [px]."""
    return CameraResult(
        **_calibrato.calibrate_camera(list(views), tuple(resolution), model, reject_outliers))


def calibrate_camera_imu(recording, camera, imu):
    """T_cam_imu and time offset. camera: a CameraResult, held; imu: the keys of imu.yaml."""
    return CameraImuResult(**_calibrato.calibrate_camera_imu(
        list(recording.views), camera.model, camera.parameters,
        [int(stamp) for stamp in recording.imu_stamps_ns], recording.gyro, recording.accel,
        json.dumps(imu)))


def information(rig, motion, task):
    """What the motion is expected to leave unknown; None where it does not determine the
    calibration. task: intrinsic or extrinsic."""
    found = _calibrato.information(json.dumps(rig), json.dumps(motion), task)
    return None if found is None else Information(**found)


def plan(rig, task, *, max_path_m=None, max_time_s=None, num_starts=6, evaluations=200, seed=1):
    """A motion of large expected information, by direct design; None if nothing can be learned.
    Path and time are those of the handcrafted motion unless told otherwise."""
    motion = _calibrato.plan(json.dumps(rig), task, max_path_m, max_time_s, num_starts, evaluations,
                             seed)
    return None if motion is None else json.loads(motion)
