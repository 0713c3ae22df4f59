#!/usr/bin/env python3
"""calibrato and mrcal on the same corners with one lens model: rms, focal lengths, the maps of
projection uncertainty, and how far the board is from flat.

    benchmarks/mrcal_agreement.py build/release/calibrato /usr/share/doc/opencv-doc/examples/data

calibrato finds the corners in OpenCV's left01.jpg to left14.jpg. Both programs then calibrate from
lists of these, rounded to 1e-3 px: pinhole-radtan5 and LENSMODEL_OPENCV5, a flat board, no corner
left out. Their maps, one sigma in the worst direction over 32 x 24 points, are compared at the
boards' median distance and at infinity. Ends with 1 where they differ by more than 20 % at any
point. The board's bending is mrcal's with its warp estimated. Needs mrcal's Debian packages.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile

import mrcal
import numpy as np

ROWS, COLUMNS, SPACING = 6, 9, 0.025
WIDTH, HEIGHT = 640, 480
NAMES = ("fu", "fv", "pu", "pv")
LARGEST_DIFFERENCE = 0.2


def calibrate(program, recording, out, *options):
    """result.json; the exit code is the verdict's."""
    ended = subprocess.run([program, "calibrate", "camera", recording, "--model", "pinhole-radtan5",
                            "--keep-outliers", "--quiet", "--out", out, *options], check=False)
    if ended.returncode > 1:
        sys.exit(ended.returncode)
    with open(f"{out}/result.json", encoding="utf-8") as file:
        return json.load(file)


def corners_of_photos(program, photos, folder):
    """[(image, pixels)], corners by rows."""
    with open(f"{folder}/board.yaml", "w", encoding="utf-8") as file:
        file.write(f"target_type: 'checkerboard'\ntargetCols: {COLUMNS}\ntargetRows: {ROWS}\n"
                   f"rowSpacingMeters: {SPACING}\ncolSpacingMeters: {SPACING}\n")
    calibrate(program, photos, f"{folder}/photos", "--images", "left[01][0-9].jpg", "--target",
              f"{folder}/board.yaml")
    with open(f"{folder}/photos/plots.json", encoding="utf-8") as file:
        return [(v["name"], v["pixels"]) for v in json.load(file)["plots"]["views"]]


def write_lists(folder, views):
    os.makedirs(f"{folder}/lists")
    with open(f"{folder}/lists/cam0_corners.csv", "w", encoding="utf-8") as out:
        out.write("timestamp [ns],tag_id,tag_corner,u [px],v [px],x [m],y [m],z [m]\n")
        for k, (_, pixels) in enumerate(views):
            for i, (u, v) in enumerate(pixels):
                row, column = divmod(i, COLUMNS)
                out.write(f"{(k + 1) * 1000000000},{i},0,{u:.3f},{v:.3f},{row * SPACING:.3f},"
                          f"{column * SPACING:.3f},0\n")
    with open(f"{folder}/corners.vnl", "w", encoding="utf-8") as out:
        out.write("# filename x y\n")
        for name, pixels in views:
            out.writelines(f"{name} {u:.3f} {v:.3f}\n" for u, v in pixels)


def run_mrcal(folder, *options):
    out = tempfile.mkdtemp(dir=folder)
    subprocess.run(["mrcal-calibrate-cameras", "--corners-cache", "corners.vnl", "--lensmodel",
                    "LENSMODEL_OPENCV5", "--focal", "500", "--object-spacing", str(SPACING),
                    "--object-width-n", str(COLUMNS), "--object-height-n", str(ROWS),
                    "--imagersize", str(WIDTH), str(HEIGHT), "--skip-outlier-rejection", *options,
                    "--outdir", out, "left*.jpg"],
                   cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return mrcal.cameramodel(f"{out}/camera-0.cameramodel")


def map_of_mrcal(model, distance_m):
    u, v = np.meshgrid(np.linspace(0, WIDTH - 1, 32), np.linspace(0, HEIGHT - 1, 24))
    rays = mrcal.unproject(np.stack([u, v], axis=-1), *model.intrinsics(), normalize=True)
    is_far = distance_m is None
    return mrcal.projection_uncertainty(rays * (1.0 if is_far else distance_m), model,
                                        atinfinity=is_far, what="worstdirection-stdev")


def rms_of_mrcal(model, num_corners):
    """sqrt(sum(du^2 + dv^2) / N), without the rows of the regularisation."""
    residuals = mrcal.optimizer_callback(**model.optimization_inputs())[1]
    return np.sqrt(np.sum(residuals[:2 * num_corners] ** 2) / num_corners)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("calibrato")
    parser.add_argument("photos")
    arguments = parser.parse_args()
    program = os.path.abspath(arguments.calibrato)
    with tempfile.TemporaryDirectory() as folder:
        views = corners_of_photos(program, arguments.photos, folder)
        write_lists(folder, views)
        camera = calibrate(program, f"{folder}/lists", f"{folder}/result", "--resolution",
                           f"{WIDTH}x{HEIGHT}")["cameras"][0]
        num_corners = camera["num_corners"]
        flat = "--skip-calobject-warp-solve"
        others = {"mrcal": run_mrcal(folder, "--skip-regularization", flat),
                  "mrcal, regularised": run_mrcal(folder, flat)}
        bent = run_mrcal(folder, "--skip-regularization")

    print(f"{len(views)} photos, {num_corners} corners\n")
    print("| program | rms [px] | " + " | ".join(f"{name} [px]" for name in NAMES) + " |")
    print("|---|---|" + "---|" * len(NAMES))
    print(f"| calibrato | {camera['reprojection_rms_px']:.6f} | " +
          " | ".join(f"{x:.3f} +- {s:.3f}"
                     for x, s in zip(camera["intrinsics"], camera["intrinsics_sigma"])) + " |")
    for name, model in others.items():
        print(f"| {name} | {rms_of_mrcal(model, num_corners):.6f} | " +
              " | ".join(f"{x:.3f}" for x in model.intrinsics()[1][:4]) + " |")

    print("\n| points at | beside | calibrato: median, worst [px] | mrcal: median, worst [px] | "
          "calibrato / mrcal: least, median, largest |")
    print("|---|---|---|---|---|")
    uncertainty = camera["projection_uncertainty"]
    agree = True
    for key, distance_m in (("at_distance", uncertainty["distance_m"]), ("at_infinity", None)):
        ours = np.array(uncertainty[key]["values_px"], dtype=float)
        where = "infinity" if distance_m is None else f"{distance_m:.3f} m"
        for name, model in others.items():
            theirs = map_of_mrcal(model, distance_m)
            ratio = ours.reshape(theirs.shape) / theirs
            agree = agree and bool(np.all(np.abs(ratio - 1.0) <= LARGEST_DIFFERENCE))
            print(f"| {where} | {name} | {np.median(ours):.4f}, {ours.max():.3f} | "
                  f"{np.median(theirs):.4f}, {theirs.max():.3f} | {ratio.min():.4f}, "
                  f"{np.median(ratio):.4f}, {ratio.max():.4f} |")

    bending = camera["checks"]["bending"]
    warp = bent.optimization_inputs()["calobject_warp"]
    print(f"\nbending: calibrato, one step from flat, {1e3 * bending['depth_m']:.3f} mm deep; "
          f"mrcal {1e3 * warp[0]:.3f} and {1e3 * warp[1]:.3f} mm along the two sides, rms "
          f"{rms_of_mrcal(others['mrcal'], num_corners):.4f} -> "
          f"{rms_of_mrcal(bent, num_corners):.4f} px")
    return 0 if agree else 1


if __name__ == "__main__":
    sys.exit(main())
