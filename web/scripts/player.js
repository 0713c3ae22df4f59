// A motion played through time: the arm, where there is one, its camera and the board.

const kPlayerFps = 10;
const kCameraWords = "camera at x %{x:.3f}, y %{y:.3f}, z %{z:.3f} m<extra></extra>";

/** The vector turned by the quaternion [x, y, z, w]. */
function turned([x, y, z, w], v) {
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                           a[0] * b[1] - a[1] * b[0]];
  const t = cross([x, y, z], v).map((each) => 2 * each);
  const u = cross([x, y, z], t);
  return v.map((each, k) => each + w * t[k] + u[k]);
}

/** The camera as a pyramid, its tip the camera's centre: lines for `polylines`. */
function cameraLines(pose, size) {
  const tip = pose.slice(0, 3);
  const corners = [[-0.8, -0.6], [0.8, -0.6], [0.8, 0.6], [-0.8, 0.6]].map(([x, y]) => {
    return turned(pose.slice(3), [size * x, size * y, size * 1.2]).map((each, k) => tip[k] + each);
  });
  return [[...corners, corners[0]], ...corners.map((corner) => [tip, corner])];
}

function armPoints(row) {
  const points = [];
  for (let k = 0; k + 2 < list(row).length; k += 3) points.push(row.slice(k, k + 3));
  return points;
}

function playedSteps(motion) {
  return list(motion.played?.camera_b).length;
}

/** What stands still while a motion is played: the camera's way, the board, the space they take. */
function stillTraces(motion, outline) {
  const colour = policyColour(motion.policy);
  const traces = [{
    type: "scatter3d", mode: "lines", ...polylines([motion.played.camera_b]), showlegend: false,
    name: "way of the camera", line: {width: 2, color: shade(colour, 0.3)},
    hovertemplate: kCameraWords,
  }];
  if (outline.length > 0) {
    traces.push({
      type: "scatter3d", mode: "lines", ...polylines([[...outline, outline[0]]]),
      name: "board", line: {width: 5, color: kBlack}, showlegend: false,
      hovertemplate: "board<extra></extra>",
    });
  }
  return traces;
}

function movingTraces(motion, step, size) {
  const arm = armPoints(list(motion.played.arm_b)[step]);
  return [
    {
      type: "scatter3d", mode: "lines", showlegend: false, name: "camera",
      hovertemplate: kCameraWords,
      ...polylines(cameraLines(motion.played.camera_b[step], size)),
      line: {width: 4, color: policyColour(motion.policy)},
    },
    {
      type: "scatter3d", mode: "lines+markers", showlegend: false, name: "arm", hoverinfo: "skip",
      ...polylines(arm.length > 0 ? [arm] : []),
      line: {width: 10, color: kGrey}, marker: {size: 4, color: kBlack},
    },
  ];
}

/** A box around all steps, so that the scene keeps its place while the arm moves. */
function playedBounds(motion, outline, size) {
  const points = [...motion.played.camera_b, ...list(motion.played.arm_b).flatMap(armPoints),
                  ...outline];
  return [0, 1, 2].map((k) => {
    const values = points.map((point) => point[k]);
    return [Math.min(...values) - size, Math.max(...values) + size];
  });
}

/** @return One card, or none if no motion says how it is played. */
function playerCards(motions, outline_b, title) {
  const played = motions.filter((motion) => playedSteps(motion) > 1);
  if (played.length === 0) return [];
  const outline = list(outline_b);
  const kCameraSize = 0.06;
  let motion = played[0];
  let step = 0;
  let timer = null;

  const choice = element("select", {"aria-label": "motion"});
  played.forEach((each, i) => choice.append(element("option", {value: i}, each.policy)));
  const button = element("button", {type: "button"}, "Play");
  const slider = element("input", {type: "range", min: 0, value: 0, step: 1, "aria-label": "time"});
  const clock = element("span", {class: "clock"});

  const figure = () => {
    const bounds = playedBounds(motion, outline, kCameraSize);
    const data = [...movingTraces(motion, step, kCameraSize), ...stillTraces(motion, outline)];
    const corners = {...polylines([[0, 1].map((i) => bounds.map((range) => range[i]))])};
    const made = scene(["x [m]", "y [m]", "z [m]"], [-0.7, -1.7, 0.7], [corners]);
    ["xaxis", "yaxis", "zaxis"].forEach((name, k) => { made[name].range = bounds[k]; });
    // The box is mostly air.
    for (const side of ["x", "y", "z"]) made.camera.eye[side] *= 0.75;
    return {data, layout: {margin: {l: 0, r: 0, t: 0, b: 0}, scene: made, uirevision: "player"}};
  };
  const place = plot(figure, {height: kNarrow ? "380px" : "520px"});

  const tellTime = () => {
    slider.max = playedSteps(motion) - 1;
    slider.value = step;
    const now = step * motion.played.step_s;
    clock.textContent = `${now.toFixed(1)} of ${number(motion.motion_s, 3)} s`;
  };
  const show = (next) => {
    step = next;
    tellTime();
    if (!place.data) return;
    const moving = movingTraces(motion, step, kCameraSize);
    const axes = ["x", "y", "z"].map((name) => [name, moving.map((trace) => trace[name])]);
    Plotly.restyle(place, Object.fromEntries(axes), [0, 1]);
  };
  const stop = () => {
    clearInterval(timer);
    timer = null;
    button.textContent = "Play";
  };
  button.addEventListener("click", () => {
    if (timer !== null) return stop();
    const last = playedSteps(motion) - 1;
    // From the beginning once it has ended; as fast as in life.
    const began = Date.now() - 1000 * (step === last ? 0 : step) * motion.played.step_s;
    button.textContent = "Pause";
    timer = setInterval(() => {
      const now = Math.floor((Date.now() - began) / 1000 / motion.played.step_s);
      show(Math.min(now, last));
      if (now >= last) stop();
    }, 1000 / kPlayerFps);
  });
  slider.addEventListener("input", () => {
    stop();
    show(Number(slider.value));
  });
  choice.addEventListener("change", () => {
    stop();
    motion = played[Number(choice.value)];
    step = 0;
    tellTime();
    if (!place.data) return;
    const {data, layout} = figure();
    Plotly.react(place, data, completeLayout(layout), kConfig);
  });
  tellTime();
  const control = element("div", {class: "control"}, played.length > 1 ? choice : "", button, slider,
                          clock);
  const hasArm = played.some((each) => list(each.played.arm_b).length > 0);
  const note = `The camera${hasArm ? ", the arm that moves it," : ""} and the board, as fast as in ` +
      "life.";
  return [wide(card(title, note, control, place))];
}
