// The page, operated as by a user.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import type { Page } from "playwright-core";
import { brief, shortened } from "../src/elements.ts";
import { tickTexts } from "../src/ticks.ts";
import { PICTURES, PROGRAM, ROOT, browser, open, skip, started, until, view } from "./browser.ts";

/** The state of the page, as visible in its console. */
interface Seen {
  frame: { time: number; paused: boolean; rows: Record<string, { count: number; data: Float32Array }> };
  stage: {
    extent: number;
    overlays: { forceScale: number; arrows(): [number[], number[]][]; discCount: number };
    camera: { projectionMatrix: Matrix; matrixWorldInverse: Matrix };
    poses: Matrix[];
    border: { visible: boolean };
    labels: { count: number };
    free(): { x: number; y: number; width: number; height: number };
  };
  plots: { counts(): number[]; lasts(): number[][]; spans(): { times: [number, number]; values: [number, number] }[] };
}
interface Matrix {
  elements: number[];
}
declare const window: { clench: Seen };

const time = (page: Page) => page.evaluate(() => window.clench.frame.time);
const height = (page: Page, body: number) =>
  page.evaluate((body) => window.clench.frame.rows.bodies.data[7 * body + 2], body);

/** Returns the share of brown pixels in a part of the picture (0 to 1 along both sides). */
async function detail(page: Page, [left, top, right, bottom]: number[]): Promise<number> {
  return page.evaluate(
    ([left, top, right, bottom]) => {
      const canvas = document.querySelector("canvas")!;
      const copy = document.createElement("canvas");
      copy.width = canvas.width;
      copy.height = canvas.height;
      const pen = copy.getContext("2d")!;
      pen.drawImage(canvas, 0, 0);
      const [x, y] = [Math.floor(left * copy.width), Math.floor(top * copy.height)];
      const [width, height] = [Math.floor((right - left) * copy.width), Math.floor((bottom - top) * copy.height)];
      const { data } = pen.getImageData(x, y, width, height);
      let brown = 0;
      // The humanoid's colour: red above green above blue.
      for (let at = 0; at < data.length; at += 4) {
        if (data[at] > data[at + 1] + 12 && data[at + 1] > data[at + 2] + 8) brown += 1;
      }
      return brown / (data.length / 4);
    },
    [left, top, right, bottom],
  );
}

/** Returns the highest body and its position on the screen. */
function topBody(page: Page): Promise<{ body: number; x: number; y: number }> {
  return page.evaluate(() => {
    const { stage, frame } = window.clench as unknown as {
      stage: { camera: never; poses: { elements: number[] }[] };
      frame: Seen["frame"];
    };
    const rows = frame.rows.bodies;
    let top = 1;
    for (let body = 1; body < rows.count; body++) {
      if (rows.data[7 * body + 2] > rows.data[7 * top + 2]) top = body;
    }
    const place = stage.poses[top].elements.slice(12, 15);
    const camera = stage.camera as { matrixWorldInverse: { elements: number[] }; projectionMatrix: { elements: number[] } };
    const times = (m: number[], v: number[]) => [0, 1, 2, 3].map((i) => m[i] * v[0] + m[i + 4] * v[1] + m[i + 8] * v[2] + m[i + 12] * v[3]);
    const [x, y, , w] = times(camera.projectionMatrix.elements, times(camera.matrixWorldInverse.elements, [...place, 1]));
    return { body: top, x: ((x / w + 1) / 2) * innerWidth, y: ((1 - y / w) / 2) * innerHeight };
  });
}

test("ticks of plots differ from their neighbours", () => {
  assert.deepEqual(tickTexts([0, 2.5, 5]), ["0", "2.5", "5"]);
  assert.deepEqual(tickTexts([1.222e-4, 1.2222e-4, 1.2224e-4]), ["1.222e-4", "1.2222e-4", "1.2224e-4"]);
  assert.deepEqual(tickTexts([1000, 1000.25, 1000.5]), ["1000", "1000.25", "1000.5"]);
  assert.deepEqual(tickTexts([-1.000002, -1.000001, -1]), ["-1.000002", "+1e-6", "+2e-6"]);
  assert.deepEqual(tickTexts([7]), ["7"]);
  assert.deepEqual(tickTexts([]), []);
});

