// Where plots and pictures have drawn something. These functions run in the page.

/**
 * What was drawn of data, in a plot or a picture, as points of the window that lie on it; at most
 * `most`, spread over all of them. Axes and grounds are grey; what stands for data has a colour.
 */
export async function marksOf(place, most) {
  const spread = (points) => {
    const step = Math.max(1, Math.ceil(points.length / most));
    return points.filter((_, i) => i % step === 0);
  };
  /** Points of strong colour of an image, of which so many pixels are one of the window. */
  const coloured = (context, width, height, fine) => {
    const {data} = context.getImageData(0, 0, width, height);
    const points = [];
    for (let y = 0; y < height; y += 2) {
      for (let x = 0; x < width; x += 2) {
        const [r, g, b, a] = data.subarray(4 * (y * width + x), 4 * (y * width + x) + 4);
        if (a > 128 && Math.max(r, g, b) - Math.min(r, g, b) > 60) points.push([x / fine, y / fine]);
      }
    }
    return points;
  };
  const from = (element, points) => {
    const {left, top} = element.getBoundingClientRect();
    return spread(points).map(([x, y]) => [left + x, top + y]);
  };

  if (place.matches(".picture")) {
    const canvas = place.querySelector("canvas");
    const fine = canvas.width / canvas.clientWidth;
    return from(canvas, coloured(canvas.getContext("2d"), canvas.width, canvas.height, fine));
  }
  const scene = place._fullLayout?.scene?._scene;
  if (scene) {
    const photo = new Image();
    photo.src = scene.toImage("png");
    await photo.decode();
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [photo.width, photo.height];
    const context = copy.getContext("2d", {willReadFrequently: true});
    context.drawImage(photo, 0, 0);
    const canvas = place.querySelector("canvas");
    return from(canvas, coloured(context, copy.width, copy.height, copy.width / canvas.clientWidth));
  }
  const points = [];
  const area = place.querySelector(".nsewdrag").getBoundingClientRect();
  const marks = [...place.querySelectorAll(".plot .point, .plot .points path, .plot .box, " +
                                           ".plot .heatmaplayer image")];
  for (const mark of marks) {
    const {left, top, width, height} = mark.getBoundingClientRect();
    if (width + height > 0) points.push([left + width / 2, top + height / 2]);
  }
  for (const line of place.querySelectorAll(".plot path.js-line")) {
    const length = line.getTotalLength();
    for (let k = 0; length > 0 && k <= 10; ++k) {
      const at = line.getPointAtLength(0.1 * k * length).matrixTransform(line.getScreenCTM());
      points.push([at.x, at.y]);
    }
  }
  return spread(points.filter(([x, y]) => {
    return x >= area.left && x <= area.right && y >= area.top && y <= area.bottom;
  }));
}
