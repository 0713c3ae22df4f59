// The report page as people use it: on a desk and on a phone, every part of it clicked once.
//
//   node report_page.mjs FOLDER     the folder that write_report_pages wrote

import assert from "node:assert/strict";
import {readFileSync, statSync} from "node:fs";
import {join} from "node:path";
import {after, before, describe, test} from "node:test";
import {pathToFileURL} from "node:url";

import {assertFitsAcross, kDesk, kPhone, launch, openPage} from "./browser.mjs";
import {marksOf} from "./marks.mjs";

const folder = process.argv[2];
const kMostBytes = 8e6;
const kDrawn = "html[data-state=drawn]";
const browser = await launch();
after(() => browser.close());

async function openReport(name, screen) {
  const file = join(folder, name);
  assert.ok(statSync(file).size < kMostBytes, `${name} has ${statSync(file).size} bytes`);
  const url = pathToFileURL(file).href;
  const opened = await openPage(browser, screen, (asked) => asked === url);
  await opened.page.goto(url);
  await opened.page.waitForSelector(kDrawn, {state: "attached", timeout: 180_000});
  return opened;
}

/** The heading of the card that an element stands in. */
function cardOf(place) {
  return place.evaluate((element) => {
    const title = (name, inside) => inside?.querySelector(name)?.textContent;
    return `${title("h2", element.closest("section"))}: ${title("h3", element.closest(".card"))}`;
  });
}

/** The page's text as it would be read out; hidden details too. */
function textOf(page) {
  return page.evaluate(() => document.getElementById("report").textContent);
}

async function assertSays(page, texts) {
  const said = await textOf(page);
  for (const text of texts) assert.ok(said.includes(text), `the page does not say: ${text}`);
}

async function assertEverythingIsDrawn(page) {
  assert.equal(await page.locator(".plot-failed, .empty").count(), 0);
  assert.equal(await page.locator(".plot:not(.js-plotly-plot)").count(), 0);
  const places = await page.$$(".plot, .picture");
  assert.ok(places.length > 40, `${places.length} plots and pictures`);
  for (const place of places) {
    const marks = await place.evaluate(marksOf, 3);
    assert.ok(marks.length > 0, `nothing is drawn in ${await cardOf(place)}`);
  }
  for (const image of await page.$$(".plot-row img")) {
    assert.ok(await image.evaluate((img) => img.naturalWidth > 0));
  }
}

async function assertTabsLead(page) {
  const tabs = await page.$$(".page-nav a");
  assert.equal(tabs.length, await page.locator("section h2").count());
  for (const tab of tabs) {
    await tab.click();
    const [name, id] = await tab.evaluate((a) => [a.textContent, a.getAttribute("href").slice(1)]);
    const heading = page.locator(`#${id} h2`);
    assert.equal(await heading.textContent(), name);
    // At the top and below the tabs, if there is enough page below it to scroll so far.
    const isThere = await heading.evaluate((h2) => {
      const {top} = h2.getBoundingClientRect();
      const tabsEnd = document.querySelector(".page-nav").getBoundingClientRect().bottom;
      const isEnd = window.innerHeight + window.scrollY >= document.documentElement.scrollHeight - 1;
      return top >= tabsEnd - 1 && (isEnd ? top < window.innerHeight : top < 200);
    });
    assert.ok(isThere, `the tab ${name} does not lead to its section`);
  }
}

async function openDetails(page) {
  for (const summary of await page.$$("details > summary")) {
    await summary.click();
    assert.ok(await summary.evaluate((element) => element.parentElement.open));
  }
}

/** Rows in the order of their numbers, or of their letters; what is missing is last. */
function isSorted(cells, isUpwards) {
  const known = cells.filter((cell) => cell !== "–");
  if (cells.slice(0, known.length).includes("–")) return false;
  const isNumeric = known.every((cell) => !Number.isNaN(Number(cell)));
  const inOrder = isNumeric ? (a, b) => Number(a) <= Number(b) : (a, b) => a.localeCompare(b) <= 0;
  return known.slice(1).every((cell, i) => {
    return isUpwards ? inOrder(known[i], cell) : inOrder(cell, known[i]);
  });
}

async function assertTablesSort(page) {
  let numChanged = 0;
  for (const table of await page.$$("table:has(th.sorts)")) {
    const cells = (column) => table.evaluate((element, at) => {
      const firstText = (node) => {
        if (node.nodeType === Node.TEXT_NODE) return node.textContent;
        return [...node.childNodes].map(firstText).find((text) => text !== undefined);
      };
      return [...element.tBodies[0].rows].map((row) => firstText(row.cells[at]) ?? "");
    }, column);
    const heads = await table.$$("th.sorts");
    for (const [column, head] of heads.entries()) {
      const before = await cells(column);
      for (const direction of ["ascending", "descending"]) {
        await head.click();
        assert.equal(await head.getAttribute("aria-sort"), direction);
        const sorted = await cells(column);
        const where = `${await cardOf(table)}, column ${column}: ${sorted.join(" | ")}`;
        assert.ok(isSorted(sorted, direction === "ascending"), `not ${direction}: ${where}`);
        assert.deepEqual([...sorted].sort(), [...before].sort(), where);
        if (sorted.join() !== before.join()) ++numChanged;
      }
    }
  }
  assert.ok(numChanged > 20, `${numChanged} clicks changed an order`);
}

