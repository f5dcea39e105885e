// The last frames, stored so that they can be saved as a page that replays them.

import type { Frame } from "./frame.ts";
import type { Scene } from "./scene.ts";

/** The limits of the stored frames: simulated time, s, and bytes. */
const SECONDS = 30;
const BYTES = 256e6;
/** The number of bytes that are encoded at once. */
const PIECE = 0x8000;

export class FrameBuffer {
  private scene: Scene | null = null;
  private frames: Frame[] = [];
  private bytes = 0;

  constructor(private notify: (text: string) => void) {}

  /** Restarts with another scene. */
  begin(scene: Scene): void {
    this.scene = scene;
    this.frames = [];
    this.bytes = 0;
  }

  /** Stores a frame. Later frames, from before a reset, are discarded. */
  store(frame: Frame): void {
    while (this.frames.length > 0 && this.frames.at(-1)!.time >= frame.time) this.drop(this.frames.pop()!);
    this.frames.push(frame);
    this.bytes += frame.bytes.byteLength;
    while (this.bytes > BYTES || this.frames[0].time < frame.time - SECONDS) this.drop(this.frames.shift()!);
  }

  private drop(frame: Frame): void {
    this.bytes -= frame.bytes.byteLength;
  }

  /** Saves the last seconds: the page as the server sent it, with the embedded frames. */
  async save(seconds: number): Promise<void> {
    const last = this.frames.at(-1);
    if (!last || !this.scene) return;
    const shown = this.frames.filter((frame) => frame.time >= last.time - seconds);
    const reply = await fetch(location.href).catch(() => null);
    if (!reply?.ok) {
      this.notify("The page could not be fetched again: is the simulation still running?");
      return;
    }
    const data = JSON.stringify({ scene: { ...this.scene, active: false }, frames: shown.map(({ bytes }) => letters(bytes)) });
    const page = new DOMParser().parseFromString(await reply.text(), "text/html");
    // In HTML, `</script` ends a script, and `<!--` followed by `<script` keeps the next `</script` from ending it.
    page.getElementById("recording")!.textContent = data.replaceAll("<", "\\u003c");
    const text = `<!doctype html>\n${page.documentElement.outerHTML}`;
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type: "text/html" }));
    link.download = `${this.scene.name || "clench"} ${last.time.toFixed(2)} s.html`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
  }
}

/** Encodes in base 64. */
function letters(bytes: ArrayBuffer): string {
  const all = new Uint8Array(bytes);
  const pieces: string[] = [];
  for (let at = 0; at < all.length; at += PIECE) pieces.push(String.fromCharCode(...all.subarray(at, at + PIECE)));
  return btoa(pieces.join(""));
}
