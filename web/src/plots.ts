// Plots of a running simulation.

import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { choice, element } from "./elements.ts";
import { PLOTS, type Frame } from "./frame.ts";
import { nameOf, type Scene } from "./scene.ts";
import { tickTexts } from "./ticks.ts";

/** The maximum number of moments in a plot. */
const ROOM = 600;
const COLOURS = ["#2f7de1", "#f08a24", "#2eb872"];
const STAGE_COLOURS = ["#8e9aa6", "#2f7de1", "#2eb872", "#e8b730", "#f0642f", "#9a6ad6"];

/** A plottable quantity: a number, or stacked parts. */
interface Source {
  title: string;
  /** The names of the parts, the lowest first; empty for a single number. */
  parts: string[];
  read(frame: Frame): ArrayLike<number>;
}

function sources(scene: Scene): Source[] {
  const all: Source[] = PLOTS.map(({ name, unit }, index) => ({
    title: unit ? `${name} (${unit})` : name,
    parts: [],
    read: (frame) => frame.rows.plots.data.subarray(index, index + 1),
  }));
  all.push({ title: "time by stage (µs)", parts: scene.stages, read: (frame) => frame.rows.stages.data });
  scene.joints.forEach((joint, index) => {
    if (joint.kind !== "slide" && joint.kind !== "hinge") return;
    const name = nameOf("joint", index, joint.name);
    const { qpos, dof } = joint;
    all.push({ title: `${name}: position`, parts: [], read: (frame) => frame.rows.qpos.data.subarray(qpos, qpos + 1) });
    all.push({ title: `${name}: velocity`, parts: [], read: (frame) => frame.rows.qvel.data.subarray(dof, dof + 1) });
  });
  scene.sensors.forEach((sensor, index) => {
    for (let k = 0; k < sensor.count; k++) {
      const part = sensor.count > 1 ? ` [${k}]` : "";
      const title = `sensor ${nameOf("", index, sensor.name)}${part}`;
      const at = sensor.start + k;
      all.push({ title, parts: [], read: (frame) => frame.rows.sensors.data.subarray(at, at + 1) });
    }
  });
  return all;
}

/** The minimum time between redraws of a plot, ms. */
const PAUSE = 100;

/** Smaller values are rounding errors of zero. */
const NEGLIGIBLE = 1e-12;

/** Returns the axis range of a line; a constant line is padded by half its value on both sides. */
function reach(min: number | null, max: number | null): uPlot.Range.MinMax {
  if (min === null || max === null) return [0, 1];
  const size = Math.max(Math.abs(min), Math.abs(max));
  if (size < NEGLIGIBLE) return [-1, 1];
  if (max - min > NEGLIGIBLE * size) return uPlot.rangeNum(min, max, 0.1, true);
  return [min - 0.5 * size, max + 0.5 * size];
}

/** Returns the width of a vertical axis with its labels and gaps, pixels. */
function labelWidth(texts: string[] | null): number {
  return 16 + 6 * Math.max(3, ...(texts ?? []).map((text) => text.length));
}

class Plot {
  readonly box: HTMLElement;
  private times: number[] = [];
  /** The cumulative sum of each part and those below it, the highest first: lower ones are drawn over it. */
  private values: number[][] = [];
  private plot: uPlot;
  private names: HTMLElement;
  /** The time of the last redraw, ms, and true if data have arrived since. */
  private drawn = -Infinity;
  private isOld = true;

  constructor(
    private all: Source[],
    private source: number,
    private colour: string,
  ) {
    const options = all.map(({ title }, index): [string, string] => [`${index}`, title]);
    const list = choice(options, `${source}`, (value) => {
      this.source = Number(value);
      this.clear();
      this.plot.destroy();
      this.plot = this.made();
    });
    this.names = element("div", { className: "parts" });
    this.box = element("div", { className: "plot" }, list, this.names);
    this.clear();
    this.plot = this.made();
  }

