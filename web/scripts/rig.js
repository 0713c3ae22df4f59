// Where the cameras of a rig are to each other.

function product(A, B) {
  return A.map((row) => [0, 1, 2, 3].map((j) => row.reduce((sum, a, k) => sum + a * B[k][j], 0)));
}

function inverse(T) {
  const rows = [0, 1, 2].map((i) => {
    const shift = -[0, 1, 2].reduce((sum, k) => sum + T[k][i] * T[k][3], 0);
    return [T[0][i], T[1][i], T[2][i], shift];
  });
  return [...rows, [0, 0, 0, 1]];
}

const kIdentity = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]];

function isPose(T) {
  return list(T).length === 4 && T.flat().every(isNumber);
}

/** Angle of a rotation and its axis, times it [degrees]. */
function rotationVector(T) {
  const axis = [T[2][1] - T[1][2], T[0][2] - T[2][0], T[1][0] - T[0][1]];
  const sine = 0.5 * Math.hypot(...axis);
  const cosine = 0.5 * (T[0][0] + T[1][1] + T[2][2] - 1);
  const angle = Math.atan2(sine, cosine);
  // At half a turn the axis is not in the differences; a rig's cameras seldom stand like that.
  return axis.map((x) => sine > 1e-9 ? 90 / Math.PI * x * angle / sine : 0);
}

/** Sigmas by name: {"cam1.pos_x": ..}. */
function sigmasOf(covariance) {
  return Object.fromEntries(list(covariance?.names).map((name, i) => {
    return [name, Math.sqrt(covariance.matrix[i]?.[i] ?? NaN)];
  }));
}

/** T_a_b in words: the translation and the rotation about three axes, each with its sigma. */
function poseTable(T, sigmas, name) {
  const angles = rotationVector(T);
  const degrees = (radians) => 180 / Math.PI * radians;
  const rows = ["x", "y", "z"].map((x, i) => {
    const shift = 1000 * sigmas[`${name}.pos_${x}`];
    const turn = degrees(sigmas[`${name}.rot_${x}`]);
    return [x, withSigma(1000 * T[i][3], shift), number(shift, 2), withSigma(angles[i], turn),
            number(turn, 2)];
  });
  return table(["axis", "translation [mm]", "one sigma", "rotation vector [degrees]", "one sigma"],
               rows);
}

/** From which camera before it a camera's place is known, and how: null where from none. */
function relationOf(camera, n) {
  if (isPose(camera.T_cn_cnm1)) return {from: n - 1, pose: camera.T_cn_cnm1, sigmas: `cam${n}`};
  const earlier = camera.earlier_relation;
  if (!isPose(earlier?.T_cn_camera)) return null;
  const from = Number(String(earlier.camera).slice("cam".length));
  return {from, pose: earlier.T_cn_camera, sigmas: `cam${n}.from_cam${from}`};
}

/** The first calibrated camera (r) and those that are related to it: [{n, T_cn_cr}]. */
function placedCameras(cameras) {
  const poses = [];
  let root = null;
  for (const [n, camera] of cameras.entries()) {
    const relation = relationOf(camera, n);
    const before = relation && poses[relation.from];
    const isRoot = root === null && camera.intrinsics && !relation;
    if (isRoot) root = n;
    poses.push(isRoot ? kIdentity : before ? product(relation.pose, before) : null);
  }
  return poses.flatMap((T_cn_cr, n) => T_cn_cr ? [{n, T_cn_cr}] : []);
}

/** Cameras as pyramids in the frame of the first of them. */
function rigPlot(cameras, placed) {
  return plot(() => {
    const centres = placed.map(({T_cn_cr}) => inverse(T_cn_cr).slice(0, 3).map((row) => row[3]));
    const depth = 0.4 * Math.max(extent(centres), 0.02);
    const data = placed.map(({T_cn_cr, n}) => {
      const T_cr_cn = inverse(T_cn_cr);
      const rays = frustum(cameras[n].intrinsics, cameras[n].resolution ?? [640, 480], depth);
      const colour = kPalette[n % kPalette.length];
      return {
        type: "scatter3d", mode: "lines", name: `camera ${n}`, line: {width: 5, color: colour},
        ...polylines(rays.map((ray) => ray.map((p) => upright(transformed(T_cr_cn, p))))),
        hovertemplate: `camera ${n}<extra></extra>`,
      };
    });
    return {
      data,
      layout: {
        margin: {l: 0, r: 0, t: 0, b: 0},
        scene: scene(["x, right [m]", "z, forward [m]", "-y, up [m]"], [1.2, -1.6, 0.8], data),
      },
    };
  }, {height: "380px"});
}

function rigCards(result) {
  const cameras = list(result.cameras);
  const sigmas = sigmasOf(result.covariance);
  const made = card("The rig", "From each camera to the next: T_cn_cnm1 of Kalibr.");
  for (const [n, camera] of cameras.entries()) {
    if (n === 0) continue;
    const relation = relationOf(camera, n);
    const title = element("h4", {}, `From camera ${relation?.from ?? n - 1} to camera ${n}`);
    if (!relation) {
      const isMissing = [camera, cameras[n - 1]].some((either) => !either.intrinsics);
      made.append(title, emptyNote(isMissing ? "One of them was not calibrated."
                                             : "They share too few frames to be related."));
      continue;
    }
    const baseline = Math.hypot(...relation.pose.slice(0, 3).map((row) => row[3]));
    const frames = relation.from === n - 1 && isNumber(camera.num_shared_frames)
        ? `, from ${counted(camera.num_shared_frames, "shared frame", "shared frames")}` : "";
    made.append(title, poseTable(relation.pose, sigmas, relation.sigmas),
                element("p", {class: "note"},
                        `Baseline ${number(1000 * baseline, 6)} mm${frames}.`));
  }
  const placed = placedCameras(cameras);
  if (placed.length === 0) return [made];
  return [made, card(`The rig in the frame of camera ${placed[0].n}`, "",
                     rigPlot(cameras, placed))];
}