test("names keep both ends, and what rounding leaves of nothing is nothing", () => {
  assert.equal(shortened("right_shoulder_x", 13), "right_…lder_x");
  assert.equal(shortened("knee", 13), "knee");
  assert.deepEqual([-3.74e-19, 0, 2.5e-4, 12.34567, 1234.5].map(brief), ["0", "0", "2.50e-4", "12.346", "1234.5"]);
});

test("the humanoid is seen where it stands", { skip }, async () => {
  const program = await view("models/humanoid.xml", "--keyframe", "standing", "--paused");
  try {
    const page = await open(browser, program.url);
    await page.waitForTimeout(500);
    assert.match(await page.title(), /humanoid/);
    // The middle of the part of the picture that the panel and the plots leave free.
    const middle = await detail(page, [0.25, 0.2, 0.45, 0.7]);
    const corner = await detail(page, [0.02, 0.15, 0.15, 0.5]);
    assert.ok(middle > 0.06, `the robot fills ${middle} of the middle`);
    assert.ok(corner < 0.01, `and ${corner} of the left edge`);
    await page.screenshot({ path: join(PICTURES, "humanoid.png") });
    await page.close();
  } finally {
    await program.end();
  }
});

test("pause, step, reset and keys do what they say", { skip }, async () => {
  const program = await view("models/box_stack.xml");
  try {
    const page = await open(browser, program.url);
    await until(page, () => window.clench.frame.time > 0.05);
    await page.click("#pause");
    await until(page, () => window.clench.frame.paused);
    const still = await time(page);
    await page.waitForTimeout(300);
    assert.equal(await time(page), still);
    await page.click("#step");
    await until(page, (still) => window.clench.frame.time > still, still);
    const timestep = (await time(page)) - still;
    assert.ok(timestep > 0 && timestep < 0.011, `${timestep}`);
    await page.locator("body").press("Backspace");
    await until(page, () => window.clench.frame.time === 0);
    assert.ok((await page.evaluate(() => window.clench.plots.counts()))[0] > 0);
    // Seek to any moment of the past, and back to the present.
    await page.click("#pause");
    await until(page, () => window.clench.frame.time > 0.4);
    const past = page.locator("#past");
    await past.fill("0.1");
    await until(page, () => window.clench.frame.paused && Math.abs(window.clench.frame.time - 0.1) < 0.02);
    await past.fill("0.3");
    await until(page, () => Math.abs(window.clench.frame.time - 0.3) < 0.02);
    await page.close();
  } finally {
    await program.end();
  }
});

test("the time of a step is told by stage", { skip }, async () => {
  const program = await view("models/humanoid.xml");
  try {
    const page = await open(browser, program.url);
    await page.locator(".plot select").first().selectOption({ label: "time by stage (µs)" });
    await until(page, () => window.clench.plots.counts()[0] > 5);
    assert.deepEqual(await page.locator(".plot").first().locator(".parts span").allTextContents(), [
      "kinematics",
      "collision",
      "forces",
      "assembly",
      "solve",
      "rest",
    ]);
    const [sums, step] = await page.evaluate(() => [
      window.clench.plots.lasts()[0],
      window.clench.frame.rows.plots.data[7],
    ]);
    for (let k = 1; k < sums.length; k++) assert.ok(sums[k - 1] > sums[k], `${sums}`);
    assert.ok(sums.length === 6 && sums[5] > 0 && sums[0] <= step && sums[0] > 0.3 * step, `${sums} of ${step}`);
    await page.close();
  } finally {
    await program.end();
  }
});

