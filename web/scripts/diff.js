// Two calibrations of one rig: do they differ, and by how many pixels.

const kAgreementLines = {
  agree: ["pass", "The two results agree: they differ by no more than chance."],
  differ: ["fail", "The two results differ, and by more than chance."],
  inconclusive: ["inconclusive", "Whether the two differ by more than chance is not known."],
};

function diffSummary(result) {
  const [verdict, line] =
      kAgreementLines[result.agreement] ?? ["unknown", "This comparison carries no verdict."];
  const details = list(result.cameras).flatMap((camera) => {
    const name = camera.name ?? "camera";
    if (isNumber(camera.rms_difference_px)) {
      return [`${name}: ${number(camera.rms_difference_px, 3)} px root mean square over the image`];
    }
    if (isNumber(camera.difference_px)) {
      return [`${name}: ${number(camera.difference_px, 3)} px at 1 rad/s`];
    }
    return [];
  });
  return {
    verdict, tag: result.agreement, line,
    details: details.length > 0 ? `${capitalised(details.join("; "))}.` : "",
    findings: list(result.findings),
  };
}

function scaled(x, factor) {
  return isNumber(x) ? factor * x : x;
}

function differenceCards(camera) {
  const name = camera.name ?? "camera";
  const numbers = card(`Difference of ${name}`,
                       "After the turn of the camera that neither result can know is taken out.",
                       facts([
                         ["models", list(camera.models).join(" and ")],
                         ["difference over the image [px]", number(camera.rms_difference_px, 3)],
                         ["to be expected [px]", number(camera.expected_rms_difference_px, 3)],
                         ["as large by chance", chanceText(camera.probability)],
                         ["tested by its", camera.tested ?? ""],
                         ["focal length, if only it changed [%]",
                          withSigma(scaled(camera.focal_change, 100),
                                    scaled(camera.focal_change_sigma, 100))],
                         ["as much by chance", isNumber(camera.focal_change_probability)
                           ? chanceText(camera.focal_change_probability) : ""],
                         ["turn taken out [rad]", vectorText(camera.rotation_rad, 3)],
                       ]));
  const T = camera.T_cn_cnm1;
  if (T) {
    numbers.append(element("h4", {}, "Pose to the camera before it"), facts([
      ["rotation [rad]", number(T.rotation_rad, 3)],
      ["translation [mm]", number(1000 * T.translation_m, 3)],
      ["as large by chance", chanceText(T.probability)],
    ]));
  }
  const map = camera.difference_px;
  const title = `Where ${name} differs`;
  const note = "How far apart the two see the same point at infinity.";
  if (list(map?.values_px).length < 2) {
    return [numbers, card(title, note, emptyNote("No map was handed over."))];
  }
  const resolution = list(camera.resolution).length === 2 ? camera.resolution : [640, 480];
  return [numbers, card(title, note, ...imageMap([{...map, name: ""}], resolution))];
}

// With an IMU: what was estimated, group by group.
function groupCard(group) {
  const rows = list(group.parameters).map((parameter) => [
    parameter.name ?? "", number(parameter.difference, 3), number(parameter.sigma, 3),
    isNumber(parameter.sigma) && parameter.sigma > 0
      ? number(Math.abs(parameter.difference) / parameter.sigma, 2) : "",
  ]);
  return card(capitalised(group.name ?? "parameters"),
              `As far apart by chance: ${chanceText(group.probability)}.`,
              table(["parameter [rad, m, s, px]", "second less first", "its sigma", "in sigmas"],
                    rows));
}

function pixelsCard(cameras) {
  return card("By how many pixels",
              "How far apart the two place a point that is known in the IMU's frame, at 1 rad/s, " +
                  "from 0.5 m to infinity: root mean square over the image.",
              table(["camera", "difference [px]", "to be expected [px]"],
                    cameras.map((camera) => [camera.name ?? "", number(camera.difference_px, 3),
                                             number(camera.expected_difference_px, 3)])));
}

function diffSection(result) {
  if (result.of === "camera-imu") {
    return [element("div", {class: "cards"}, pixelsCard(list(result.cameras)),
                    ...list(result.groups).map(groupCard))];
  }
  const cameras = list(result.cameras);
  const made = element("div", {class: "cards"}, ...cameras.flatMap(differenceCards));
  return cameras.length > 0 ? [made] : [emptyNote("No camera was compared.")];
}
