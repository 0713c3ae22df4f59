#!/usr/bin/env python3
"""calibrato, cv::calibrateCamera and mrcal on the same corners, one after the other.

    benchmarks/camera_solvers.py build/release/calibrato [--opencv-views N]

Simulated: a pinhole with radtan5 distortion, 640 x 480 pixels, a board of 6 x 7 corners in every
view, noise of 0.1 px, seed 1. Prints wall times [s], peak memory of the program and what was found.
Needs numpy, OpenCV's and mrcal's Debian packages; leaves out what is not there.
"""

import argparse
import json
import os
import shutil
import subprocess
import tempfile
import time

import numpy as np

try:
    import cv2
except ImportError:
    cv2 = None

ROWS, COLUMNS, SPACING = 6, 7, 0.03
WIDTH, HEIGHT = 640, 480
K = np.array([[585.0, 0.0, 320.5], [0.0, 585.0, 240.5], [0.0, 0.0, 1.0]])
DISTORTION = np.array([-0.1, 0.05, 0.001, -0.001, 0.05])  # k1 k2 p1 p2 k3


def rotation(vector):
    angle = np.linalg.norm(vector)
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross


def project(points):
    k1, k2, p1, p2, k3 = DISTORTION
    x, y = points[:, 0] / points[:, 2], points[:, 1] / points[:, 2]
    r2 = x * x + y * y
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    u = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)
    v = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y
    return np.column_stack([K[0, 0] * u + K[0, 2], K[1, 1] * v + K[1, 2]])


def simulate(num_views):
    """Board points [m] (columns fastest) and their pixels in every view."""
    random = np.random.default_rng(1)
    row, column = np.divmod(np.arange(ROWS * COLUMNS), COLUMNS)
    board = np.column_stack([row * SPACING, column * SPACING, np.zeros(ROWS * COLUMNS)])
    views = []
    while len(views) < num_views:
        turn = rotation(random.normal(0.0, 0.45, 3)) @ rotation(np.array([0.0, 0.0, np.pi / 2]))
        depth = random.uniform(0.22, 0.6)
        place = np.array([random.uniform(-0.5, 0.5), random.uniform(-0.4, 0.4), 1.0]) * depth
        points = (board - board.mean(axis=0)) @ turn.T + place
        if points[:, 2].min() < 0.1 or turn[2, 2] < 0.3:
            continue
        pixels = project(points) + random.normal(0.0, 0.1, (len(board), 2))
        if (pixels < 0).any() or (pixels > [WIDTH - 1, HEIGHT - 1]).any():
            continue
        views.append(pixels)
    return board, views


def write(folder, board, views):
    os.makedirs(folder)
    with open(f"{folder}/cam0_corners.csv", "w") as out:
        out.write("timestamp [ns],tag_id,tag_corner,u [px],v [px],x [m],y [m],z [m]\n")
        for k, pixels in enumerate(views):
            for i, ((u, v), (x, y, _)) in enumerate(zip(pixels, board)):
                out.write(f"{k * 100000000},{i},0,{u:.9f},{v:.9f},{x:.9f},{y:.9f},0\n")
    with open(f"{folder}/corners.vnl", "w") as out:
        out.write("# filename x y\n")
        for k, pixels in enumerate(views):
            out.writelines(f"image{k:06d}.png {u:.9f} {v:.9f}\n" for u, v in pixels)


def report(num_views, name, seconds, memory_mb, focal):
    print(f"| {num_views} | {name} | {seconds:.3f} | {memory_mb} | {focal[0]:.3f}, {focal[1]:.3f} |",
          flush=True)


def run_calibrato(program, folder, num_views):
    begin = time.monotonic()
    subprocess.run([program, "calibrate", "camera", folder, "--model", "pinhole-radtan5",
                    "--resolution", f"{WIDTH}x{HEIGHT}", "--keep-outliers", "--quiet", "--out",
                    f"{folder}/result"], check=False)
    whole = time.monotonic() - begin
    timing = json.load(open(f"{folder}/result/timing.json"))
    focal = json.load(open(f"{folder}/result/result.json"))["cameras"][0]["intrinsics"][:2]
    memory = round(timing["peak_memory_bytes"] / 1e6)
    report(num_views, "calibrato, whole program with its checks and report", whole, memory, focal)


def run_opencv(board, views):
    points = [board.astype(np.float32)] * len(views)
    pixels = [v.astype(np.float32).reshape(-1, 1, 2) for v in views]
    begin = time.monotonic()
    _, matrix, *_ = cv2.calibrateCamera(points, pixels, (WIDTH, HEIGHT), None, None)
    report(len(views), "cv::calibrateCamera", time.monotonic() - begin, "-",
           (matrix[0, 0], matrix[1, 1]))


def run_mrcal(folder, num_views):
    begin = time.monotonic()
    subprocess.run(["mrcal-calibrate-cameras", "--corners-cache", "corners.vnl", "--lensmodel",
                    "LENSMODEL_OPENCV5", "--focal", "500", "--object-spacing", str(SPACING),
                    "--object-width-n", str(COLUMNS), "--object-height-n", str(ROWS),
                    "--imagersize", str(WIDTH), str(HEIGHT), "--skip-outlier-rejection",
                    "--skip-calobject-warp-solve", "--skip-regularization", "image*.png"],
                   cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    whole = time.monotonic() - begin
    import mrcal
    focal = mrcal.cameramodel(f"{folder}/camera-0.cameramodel").intrinsics()[1][:2]
    report(num_views, "mrcal-calibrate-cameras, whole program", whole, "-", focal)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("calibrato")
    parser.add_argument("--views", type=int, nargs="+", default=[200, 2000])
    parser.add_argument("--opencv-views", type=int, default=50, help="its time grows as the cube")
    arguments = parser.parse_args()
    print("| views | program | wall time [s] | peak memory [MB] | fu, fv [px] |")
    print("|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for num_views in arguments.views:
            board, views = simulate(num_views)
            here = f"{folder}/{num_views}"
            write(here, board, views)
            run_calibrato(os.path.abspath(arguments.calibrato), here, num_views)
            if cv2 is not None and num_views <= arguments.opencv_views:
                run_opencv(board, views)
            if shutil.which("mrcal-calibrate-cameras"):
                run_mrcal(here, num_views)


if __name__ == "__main__":
    main()
