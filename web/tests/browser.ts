// Starts the program and the browser for the tests.

import { spawn, type ChildProcess } from "node:child_process";
import { existsSync, mkdtempSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before } from "node:test";
import { chromium, type Browser, type Page } from "playwright-core";

/** npm runs scripts in the folder of its package. */
export const ROOT = join(process.cwd(), "..");
export const PROGRAM = process.env.CLENCH ?? join(ROOT, "target/release/clench");
const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";
/** The folder of pictures for manual inspection. */
export const PICTURES = process.env.PICTURES ?? mkdtempSync(join(tmpdir(), "clench-view-"));

const missing = [CHROMIUM, PROGRAM].find((path) => !existsSync(path));
/** The reason why tests cannot run here, or false. */
export const skip = missing ? `${missing} is not here` : false;
/** The browser of all tests of a file. */
export let browser: Browser;

before(async () => {
  if (!skip) browser = await launch();
});
after(async () => {
  await browser?.close();
});

function launch(): Promise<Browser> {
  return chromium.launch({
    executablePath: CHROMIUM,
    args: [
      "--no-sandbox",
      "--use-angle=swiftshader",
      "--enable-unsafe-swiftshader",
      "--disable-quic",
      "--no-first-run",
      "--disable-background-networking",
      "--disable-component-update",
      "--disable-sync",
    ],
  });
}

/** Starts `clench view`; returns its address and a function that ends it. */
export function view(...words: string[]): Promise<{ url: string; end(): Promise<void> }> {
  return started(PROGRAM, ["view", "--no-open", ...words]);
}

/** Starts a program that prints the address of a viewer; returns the address and a function that ends it. */
export async function started(
  name: string,
  words: string[],
  environment: Record<string, string> = {},
): Promise<{ url: string; end(): Promise<void> }> {
  const program: ChildProcess = spawn(name, words, {
    cwd: ROOT,
    env: { ...process.env, ...environment },
    stdio: ["ignore", "pipe", "inherit"],
  });
  const gone = new Promise<void>((done) => program.once("exit", () => done()));
  const url = await new Promise<string>((found, failed) => {
    let said = "";
    program.stdout!.on("data", (piece: Buffer) => {
      said += piece.toString();
      const line = said.match(/http\S+/);
      if (line) found(line[0]);
    });
    program.once("exit", () => failed(new Error(`${name} ended before it printed an address`)));
  });
  return {
    url,
    async end() {
      program.kill("SIGTERM");
      await gone;
    },
  };
}

/** Opens a page and waits until it has drawn something. */
export async function open(browser: Browser, url: string): Promise<Page> {
  const page = await browser.newPage({ viewport: { width: 900, height: 560 } });
  page.on("pageerror", (error) => {
    throw error;
  });
  // Software rendering is slow.
  page.setDefaultTimeout(PATIENCE);
  await page.goto(url, { waitUntil: "commit" });
  await until(page, () => "clench" in window);
  return page;
}

const PATIENCE = 120_000;

/** Waits until a condition holds in the page. Playwright's own wait evaluates text, which the page forbids. */
export async function until<T>(page: Page, condition: (about: T) => boolean, about?: T): Promise<void> {
  const deadline = Date.now() + PATIENCE;
  while (!(await page.evaluate(condition as (about: unknown) => boolean, about))) {
    if (Date.now() > deadline) throw new Error(`in vain: ${condition}`);
    await new Promise((done) => setTimeout(done, 50));
  }
}
