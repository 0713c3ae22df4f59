// The page of `calibrato guide` as people use it: on a desk and on a phone, from the first hint to
// the report.
//
//   node guide_page.mjs PROGRAM RIG     calibrato, and examples/rig.yaml

import assert from "node:assert/strict";
import {spawn, spawnSync} from "node:child_process";
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from "node:fs";
import {tmpdir} from "node:os";
import {join} from "node:path";
import {after, before, describe, test} from "node:test";

import {assertFitsAcross, kDesk, kPhone, launch, openPage} from "./browser.mjs";

const [program, rig] = process.argv.slice(2);
const kPatience_ms = 120_000;
const browser = await launch();
const folder = mkdtempSync(join(tmpdir(), "calibrato_guide_page_"));
const recorded = join(folder, "recorded");
after(async () => {
  await browser.close();
  rmSync(folder, {recursive: true});
});

const kMotion = `carrier: free
base_pose: {xyz_m: [0.4, 0.3, 0.47], rpy_rad: [1.5708, 0.8, 1.5708]}
loops:
  - duration_s: 5.0
    coefficients: [0, 0, 0.05, 0, 0, 0,  0, 0, 0, 0, 0, 0,  0, 0.1, 0, 0, 0, 0,
                   0, -0.25, 0, 0, 0, 0,  0, 0, 0, 0, 0, 0,  0, 0, 0, 0, 0, 0]
`;

// The camera of the rig.
const kCamchain = `cam0:
  camera_model: pinhole
  intrinsics: [585.756, 585.756, 320.5, 240.5]
  distortion_model: none
  distortion_coeffs: []
  resolution: [640, 480]
  rostopic: /cam0/image_raw
`;

before(() => {
  writeFileSync(join(folder, "motion.yaml"), kMotion);
  writeFileSync(join(folder, "camchain.yaml"), kCamchain);
  const made = spawnSync(program, ["simulate", "--rig", rig, "--motion", join(folder, "motion.yaml"),
                                   "--fidelity", "rendered", "--out", recorded], {encoding: "utf8"});
  assert.equal(made.status, 0, made.stderr);
});

/** A guide that plays the recording slowly, and wants more than that can give. */
class RunningGuide {
  constructor(name, more) {
    this.stderr = "";
    this.process = spawn(program, [
      "guide", "--replay", recorded, "--target", join(recorded, "target.yaml"), "--cameras",
      join(folder, "camchain.yaml"), "--imu", join(recorded, "imu.yaml"), "--want", "time-ms=1e-6",
      "--out", join(folder, name), ...more,
    ], {stdio: ["ignore", "ignore", "pipe"]});
    this.process.stderr.on("data", (bytes) => {
      this.stderr += bytes;
    });
    this.exited = new Promise((resolve) => this.process.on("exit", resolve));
  }
  /** The newest of its addresses, once there are so many. */
  async address(count = 1) {
    for (const end = Date.now() + kPatience_ms; Date.now() < end;) {
      const said = [...this.stderr.matchAll(/open (http:\/\/\S+)/g)];
      if (said.length >= count) return said.at(-1)[1].replace("0.0.0.0", "127.0.0.1");
      await new Promise((resume) => setTimeout(resume, 50));
    }
    return assert.fail(`no address ${count}: ${this.stderr}`);
  }
  async stop() {
    if (this.process.exitCode === null) this.process.kill("SIGKILL");
    await this.exited;
  }
}

async function openGuide(address, screen) {
  const {origin} = new URL(address);
  const opened = await openPage(browser, screen, (url) => url.startsWith(`${origin}/`));
  opened.answer = await opened.page.goto(address);
  return opened;
}

/** Of the guide's picture: are there pixels of the ghost's outline, #ffd34d, and of white paper? */
function showsGhostAndImage() {
  const canvas = document.getElementById("view");
  const {data} = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  const shows = (colour) => {
    for (let i = 0; i < data.length; i += 4) {
      if (colour(data[i], data[i + 1], data[i + 2])) return true;
    }
    return false;
  };
  return shows((r, g, b) => r === 0xff && g === 0xd3 && b === 0x4d) &&
      shows((r, g, b) => Math.min(r, g, b) > 200);
}

