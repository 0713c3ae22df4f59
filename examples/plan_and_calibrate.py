#!/usr/bin/env python3
# %% [markdown]
# # Plan a motion, make it, calibrate from it
#
# A camera on a hand before a checkerboard: which motion calibrates it well, how well, and does the
# calibration keep what was promised? Cells begin with `# %%`: editors that know notebooks run them
# one by one; `python3 plan_and_calibrate.py` runs all.

# %%
import numpy as np

import calibrato

rig = calibrato.paper_rig()
camera = rig["cameras"]["cam0"]
model = f"{camera['camera_model']}-{camera['distortion_model']}"
truth = np.array(camera["intrinsics"] + camera["distortion_coeffs"])
print("the camera to be found:", model, truth)

# %% [markdown]
# ## Two motions
#
# The paper's handcrafted motion, and one that is designed for as small an uncertainty as the same
# path and time can give.

# %%
handcrafted = calibrato.handcrafted_motion(rig, "intrinsic")
planned = calibrato.plan(rig, "intrinsic", num_starts=2, evaluations=40, seed=1)

for name, motion in (("handcrafted", handcrafted), ("planned", planned)):
    expected = calibrato.information(rig, motion, "intrinsic")
    print(f"{name}: {calibrato.path_length_m(motion):.2f} m, "
          f"focal length to +-{expected.sigmas['fu']:.3f} px")

# %% [markdown]
# ## Is it so?
#
# Both are made in the simulator, and the camera is calibrated from what it saw.

# %%
results = {}
for name, motion in (("handcrafted", handcrafted), ("planned", planned)):
    recording = calibrato.simulate(rig, motion, seed=2, scale_to_fit=True)
    result = calibrato.calibrate_camera(recording.views, (640, 480), model=model)
    results[name] = result
    print(f"{name}: {result.num_views} views, {result.termination}, "
          f"fu {result.parameters[0]:.2f} +- {result.sigmas[0]:.2f}, "
          f"off by {result.parameters[0] - truth[0]:+.2f} px")

# %% [markdown]
# ## Camera and IMU
#
# The handcrafted extrinsic motion, with the lens that was just found.

# %%
motion = calibrato.handcrafted_motion(rig, "extrinsic")
recording = calibrato.simulate(rig, motion, seed=3)
found = calibrato.calibrate_camera_imu(recording, results["planned"], rig["imu"])
shift_mm = 1000 * (found.T_cam_imu[:3, 3] - np.array(rig["imu"]["T_cam_imu"])[:3, 3])
print(f"camera to IMU: off by {np.linalg.norm(shift_mm):.2f} mm, "
      f"sigma {1000 * found.sigmas['cam0.pos_x']:.2f} mm along x")