  /** Creates the plot of the selected quantity. */
  private made(): uPlot {
    const { parts } = this.all[this.source];
    const names = parts.map((name, k) => {
      const label = element("span", {}, name);
      label.style.color = STAGE_COLOURS[k];
      return label;
    });
    this.names.replaceChildren(...names);
    const stacked = parts.map((_, k) => ({ fill: STAGE_COLOURS[k], width: 0, points: { show: false } })).reverse();
    const line = { stroke: this.colour, width: 1.5, points: { show: false } };
    return new uPlot(
      {
        width: 250,
        height: 104,
        legend: { show: false },
        cursor: { show: false },
        // Stacked areas start at zero.
        scales: { x: { time: false }, y: { range: (_, min, max) => (parts.length > 0 ? [0, max || 1] : reach(min, max)) } },
        axes: [
          { size: 22, font: "10px system-ui", stroke: "#566", grid: { stroke: "#0001" }, ticks: { show: false } },
          { size: (_, texts) => labelWidth(texts), values: (_, ticks) => tickTexts(ticks), font: "10px system-ui", stroke: "#566", grid: { stroke: "#0001" }, ticks: { show: false } },
        ],
        series: [{}, ...(parts.length > 0 ? stacked : [line])],
      },
      [this.times, ...this.values],
      this.box,
    );
  }

  clear(): void {
    this.drawn = -Infinity;
    this.times = [];
    this.values = Array.from({ length: Math.max(1, this.all[this.source].parts.length) }, () => []);
  }

  add(frame: Frame): void {
    const last = this.times.at(-1);
    if (last === frame.time) return;
    if (last !== undefined && frame.time < last) this.clear();
    this.isOld = true;
    this.times.push(frame.time);
    const numbers = this.all[this.source].read(frame);
    let sum = 0;
    for (let k = 0; k < this.values.length; k++) {
      sum += numbers[k];
      this.values[this.values.length - 1 - k].push(sum);
    }
    if (this.times.length > ROOM) for (const row of [this.times, ...this.values]) row.shift();
  }

  /** Redraws the plot if it is due: immediately when the history restarts. */
  draw(now: number): void {
    if (!this.isOld || now - this.drawn < PAUSE) return;
    // A line needs two moments: do not wait for the next redraw.
    this.drawn = this.times.length > 1 ? now : -Infinity;
    this.isOld = false;
    this.plot.setData([this.times, ...this.values]);
  }

  /** The drawn range of times. */
  get span(): [number, number] {
    const { min, max } = this.plot.scales.x;
    return [min ?? NaN, max ?? NaN];
  }

  /** The drawn range of values. */
  get heights(): [number, number] {
    const { min, max } = this.plot.scales.y;
    return [min ?? NaN, max ?? NaN];
  }

  get count(): number {
    return this.times.length;
  }

  /** The last drawn values, the highest first. */
  get last(): number[] {
    return this.values.map((row) => row.at(-1) ?? NaN);
  }
}

export class Plots {
  private plots: Plot[];

  constructor(scene: Scene, container: HTMLElement) {
    const all = sources(scene);
    this.plots = [0, 3, 6].map((source, k) => new Plot(all, source, COLOURS[k]));
    container.replaceChildren(...this.plots.map((plot) => plot.box));
  }

  add(frame: Frame): void {
    for (const plot of this.plots) plot.add(frame);
  }

  draw(): void {
    const now = performance.now();
    for (const plot of this.plots) plot.draw(now);
  }

  /** Returns the drawn ranges of times and values of each plot. */
  spans(): { times: [number, number]; values: [number, number] }[] {
    return this.plots.map((plot) => ({ times: plot.span, values: plot.heights }));
  }

  /** Returns the last drawn values of each plot, the highest first. */
  lasts(): number[][] {
    return this.plots.map((plot) => plot.last);
  }

  /** Returns the number of moments in each plot. */
  counts(): number[] {
    return this.plots.map((plot) => plot.count);
  }
}