test("a body follows the pointer that drags it, and only with the key", { skip }, async () => {
  const program = await view("models/box_stack.xml");
  try {
    const page = await open(browser, program.url);
    await page.waitForTimeout(800);
    const at = await topBody(page);
    const before = await height(page, at.body);
    await page.keyboard.down("Control");
    await page.mouse.move(at.x, at.y);
    await page.mouse.down();
    await page.mouse.move(at.x, at.y - 120, { steps: 4 });
    await until(page, ({ body, before }) => window.clench.frame.rows.bodies.data[7 * body + 2] > before + 0.03, {
      body: at.body,
      before,
    });
    assert.equal(await page.evaluate(() => window.clench.frame.rows.drag.count), 1);
    await page.mouse.up();
    await page.keyboard.up("Control");
    await until(page, () => window.clench.frame.rows.drag.count === 0);
    // The right button rotates it instead. The reset puts the body back where it rests: one that falls is missed.
    await page.locator("body").press("Backspace");
    await until(page, ({ body, before }) => Math.abs(window.clench.frame.rows.bodies.data[7 * body + 2] - before) < 0.01, {
      body: at.body,
      before,
    });
    const now = await topBody(page);
    await page.keyboard.down("Control");
    await page.mouse.move(now.x, now.y);
    await page.mouse.down({ button: "right" });
    await page.mouse.move(now.x + 60, now.y, { steps: 3 });
    await until(page, (body) => {
      const { turn, bodies } = window.clench.frame.rows;
      return turn.count === 1 && Math.abs(bodies.data[7 * body + 6]) > 0.05;
    }, now.body);
    await page.mouse.up({ button: "right" });
    await page.keyboard.up("Control");
    await until(page, () => window.clench.frame.rows.turn.count === 0);
    await page.close();
  } finally {
    await program.end();
  }
});

test("arrows are as long as contact forces are strong", { skip }, async () => {
  const program = await view("models/box_stack.xml");
  try {
    const page = await open(browser, program.url);
    await until(page, () => window.clench.frame.time > 1);
    await page.click("#pause");
    await until(page, () => window.clench.frame.paused);
    await page.waitForTimeout(200);
    const { drawn, forces } = await page.evaluate(() => {
      const { stage, frame } = window.clench;
      const { data, count } = frame.rows.contacts;
      const forces = Array.from({ length: count }, (_, row) => data[22 * row + 12]);
      const length = ([from, to]: [number[], number[]]) => Math.hypot(...to.map((x, k) => x - from[k]));
      const drawn = stage.overlays.arrows().map((arrow) => length(arrow) / stage.overlays.forceScale);
      return { drawn, forces };
    });
    const strongest = Math.max(...forces);
    assert.ok(strongest > 0);
    assert.ok(Math.abs(Math.max(...drawn) / strongest - 1) < 1e-4, `${drawn} ${forces}`);
    await page.close();
  } finally {
    await program.end();
  }
});

test("a contact that sticks shows how far it has moved", { skip }, async () => {
  const program = await view("models/pinch.xml", "--stiction");
  try {
    const page = await open(browser, program.url);
    await until(page, () => {
      const { frame, stage } = window.clench;
      const { data, count } = frame.rows.contacts;
      if (frame.time < 1 || count === 0) return false;
      // The block hangs from its fingers by less than a millimetre.
      const moved = Array.from({ length: count }, (_, row) => Math.hypot(data[22 * row + 20], data[22 * row + 21]));
      const longest = 300 * Math.max(...moved);
      const lengths = stage.overlays.arrows().map(([from, to]: number[][]) => Math.hypot(...to.map((x, k) => x - from[k])));
      return longest > 1e-4 && longest < 0.3 && lengths.some((length: number) => Math.abs(length / longest - 1) < 1e-3);
    });
    await page.close();
  } finally {
    await program.end();
  }
});