/** Moves over the marks of each plot until it says a value. */
async function assertPlotsTellValues(page) {
  for (const place of await page.$$(".plot, .picture:has(.picture-tip)")) {
    await place.scrollIntoViewIfNeeded();
    const tip = async () => place.evaluate((element) => {
      const label = element.querySelector(".hovertext, .picture-tip");
      return label && getComputedStyle(label).display !== "none" ? label.textContent : "";
    });
    let told = "";
    for (const [x, y] of await place.evaluate(marksOf, 25)) {
      await page.mouse.move(x - 1, y);
      await page.mouse.move(x, y);
      for (let tries = 0; tries < 6 && told === ""; ++tries) {
        await page.waitForTimeout(30);
        told = await tip();
      }
      if (told !== "") break;
    }
    assert.notEqual(told, "", `no value is told in ${await cardOf(place)}`);
    await page.mouse.move(1, 1);
  }
}

/** Rows of a list, as RFC 4180 writes them. */
function parsedCsv(text) {
  const rows = [[]];
  for (const [, quoted, plain, end] of text.matchAll(/(?:"((?:[^"]|"")*)"|([^",\n]*))(,|\n)/g)) {
    rows.at(-1).push(quoted === undefined ? plain : quoted.replaceAll('""', '"'));
    if (end === "\n") rows.push([]);
  }
  assert.deepEqual(rows.pop(), [], "the last line does not end");
  return rows;
}

async function downloaded(page, button, where) {
  const download = page.waitForEvent("download", {timeout: 60_000}).catch(() => null);
  await button.click();
  const saved = await download;
  assert.ok(saved, `${where}: nothing is saved`);
  return {name: saved.suggestedFilename(), text: readFileSync(await saved.path(), "utf8")};
}

async function assertDataCanBeTakenAlong(page) {
  const places = await page.$$(".plot, .picture");
  const saves = await page.$$(".save");
  assert.equal(saves.length, places.length, "some figure cannot be saved");
  for (const save of saves) {
    const where = await cardOf(save);
    const csv = await downloaded(page, await save.$("button:text-is('CSV')"), where);
    assert.match(csv.name, /^[a-z0-9-]+\.csv$/);
    const [head, ...rows] = parsedCsv(csv.text);
    assert.ok(head.length >= 2 && rows.length > 0, `${where}: ${csv.text.slice(0, 200)}`);
    assert.ok(rows.every((row) => row.length === head.length), `${where}: uneven rows`);
    assert.ok(rows.some((row) => row.some((cell) => cell !== "" && Number.isFinite(Number(cell)))),
              `${where}: no number in it`);
    const svg = await downloaded(page, await save.$("button:text-is('SVG')"), where);
    assert.match(svg.name, /^[a-z0-9-]+\.svg$/);
    const [root, numDrawn] = await page.evaluate((text) => {
      const parsed = new DOMParser().parseFromString(text, "image/svg+xml");
      return [parsed.documentElement.tagName,
              parsed.querySelectorAll("path, rect, image, circle").length];
    }, svg.text);
    assert.equal(root, "svg", `${where}: ${svg.text.slice(0, 200)}`);
    assert.ok(numDrawn > 1, `${where}: nothing in the picture`);
  }
}

/** Every box, button, slider and choice once. */
async function useControls(page) {
  for (const box of await page.$$(".control input[type=checkbox], .control input[type=radio]")) {
    const before = await box.isChecked();
    await box.click();
    const isRadio = await box.getAttribute("type") === "radio";
    assert.equal(await box.isChecked(), isRadio || !before);
    if (!isRadio) await box.click();
  }
  for (const slider of await page.$$(".control input[type=range]")) {
    const control = await slider.evaluateHandle((element) => element.closest(".control"));
    await slider.focus();
    const said = [];
    for (const key of ["Home", "End"]) {
      await page.keyboard.press(key);
      said.push(await control.evaluate((element) => element.textContent));
    }
    assert.notEqual(said[0], said[1], `${await cardOf(slider)}: a slider changes nothing`);
  }
  for (const select of await page.$$(".control select")) {
    const numChoices = await select.evaluate((element) => element.options.length);
    assert.ok(numChoices > 1);
    await select.selectOption({index: numChoices - 1});
  }
}

async function assertMotionsPlay(page) {
  const players = page.locator(".control:has(.clock)");
  assert.ok(await players.count() > 0);
  for (let i = 0; i < await players.count(); ++i) {
    const clock = players.nth(i).locator(".clock");
    const button = players.nth(i).locator("button");
    const place = players.nth(i).locator("xpath=..").locator(".plot");
    const camera = () => place.evaluate((element) => element.data[0].x.slice(0, 3));
    const [time, before] = [await clock.textContent(), await camera()];
    await button.click();
    assert.equal(await button.textContent(), "Pause");
    await page.waitForFunction(([element, text]) => element.textContent !== text,
                               [await clock.elementHandle(), time]);
    await button.click();
    assert.equal(await button.textContent(), "Play");
    assert.notDeepEqual(await camera(), before);
  }
}

