// Debian's chromium, moved by Playwright, and what it has to complain about.

import assert from "node:assert/strict";
import {execSync} from "node:child_process";

import {chromium} from "playwright-core";

/** For ctest's SKIP_RETURN_CODE. */
const kSkipped = 77;

// What chromium says of its own software rendering, not of a page.
const kOfTheDriver = [
  /GL Driver Message \(OpenGL, Performance/,
  /^Canvas2D: Multiple readback operations/,
];

export const kDesk = {viewport: {width: 1280, height: 900}};
export const kPhone = {
  viewport: {width: 390, height: 844}, deviceScaleFactor: 2, isMobile: true, hasTouch: true,
};

function chromiumHere() {
  try {
    return execSync("command -v chromium", {encoding: "utf8"}).trim();
  } catch {
    console.error("chromium is not installed: what the pages draw goes unchecked");
    process.exit(kSkipped);
  }
}

export function launch() {
  return chromium.launch({
    executablePath: chromiumHere(),
    args: ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--disable-quic"],
  });
}

/**
 * A page of its own context, and a list that grows with whatever is wrong with it: errors and
 * warnings of the console, exceptions, and requests to where it has no business.
 * @param allowed  of a request's URL: may it be asked for?
 */
export async function openPage(browser, screen, allowed) {
  const context = await browser.newContext({...screen, acceptDownloads: true});
  const page = await context.newPage();
  const complaints = [];
  page.on("console", (message) => {
    const text = message.text();
    if (!["error", "warning"].includes(message.type())) return;
    if (!kOfTheDriver.some((known) => known.test(text))) complaints.push(text);
  });
  page.on("pageerror", (error) => complaints.push(`exception: ${error.message}`));
  page.on("request", (request) => {
    const url = request.url();
    if (!/^(data|blob):/.test(url) && !allowed(url)) complaints.push(`request: ${url}`);
  });
  return {page, complaints};
}

export async function assertFitsAcross(page) {
  const [wanted, given] = await page.evaluate(() => {
    return [document.documentElement.scrollWidth, document.documentElement.clientWidth];
  });
  assert.ok(wanted <= given, `the page is ${wanted} px wide, its window ${given} px`);
}