test("what two fingers pinch has the arrows of each on its own side", { skip }, async () => {
  const program = await view("models/pinch.xml");
  try {
    const page = await open(browser, program.url);
    await until(page, () => window.clench.frame.time > 0.3 && window.clench.frame.rows.contacts.count > 0);
    await page.click("#pause");
    await until(page, () => window.clench.frame.paused);
    await page.waitForTimeout(200);
    const arrows = await page.evaluate(() => window.clench.stage.overlays.arrows());
    const pressing = arrows.map(([from, to]) => [from[0], to[0]]).filter(([from, to]) => Math.abs(to - from) > 0.02);
    assert.ok(pressing.length >= 2);
    // They start at the faces of the block and point away from it.
    for (const [from, to] of pressing) assert.ok(Math.abs(from) > 0.045 && Math.abs(to) > Math.abs(from), `${pressing}`);
    assert.ok(pressing.some(([from]) => from < 0) && pressing.some(([from]) => from > 0));
    await page.screenshot({ path: join(PICTURES, "pinch.png") });
    await page.close();
  } finally {
    await program.end();
  }
});

test("of a pile the largest contacts are seen alone, if that is wished", { skip }, async () => {
  const program = await view("models/pile.xml");
  try {
    const page = await open(browser, program.url);
    await until(page, () => window.clench.frame.rows.contacts.count > 100);
    await page.click("#pause");
    await until(page, () => window.clench.frame.paused);
    await page.waitForTimeout(500);
    const counts = () => page.evaluate(() => [window.clench.stage.overlays.discCount, window.clench.frame.rows.contacts.count]);
    let [seen, all] = await counts();
    assert.equal(seen, all);
    await page.getByLabel("largest 50").click();
    await until(page, () => window.clench.stage.overlays.discCount === 50);
    [seen, all] = await counts();
    assert.ok(all > 100);
    await page.screenshot({ path: join(PICTURES, "pile.png") });
    await page.close();
  } finally {
    await program.end();
  }
});

test("the first view shows the whole model between the controls", { skip }, async () => {
  for (const model of ["models/humanoid.xml", "models/gripper/gripper.urdf"]) {
    const program = await view(model, "--paused");
    try {
      const page = await open(browser, program.url);
      await page.setViewportSize({ width: 1440, height: 900 });
      await page.reload();
      await until(page, () => "clench" in window && window.clench.frame.paused);
      const { free, places } = await page.evaluate(() => {
        const { stage, frame } = window.clench;
        const times = (m: number[], v: number[]) => [0, 1, 2, 3].map((i) => m[i] * v[0] + m[i + 4] * v[1] + m[i + 8] * v[2] + m[i + 12] * v[3]);
        const rows = Array.from({ length: frame.rows.bodies.count - 1 }, (_, k) => [...frame.rows.bodies.data.subarray(7 * (k + 1), 7 * (k + 1) + 3), 1]);
        const places = rows.map((row) => {
          const [x, y, , w] = times(stage.camera.projectionMatrix.elements, times(stage.camera.matrixWorldInverse.elements, row));
          return [((x / w + 1) / 2) * innerWidth, ((1 - y / w) / 2) * innerHeight];
        });
        return { free: stage.free(), places };
      });
      const [right, bottom] = [free.x + free.width, free.y + free.height];
      assert.ok(right < 1200 && bottom < 800, `${right} ${bottom}`);
      for (const [x, y] of places) assert.ok(x > free.x && x < right && y > free.y && y < bottom, `${model}: ${x} ${y}`);
      const middle = (values: number[]) => (Math.min(...values) + Math.max(...values)) / 2;
      assert.ok(Math.abs(middle(places.map(([x]) => x)) / (free.x + free.width / 2) - 1) < 0.2);
      await page.screenshot({ path: join(PICTURES, `first-${model.split("/").at(-1)}.png`) });
      await page.close();
    } finally {
      await program.end();
    }
  }
});

test("an equality that is switched off lets go", { skip }, async () => {
  const program = await view("models/toggled_weld.xml");
  try {
    const page = await open(browser, program.url);
    const box = page.locator("#equalities input").first();
    const on = await box.isChecked();
    await box.click();
    await until(page, (on) => (window.clench.frame.rows.eq_active.data[0] > 0) !== on, on);
    await page.close();
  } finally {
    await program.end();
  }
});