async function assertPrints(page) {
  await page.emulateMedia({media: "print"});
  for (const name of [".save", ".page-nav"]) {
    assert.ok(!(await page.locator(name).first().isVisible()), `${name} would be printed`);
  }
  const pdf = (await page.pdf({format: "A4"})).toString("latin1");
  assert.ok(pdf.startsWith("%PDF-"));
  const numPages = pdf.match(/\/Type\s*\/Page\b/g)?.length ?? 0;
  assert.ok(numPages >= 10, `${numPages} pages of paper`);
  await page.emulateMedia({media: null});
  assert.equal(await page.locator("body.printing").count(), 0);
}

const kWords = [
  "Beyond the limit of jerk.",
  "shoulder <pan>",
  "Usable, with the reservations below.",
  "the board's size varies little",
  // Of two cameras, each with its own pictures; the second is drawn by angles.
  "Baseline 83.03",
  "How far the lens moves a point",
  "What the lens does to angles",
  "At 1.2 m: median 0.075 px, worst 0.3 px.",
  "left26.jpg (7.1 px)",
  "The recording does not determine the result.",
  "translation along y is not observable",
  "gyroscope residuals 1.1 times the stated noise",
  "This recording can be calibrated with; it could be better.",
  "record 15 s more, rotate about x",
  "1, longest 0.43 s",
  "Where cam0 saw corners",
  "below 0.00003 (95 %)",
  "Best return 2.318 over 300 episodes.",
  "Errors of both networks",
  "Convergence of the search",
  "reward loss not finite: back to episode 150",
  "learned has 0.55 times the error of handcrafted (95 % interval 0.495 to 0.605), over 40 rigs: " +
      "better, and more than chance.",
  "learned at random's path has 0.31 times the error of random (95 % interval 0.260 to 0.358), " +
      "over 40 rigs: better, and more than chance.",
  "3 rows of 60 trials, of which 3 failed.",
  "Extrinsic error against path",
  "The motions, played",
  "The learned motion, played",
  "0.0 of 20 s",
  "The two results differ, and by more than chance.",
  "Cam0: 0.163 px at 1 rad/s.",
  "3 recordings lie further apart than their covariances say.",
  "Cam0 lens: sigmas times 2.12.",
];

const kWordsOfWhatIsWrong = [
  "Nothing is known of its joints.",
  "This page cannot draw results of kind “horoscope”.",
  "\"luck\": 7",
  "Do not use this calibration.",
  "No camera was calibrated.",
  "No episode of the training was handed over.",
  "This part could not be drawn",
  "Nothing was compared.",
  "There is no estimate.",
  "No camera was compared.",
  "Nothing was merged.",
  "<b id=\"evil\">bold</b>",
];

/** Opens a report, and tells of it: `tests` is called with a function that returns the page. */
function describeReport(title, name, screen, tests) {
  describe(title, () => {
    let opened;
    before(async () => {
      opened = await openReport(name, screen);
    });
    after(() => opened?.page.close());
    tests((words, check) => test(words, () => check(opened.page)));
    test("has nothing to complain about", () => assert.deepEqual(opened.complaints, []));
  });
}

describeReport("a report of every kind, on a desk", "every-kind.html", kDesk, (it) => {
  it("says what it should", (page) => assertSays(page, kWords));
  it("draws every plot and picture", assertEverythingIsDrawn);
  it("fits its window", assertFitsAcross);
  it("has tabs that lead to each section", assertTabsLead);
  it("opens its details", openDetails);
  it("sorts its tables", assertTablesSort);
  it("tells values under the pointer", assertPlotsTellValues);
  it("gives its data and pictures away", assertDataCanBeTakenAlong);
  it("plays its motions", assertMotionsPlay);
  it("obeys its controls", useControls);
  it("prints", assertPrints);
  it("draws every plot still", assertEverythingIsDrawn);
});

describeReport("a report of every kind, on a phone", "every-kind.html", kPhone, (it) => {
  it("draws every plot and picture", assertEverythingIsDrawn);
  it("fits its window", assertFitsAcross);
  it("has tabs that lead to each section", assertTabsLead);
  it("opens its details", openDetails);
  it("fits with those open", assertFitsAcross);
  it("plays its motions", assertMotionsPlay);
  it("obeys its controls", useControls);
});

for (const [where, screen] of [["a desk", kDesk], ["a phone", kPhone]]) {
  describeReport(`a report of what is missing or wrong, on ${where}`, "wrong.html", screen, (it) => {
    it("says so in words", async (page) => {
      await assertSays(page, kWordsOfWhatIsWrong);
      assert.ok(!(await textOf(page)).includes("undefined"));
      assert.equal(await page.locator("#evil").count(), 0);
    });
    it("fits its window", assertFitsAcross);
  });
}