async function assertGuides(page) {
  await page.waitForSelector("body[data-state=capturing]", {timeout: kPatience_ms});
  await page.waitForFunction(() => / s to go$/.test(document.getElementById("how").textContent),
                             null, {timeout: kPatience_ms});
  assert.match(await page.textContent("#words"), /\w/);
  await page.waitForFunction(showsGhostAndImage, null, {timeout: kPatience_ms});
  const wanted = await page.locator("#progress tr").allTextContents();
  assert.equal(wanted.length, 7);
  for (const row of wanted) assert.match(row, /±(\d|\?).* of \d.* (°|mm|ms)$/);
  assert.equal(await page.locator("#coverage tr").count(), 4);
  assert.ok(await page.isVisible("#end"));
  assert.ok(!(await page.isVisible("#report")));
  await assertFitsAcross(page);
}

describe("a guide that two browsers look at", () => {
  let guide, desk, phone;
  before(async () => {
    guide = new RunningGuide("two", ["--speed", "0.2"]);
    const address = await guide.address();
    [desk, phone] = [await openGuide(address, kDesk), await openGuide(address, kPhone)];
  });
  after(() => guide.stop());
  test("tells both what to do", async () => {
    await assertGuides(desk.page);
    await assertGuides(phone.page);
  });
  test("goes on", async () => {
    const numbers = await desk.page.textContent("#numbers");
    await desk.page.waitForFunction(
        (before) => document.getElementById("numbers").textContent !== before, numbers);
  });
  test("ends for both at the button of one", async () => {
    await phone.page.click("#end");
    for (const {page} of [desk, phone]) {
      await page.waitForSelector("#report", {timeout: kPatience_ms});
      assert.equal(await page.getAttribute("body", "data-state"), "done");
      assert.ok(!(await page.isVisible("#end")));
      await assertFitsAcross(page);
    }
  });
  test("leads to the report", async () => {
    for (const {page} of [desk, phone]) {
      await page.click("#report");
      await page.waitForSelector("html[data-state=drawn]",
                                 {state: "attached", timeout: kPatience_ms});
      assert.match(await page.textContent("h1"), /Camera-IMU calibration/);
      assert.equal(await page.locator(".plot-failed").count(), 0);
      await assertFitsAcross(page);
    }
  });
  test("has nothing to complain about", () => {
    assert.deepEqual([...desk.complaints, ...phone.complaints], []);
  });
  test("returns when nobody looks any more", async () => {
    await desk.page.close();
    await phone.page.close();
    const code = await guide.exited;
    assert.ok(code === 0 || code === 1, `exit ${code}: ${guide.stderr}`);
    const result = JSON.parse(readFileSync(join(folder, "two/calibration/result.json"), "utf8"));
    assert.equal(result.kind, "camera-imu");
  });
});

describe("a guide on the network", () => {
  let guide, first;
  before(() => {
    guide = new RunningGuide("network", ["--speed", "0.05", "--host", "0.0.0.0"]);
  });
  after(() => guide.stop());
  test("refuses whoever comes without its token", async () => {
    const address = await guide.address();
    const {origin} = new URL(address);
    for (const wrong of [`${origin}/`, `${origin}/?token=${"0".repeat(32)}`, `${origin}/report`]) {
      const {page, answer} = await openGuide(wrong, kPhone);
      assert.equal(answer.status(), 403, wrong);
      assert.match(await page.textContent("body"), /token/);
      assert.equal(await page.locator("#words").count(), 0);
      await page.close();
    }
  });
  test("lets the browser in that has it", async () => {
    first = await guide.address();
    const phone = await openGuide(first, kPhone);
    assert.equal(phone.answer.status(), 200);
    assert.ok(!phone.page.url().includes("token"));
    await phone.page.waitForSelector("body[data-state=capturing]", {timeout: kPatience_ms});
    // The same browser may come back.
    await phone.page.reload();
    await phone.page.waitForSelector("body[data-state=capturing]", {timeout: kPatience_ms});
    assert.deepEqual(phone.complaints, []);
  });
  test("has another token for the next browser", async () => {
    const second = await guide.address(2);
    assert.notEqual(second, first);
    const late = await openGuide(first, kDesk);
    assert.equal(late.answer.status(), 403);
    const desk = await openGuide(second, kDesk);
    assert.equal(desk.answer.status(), 200);
    await desk.page.waitForSelector("body[data-state=capturing]", {timeout: kPatience_ms});
    assert.deepEqual(desk.complaints, []);
  });
});