test("environments stand side by side, and one of them is chosen", { skip }, async () => {
  const program = await view("models/pendulum.xml", "--envs", "5", "--noise", "0.5", "--paused");
  try {
    const page = await open(browser, program.url);
    await until(page, () => window.clench.frame.rows.envs.count === 5);
    assert.ok((await page.evaluate(() => window.clench.frame.rows.poses.count)) > 5);
    await until(page, () => window.clench.stage.border.visible && window.clench.stage.labels.count === 5);
    await page.screenshot({ path: join(PICTURES, "grid.png") });
    await page.locator("#grid").selectOption("1");
    await until(page, () => window.clench.frame.rows.envs.count === 1);
    await until(page, () => !window.clench.stage.border.visible && window.clench.stage.labels.count === 0);
    const first = await page.evaluate(() => window.clench.frame.rows.qpos.data[0]);
    await page.locator("#env").fill("3");
    await page.locator("#env").press("Enter");
    await until(page, () => window.clench.frame.rows.chosen.data[0] === 3);
    assert.notEqual(await page.evaluate(() => window.clench.frame.rows.qpos.data[0]), first);
    await page.close();
  } finally {
    await program.end();
  }
});

test("a page whose program has ended says so", { skip }, async () => {
  const program = await view("models/pendulum.xml");
  const page = await open(browser, program.url);
  await program.end();
  await page.waitForSelector("#notice:not([hidden])");
  assert.match((await page.textContent("#notice")) ?? "", /ended/);
  await page.close();
});

test("a page finds a program again that was started anew", { skip }, async () => {
  const environment = { CLENCH_VIEW_TOKEN: "a-token-for-this-test-alone" };
  const start = (model: string, port: string) =>
    started(PROGRAM, ["view", "--no-open", model, "--port", port], environment);
  let program = await start("models/pendulum.xml", "0");
  const port = new URL(program.url).port;
  const page = await open(browser, program.url);
  await program.end();
  await page.waitForSelector("#notice:not([hidden])");
  program = await start("models/box_stack.xml", port);
  try {
    await page.waitForSelector("#notice", { state: "hidden" });
    await until(page, () => document.title.startsWith("box") && window.clench.frame.rows.contacts.count > 0);
    await page.close();
  } finally {
    await program.end();
  }
});

test("limits and equalities push with arrows, and islands have colours", { skip }, async () => {
  const program = await view("models/toggled_weld.xml", "--keyframe", "touching", "--paused");
  try {
    const page = await open(browser, program.url);
    await page.locator("#equalities input").first().click();
    for (let k = 0; k < 9; k++) await page.click("#step");
    await until(page, () => window.clench.frame.rows.pushes.count > 0);
    const [drawn, row] = await page.evaluate(() => {
      const { stage, frame } = window.clench;
      const length = ([from, to]: [number[], number[]]) => Math.hypot(...to.map((x, k) => x - from[k]));
      const lengths = stage.overlays.arrows().map((arrow) => length(arrow) / stage.overlays.forceScale);
      return [lengths, [...frame.rows.pushes.data.slice(0, 12)]];
    });
    const force = Math.hypot(row[6], row[7], row[8]);
    assert.ok(drawn.some((length) => Math.abs(length / force - 1) < 1e-4), `${drawn} ${row}`);
    assert.ok(await page.evaluate(() => [...window.clench.frame.rows.islands.data].some((first) => first >= 0)));
    await page.close();
  } finally {
    await program.end();
  }
});

/** Two by two pixels: red, green, blue, white. */
const FOUR = "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAEklEQVR4nGP4z8DAAMIM/4EAAB/uBfsL2WiLAAAAAElFTkSuQmCC";

