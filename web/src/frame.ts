// Frames, the state at one moment; see crates/clench-view/src/frame.rs.

import type { Scene } from "./scene.ts";

const MAGIC = 0x464e4c43; // "CLNF"
const DELTA = 0x444e4c43; // "CLND"
const HEAD = 20;

/** Rows of equal width. */
export interface Rows {
  width: number;
  count: number;
  data: Float32Array;
}

export interface Frame {
  time: number;
  paused: boolean;
  /** The bytes as received. */
  bytes: ArrayBuffer;
  rows: Record<string, Rows>;
}

export function decode(scene: Scene, buffer: ArrayBuffer): Frame | null {
  const view = new DataView(buffer);
  if (buffer.byteLength < HEAD || view.getUint32(0, true) !== MAGIC) return null;
  const sections = view.getUint32(16, true);
  if (sections !== scene.sections.length) return null;
  let offset = HEAD + 4 * sections;
  const rows: Record<string, Rows> = {};
  scene.sections.forEach(({ name, width }, index) => {
    const count = view.getUint32(HEAD + 4 * index, true);
    rows[name] = { width, count, data: new Float32Array(buffer, offset, width * count) };
    offset += 4 * width * count;
  });
  return {
    time: view.getFloat64(8, true),
    bytes: buffer,
    paused: (view.getUint32(4, true) & 1) !== 0,
    rows,
  };
}

/**
 * Returns the whole frame of a message: as received, or the last one with changes; see crates/clench-view/src/delta.rs.
 */
export function whole(scene: Scene, message: ArrayBuffer, last: ArrayBuffer | null): ArrayBuffer | null {
  const view = new DataView(message);
  if (message.byteLength < HEAD || view.getUint32(0, true) !== DELTA) return message;
  const before = last && decode(scene, last);
  if (!before || view.getUint32(16, true) !== scene.sections.length) return null;
  const head = HEAD + 4 * scene.sections.length;
  const counts = scene.sections.map((_, index) => view.getUint32(HEAD + 4 * index, true));
  const numbers = scene.sections.reduce((sum, { width }, index) => sum + width * counts[index], 0);
  const made = new ArrayBuffer(head + 4 * numbers);
  new Uint8Array(made).set(new Uint8Array(message, 0, head));
  new DataView(made).setUint32(0, MAGIC, true);
  const out = new Float32Array(made, head);
  let at = head;
  let to = 0;
  const copy = (count: number) => {
    out.set(new Float32Array(message, at, count), to);
    at += 4 * count;
  };
  scene.sections.forEach(({ name, width }, index) => {
    const count = counts[index];
    const kind = view.getUint32(at, true);
    at += 4;
    if (kind === 2) copy(width * count);
    else out.set(before.rows[name].data, to);
    if (kind === 1) {
      const bits = new Uint32Array(message, at, Math.ceil(count / 32));
      at += 4 * bits.length;
      for (let row = 0; row < count; row++, to += width) if ((bits[row >> 5] >>> (row & 31)) & 1) copy(width);
      to -= width * count;
    }
    to += width * count;
  });
  return made;
}

/** A shown environment of a batch. */
export interface Env {
  index: number;
  /** The reason if it cannot continue; otherwise empty. */
  fault: string;
}

/** Returns all texts of a frame: those of its marks, then those of its environments. */
export function textsOf(frame: Frame): string[] {
  const { texts, letters } = frame.rows;
  let at = 0;
  return Array.from(texts.data, (count) => {
    const codes = letters.data.subarray(at, at + count);
    at += count;
    return String.fromCodePoint(...codes);
  });
}

/** Returns the shown environments; empty if there is only one. */
export function envsOf(frame: Frame): Env[] {
  const { envs, marks } = frame.rows;
  if (envs.count === 0) return [];
  const texts = textsOf(frame).slice(marks.count);
  return texts.map((fault, k) => ({ index: envs.data[2 * k], fault }));
}

/** The plotted values, in the order of the section `plots`. */
export const PLOTS = [
  { name: "solver iterations", unit: "" },
  { name: "duality gap", unit: "log₁₀" },
  { name: "gradient", unit: "log₁₀" },
  { name: "maximum penetration", unit: "m" },
  { name: "contacts", unit: "" },
  { name: "potential energy", unit: "J" },
  { name: "kinetic energy", unit: "J" },
  { name: "time of a step", unit: "µs" },
  { name: "simulated over real time", unit: "" },
];
