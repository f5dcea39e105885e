// The page of a viewer that a Python loop feeds.

import assert from "node:assert/strict";
import { test } from "node:test";
import { browser, open, skip, started, until } from "./browser.ts";

const PYTHON = process.env.PYTHON ?? "python3";
const LOOP = `
import clench
sim = clench.Sim(clench.Model.from_file("models/box_stack.xml"))
with clench.view(sim, open_browser=False) as viewer:
    print(viewer.url, flush=True)
    while not viewer.closed:
        sim.step()
        if sim.time < 0.1:
            viewer.draw_sphere([0, 0, 1], 0.1, lifetime=1e9)
        viewer.sync()
`;

interface Seen {
  frame: { time: number; paused: boolean; rows: Record<string, { count: number; data: Float32Array }> };
}
declare const window: { clench: Seen };

test("a loop in Python is seen, waits for the page, and draws into it", { skip }, async () => {
  const program = await started(PYTHON, ["-c", LOOP]);
  try {
    const page = await open(browser, program.url);
    assert.match(await page.title(), /box_stack/);
    await until(page, () => window.clench.frame.time > 0.2 && window.clench.frame.rows.marks.count > 0);
    await page.click("#pause");
    await until(page, () => window.clench.frame.paused);
    const still = await page.evaluate(() => window.clench.frame.time);
    await page.waitForTimeout(300);
    assert.equal(await page.evaluate(() => window.clench.frame.time), still);
    await page.click("#step");
    await until(page, (still) => window.clench.frame.time > still, still);
    await page.close();
  } finally {
    await program.end();
  }
});