/** Returns a model with a picture on a box and on a sphere, under its own light, seen from above. */
function pictured(): string {
  const folder = mkdtempSync(join(tmpdir(), "clench-pictured-"));
  writeFileSync(join(folder, "four.png"), Buffer.from(FOUR, "base64"));
  const path = join(folder, "pictured.xml");
  writeFileSync(
    path,
    `<mujoco><visual><headlight active="0"/></visual>
       <asset><texture name="four" type="2d" file="four.png"/><texture name="around" type="cube" file="four.png"/>
         <material name="four" texture="four"/><material name="around" texture="around"/></asset>
       <worldbody><light type="directional" diffuse="1 1 1"/><camera name="above" pos="0 0 3" fovy="45"/>
         <geom type="box" size=".5 .5 .1" material="four"/><geom pos="1 0 0" size=".2" material="around"/></worldbody></mujoco>`,
  );
  return path;
}

/** Returns the colours around the middle: upper left, upper right, lower left, lower right. */
function quarters(page: Page): Promise<number[][]> {
  return page.evaluate(() => {
    const canvas = document.querySelector("#view canvas") as HTMLCanvasElement;
    const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
    const pen = copy.getContext("2d")!;
    pen.drawImage(canvas, 0, 0);
    const [x, y, far] = [copy.width / 2, copy.height / 2, copy.height / 20];
    return [[-1, -1], [1, -1], [-1, 1], [1, 1]].map(([a, b]) => [...pen.getImageData(x + a * far, y + b * far, 1, 1).data.slice(0, 3)]);
  });
}

async function seesPicture(page: Page, name: string): Promise<void> {
  await page.locator("#bar select").filter({ hasText: "above" }).selectOption({ label: "above" });
  // Highlights add white to all colours.
  const parts = (colours: number[][]) => colours.map((rgb) => rgb.map((part) => part > 0.85 * Math.max(...rgb)));
  const expected = [[true, false, false], [false, true, false], [false, false, true], [true, true, true]];
  for (let k = 0; JSON.stringify(parts(await quarters(page))) !== JSON.stringify(expected); k++) {
    assert.ok(k < 40, `${await quarters(page)}`);
    await page.waitForTimeout(250);
  }
  // The light comes from straight above, so white has its full brightness.
  assert.ok(Math.min(...(await quarters(page))[3]) > 200, `${await quarters(page)}`);
  await page.screenshot({ path: join(PICTURES, name) });
}

test("pictures of files lie on things, under the light of the file", { skip }, async () => {
  const model = pictured();
  const program = await view(model, "--paused");
  try {
    const page = await open(browser, program.url);
    await seesPicture(page, "pictured.png");
    await page.close();
  } finally {
    await program.end();
  }
  // A recording contains each picture once.
  const file = join(mkdtempSync(join(tmpdir(), "clench-recording-")), "pictured.html");
  const done = spawnSync(PROGRAM, ["simulate", model, "--steps", "3", "--record", file], { cwd: ROOT, encoding: "utf8" });
  assert.equal(done.status, 0, done.stderr);
  const scene = readFileSync(file, "utf8").match(/"png":"(\w|[+/=])+"/g) ?? [];
  assert.equal(scene.length, 2);
  const page = await open(browser, `file://${file}`);
  await seesPicture(page, "pictured-recording.png");
  await page.close();
});

test("the bar is one line, and hides no button", { skip }, async () => {
  const program = await view("models/humanoid.xml", "--paused");
  try {
    const page = await open(browser, program.url);
    for (const width of [1000, 1100, 1400]) {
      await page.setViewportSize({ width, height: 600 });
      const [height, right, panel] = await page.evaluate(() => {
        const bar = document.getElementById("bar")!;
        const ends = [...bar.children].map((part) => part.getBoundingClientRect().right);
        return [bar.clientHeight, Math.max(...ends), document.getElementById("panel")!.getBoundingClientRect().left];
      });
      assert.ok(height < 50, `${height} px high at ${width}`);
      assert.ok(right < panel, `the bar ends at ${right}, the panel begins at ${panel}`);
      await page.screenshot({ path: join(PICTURES, `bar-${width}.png`) });
    }
    await page.close();
  } finally {
    await program.end();
  }
});

