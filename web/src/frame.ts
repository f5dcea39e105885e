// Where everything is at one moment; see crates/clench-view/src/frame.rs.

import type { Scene } from "./scene.ts";

const MAGIC = 0x464e4c43; // "CLNF"
const HEAD = 20;

/** Rows of numbers, all of one width. */
export interface Rows {
  width: number;
  count: number;
  data: Float32Array;
}

export interface Frame {
  time: number;
  paused: boolean;
  /** As it came. */
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

/** An environment of a batch that is seen. */
export interface Env {
  index: number;
  /** Why it cannot go on; empty if it can. */
  fault: string;
}

/** All texts of a frame: those of its marks, then those of its environments. */
export function textsOf(frame: Frame): string[] {
  const { texts, letters } = frame.rows;
  let at = 0;
  return Array.from(texts.data, (count) => {
    const codes = letters.data.subarray(at, at + count);
    at += count;
    return String.fromCodePoint(...codes);
  });
}

/** The environments that are seen; none where there is only one. */
export function envsOf(frame: Frame): Env[] {
  const { envs, marks } = frame.rows;
  if (envs.count === 0) return [];
  const texts = textsOf(frame).slice(marks.count);
  return texts.map((fault, k) => ({ index: envs.data[2 * k], fault }));
}

/** The plotted numbers, in the order of the section `plots`. */
export const PLOTS = [
  { name: "solver iterations", unit: "" },
  { name: "duality gap", unit: "log₁₀" },
  { name: "gradient", unit: "log₁₀" },
  { name: "deepest penetration", unit: "m" },
  { name: "contacts", unit: "" },
  { name: "potential energy", unit: "J" },
  { name: "kinetic energy", unit: "J" },
  { name: "time of a step", unit: "µs" },
  { name: "simulated over real time", unit: "" },
];
