// What is plotted while a simulation runs.

import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { choice, element } from "./elements.ts";
import { PLOTS, type Frame } from "./frame.ts";
import { nameOf, type Scene } from "./scene.ts";
import { tickTexts } from "./ticks.ts";

/** Moments in a plot. */
const ROOM = 600;
const COLOURS = ["#2f7de1", "#f08a24", "#2eb872"];
const STAGE_COLOURS = ["#8e9aa6", "#2f7de1", "#2eb872", "#e8b730", "#f0642f", "#9a6ad6"];

/** What can be plotted: a number, or parts on top of each other. */
interface Source {
  title: string;
  /** Names of the parts, the lowest first; none of a single number. */
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

/** Time between drawings of a plot, ms. */
const PAUSE = 100;

/** Numbers that rounding leaves of nothing. */
const NOTHING = 1e-12;

/** The axis from the least to the most of a line: around one that is flat, as much as its value. */
function reach(least: number | null, most: number | null): uPlot.Range.MinMax {
  if (least === null || most === null) return [0, 1];
  const size = Math.max(Math.abs(least), Math.abs(most));
  if (size < NOTHING) return [-1, 1];
  if (most - least > NOTHING * size) return uPlot.rangeNum(least, most, 0.1, true);
  return [least - 0.5 * size, most + 0.5 * size];
}

/** Pixels that the texts of a vertical axis take, with the gaps around them. */
function room(texts: string[] | null): number {
  return 16 + 6 * Math.max(3, ...(texts ?? []).map((text) => text.length));
}

class Plot {
  readonly box: HTMLElement;
  private times: number[] = [];
  /** Of each part what it and those below it are together, the highest first: the lower ones are drawn over it. */
  private values: number[][] = [];
  private plot: uPlot;
  private names: HTMLElement;
  /** When it was drawn last, and whether it has got something since, ms. */
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

  /** The plot of what is chosen. */
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
        // Areas that lie on each other begin at nothing.
        scales: { x: { time: false }, y: { range: (_, least, most) => (parts.length > 0 ? [0, most || 1] : reach(least, most)) } },
        axes: [
          { size: 22, font: "10px system-ui", stroke: "#566", grid: { stroke: "#0001" }, ticks: { show: false } },
          { size: (_, texts) => room(texts), values: (_, ticks) => tickTexts(ticks), font: "10px system-ui", stroke: "#566", grid: { stroke: "#0001" }, ticks: { show: false } },
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

  /** Draws what it got, if it is time to: at once where history begins anew. */
  draw(now: number): void {
    if (!this.isOld || now - this.drawn < PAUSE) return;
    // A line begins with two moments: it is not to wait for the next time.
    this.drawn = this.times.length > 1 ? now : -Infinity;
    this.isOld = false;
    this.plot.setData([this.times, ...this.values]);
  }

  /** The moments between which it is drawn. */
  get span(): [number, number] {
    const { min, max } = this.plot.scales.x;
    return [min ?? NaN, max ?? NaN];
  }

  /** The numbers between which it is drawn. */
  get heights(): [number, number] {
    const { min, max } = this.plot.scales.y;
    return [min ?? NaN, max ?? NaN];
  }

  get count(): number {
    return this.times.length;
  }

  /** The last of what is drawn, the highest first. */
  get last(): number[] {
    return this.values.map((row) => row.at(-1) ?? NaN);
  }
}

export class Plots {
  private plots: Plot[];

  constructor(scene: Scene, place: HTMLElement) {
    const all = sources(scene);
    this.plots = [0, 3, 6].map((source, k) => new Plot(all, source, COLOURS[k]));
    place.replaceChildren(...this.plots.map((plot) => plot.box));
  }

  add(frame: Frame): void {
    for (const plot of this.plots) plot.add(frame);
  }

  draw(): void {
    const now = performance.now();
    for (const plot of this.plots) plot.draw(now);
  }

  /** The moments and the numbers between which each is drawn. */
  spans(): { times: [number, number]; values: [number, number] }[] {
    return this.plots.map((plot) => ({ times: plot.span, values: plot.heights }));
  }

  /** The last of what each draws, the highest first. */
  lasts(): number[][] {
    return this.plots.map((plot) => plot.last);
  }

  /** Moments in each. */
  counts(): number[] {
    return this.plots.map((plot) => plot.count);
  }
}