test("what was seen last is saved as a page that replays it", { skip }, async () => {
  const program = await view("models/box_stack.xml");
  const file = join(mkdtempSync(join(tmpdir(), "clench-saved-")), "saved.html");
  try {
    const page = await open(browser, program.url);
    await until(page, () => window.clench.frame.time > 0.3);
    const [download] = await Promise.all([page.waitForEvent("download"), page.locator("#save").selectOption("5")]);
    await download.saveAs(file);
    await page.close();
  } finally {
    await program.end();
  }
  const page = await open(browser, `file://${file}`);
  await until(page, () => window.clench.frame.time > 0.1);
  await page.close();
});

test("a recording that has all its memory keeps what it has, and the run goes on", { skip }, async () => {
  const file = join(mkdtempSync(join(tmpdir(), "clench-recording-")), "full.html");
  const words = ["simulate", "models/box_stack.xml", "--steps", "400", "--json", "--max-memory", "2e-5", "--record", file];
  const done = spawnSync(PROGRAM, words, { cwd: ROOT, encoding: "utf8" });
  assert.match(done.stderr, /--max-memory; what was recorded remains, the run continues/);
  const report = JSON.parse(done.stdout) as { status: string; steps: number };
  assert.deepEqual([done.status === 0, report.status, report.steps], [false, "record_failed", 400]);
  const page = await open(browser, `file://${file}`);
  const last = Number(await page.locator("#time").getAttribute("max"));
  assert.ok(last > 3 && last < 100, `${last}`);
  await page.close();
});

test("a page that the disk has no room for is an error after the run", { skip }, async () => {
  const file = join(mkdtempSync(join(tmpdir(), "clench-recording-")), "full.html");
  symlinkSync("/dev/full", file);
  const words = ["simulate", "models/pendulum.xml", "--steps", "40", "--json", "--record", file];
  const done = spawnSync(PROGRAM, words, { cwd: ROOT, encoding: "utf8" });
  const report = JSON.parse(done.stdout) as { status: string; steps: number };
  assert.deepEqual([report.status, report.steps], ["record_failed", 40]);
  assert.match(done.stderr, /full.html.*No space left/);
});

test("a recording opens from a disk and replays", { skip }, async () => {
  const file = join(mkdtempSync(join(tmpdir(), "clench-recording-")), "fall.html");
  const words = ["simulate", "models/humanoid.xml", "--time", "0.5", "--every", "8", "--record", file];
  const done = spawnSync(PROGRAM, words, { cwd: ROOT, encoding: "utf8" });
  assert.equal(done.status, 0, done.stderr);
  const page = await open(browser, `file://${file}`);
  await until(page, () => window.clench.frame.time > 0.1);
  await page.locator("#time").fill("3");
  // The drawn frame may be of any time, as the recording repeats; a requested moment appears and stays.
  await until(page, () => Math.abs(window.clench.frame.time - 0.064) < 1e-9);
  await page.waitForTimeout(300);
  assert.ok(Math.abs((await time(page)) - 0.064) < 1e-9);
  // All plots end at the current time, also after a jump.
  for (const moment of ["3", "25", "9"]) {
    await page.locator("#time").fill(moment);
    await until(page, (moment) => {
      const { frame, plots } = window.clench;
      return Math.abs(frame.time - 0.016 * (Number(moment) + 1)) < 1e-9 && plots.spans().every(({ times }) => times[1] === frame.time);
    }, moment);
  }
  await page.close();
});

test("a plot has a line after two moments, and what is zero lies in its middle", { skip }, async () => {
  const program = await view("models/gripper/gripper.urdf", "--paused");
  try {
    const page = await open(browser, program.url);
    await page.click("#step");
    await until(page, () => window.clench.plots.counts().every((count) => count === 2));
    await until(page, () => window.clench.plots.spans().every(({ times }) => times[1] > times[0]));
    // Nothing moves or touches.
    assert.deepEqual(await page.evaluate(() => window.clench.plots.spans().map(({ values }) => values)), [[-1, 1], [-1, 1], [-1, 1]]);
    await page.close();
  } finally {
    await program.end();
  }
});
