// Two calibrations of the same cameras: do they differ, and by how many pixels.

const kAgreementLines = {
  agree: ["pass", "The two results agree: they differ by no more than chance."],
  differ: ["fail", "The two results differ, and by more than chance."],
  inconclusive: ["inconclusive", "Whether the two differ by more than chance is not known."],
};

function diffSummary(result) {
  const [verdict, line] =
      kAgreementLines[result.agreement] ?? ["unknown", "This comparison carries no verdict."];
  const details = list(result.cameras)
      .filter((camera) => isNumber(camera.rms_difference_px))
      .map((camera) => `${camera.name ?? "camera"}: ${number(camera.rms_difference_px, 3)} px ` +
                       "root mean square over the image");
  return {
    verdict, tag: result.agreement, line,
    details: details.length > 0 ? `${capitalised(details.join("; "))}.` : "",
    findings: list(result.findings),
  };
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

function diffSection(result) {
  const cameras = list(result.cameras);
  const made = element("div", {class: "cards"}, ...cameras.flatMap(differenceCards));
  return cameras.length > 0 ? [made] : [emptyNote("No camera was compared.")];
}
