from os import PathLike
from typing import Any, Literal, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

Task = Literal["intrinsic", "extrinsic", "joint"]
Rig = dict[str, Any]
Motion = dict[str, Any]
Path = Union[str, PathLike[str]]

class InputError(ValueError): ...

class View:
    def __init__(
        self,
        pixels: ArrayLike,
        points: ArrayLike,
        corner_ids: Optional[Sequence[int]] = ...,
        stamp_ns: int = ...,
    ) -> None: ...
    @property
    def pixels(self) -> NDArray[np.float64]: ...
    @property
    def points(self) -> NDArray[np.float64]: ...
    @property
    def corner_ids(self) -> list[int]: ...
    @property
    def stamp_ns(self) -> int: ...

class Recording:
    views: list[View]
    num_frames: int
    imu_stamps_ns: NDArray[np.int64]
    gyro: NDArray[np.float64]
    accel: NDArray[np.float64]
    def __init__(
        self,
        views: list[View],
        num_frames: int,
        imu_stamps_ns: NDArray[np.int64],
        gyro: NDArray[np.float64],
        accel: NDArray[np.float64],
    ) -> None: ...

class CameraResult:
    termination: str
    model: str
    names: list[str]
    parameters: Optional[NDArray[np.float64]]
    covariance: Optional[NDArray[np.float64]]
    reprojection_rms_px: float
    noise_stddev_px: float
    num_views: int
    @property
    def sigmas(self) -> Optional[NDArray[np.float64]]: ...

class CameraImuResult:
    termination: str
    T_cam_imu: Optional[NDArray[np.float64]]
    time_offset_s: Optional[float]
    names: list[str]
    covariance: Optional[NDArray[np.float64]]
    reprojection_rms_px: float
    @property
    def sigmas(self) -> Optional[dict[str, float]]: ...

class Information:
    names: list[str]
    covariance: NDArray[np.float64]
    num_frames: float
    @property
    def sigmas(self) -> dict[str, float]: ...

def paper_rig() -> Rig: ...
def load_rig(path: Path) -> Rig: ...
def load_motion(path: Path) -> Motion: ...
def save_motion(motion: Motion, path: Path) -> None: ...
def handcrafted_motion(rig: Rig, task: Task) -> Motion: ...
def path_length_m(motion: Motion) -> float: ...
def simulate(
    rig: Rig,
    motion: Motion,
    *,
    carrier: Literal["free", "arm"] = ...,
    fidelity: Literal["fast", "physical"] = ...,
    seed: int = ...,
    scale_to_fit: bool = ...,
) -> Recording: ...
def calibrate_camera(
    views: Sequence[View],
    resolution: tuple[int, int],
    *,
    model: str = ...,
    reject_outliers: bool = ...,
) -> CameraResult: ...
def calibrate_camera_imu(
    recording: Recording, camera: CameraResult, imu: dict[str, Any]
) -> CameraImuResult: ...
def information(
    rig: Rig, motion: Motion, task: Literal["intrinsic", "extrinsic"]
) -> Optional[Information]: ...
def plan(
    rig: Rig,
    task: Task,
    *,
    max_path_m: Optional[float] = ...,
    max_time_s: Optional[float] = ...,
    num_starts: int = ...,
    evaluations: int = ...,
    seed: int = ...,
) -> Optional[Motion]: ...
