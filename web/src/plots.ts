// What is plotted while a simulation runs.

import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { choice, element } from "./elements.ts";
import { PLOTS, type Frame } from "./frame.ts";
import { nameOf, type Scene } from "./scene.ts";

/** Moments in a plot. */
const ROOM = 600;
const COLOURS = ["#2f7de1", "#f08a24", "#2eb872"];

interface Source {
  title: string;
  read(frame: Frame): number;
}

function sources(scene: Scene): Source[] {
  const all: Source[] = PLOTS.map(({ name, unit }, index) => ({
    title: unit ? `${name} (${unit})` : name,
    read: (frame) => frame.rows.plots.data[index],
  }));
  scene.joints.forEach((joint, index) => {
    if (joint.kind !== "slide" && joint.kind !== "hinge") return;
    const name = nameOf("joint", index, joint.name);
    all.push({ title: `${name}: position`, read: (frame) => frame.rows.qpos.data[joint.qpos] });
    all.push({ title: `${name}: velocity`, read: (frame) => frame.rows.qvel.data[joint.dof] });
  });
  scene.sensors.forEach((sensor, index) => {
    for (let k = 0; k < sensor.count; k++) {
      const part = sensor.count > 1 ? ` [${k}]` : "";
      const title = `sensor ${nameOf("", index, sensor.name)}${part}`;
      all.push({ title, read: (frame) => frame.rows.sensors.data[sensor.start + k] });
    }
  });
  return all;
}

class Plot {
  readonly box: HTMLElement;
  private times: number[] = [];
  private values: number[] = [];
  private plot: uPlot;

  constructor(
    private all: Source[],
    private source: number,
    colour: string,
  ) {
    const options = all.map(({ title }, index): [string, string] => [`${index}`, title]);
    const list = choice(options, `${source}`, (value) => {
      this.source = Number(value);
      this.clear();
    });
    this.box = element("div", { className: "plot" }, list);
    this.plot = new uPlot(
      {
        width: 250,
        height: 104,
        legend: { show: false },
        cursor: { show: false },
        scales: { x: { time: false } },
        axes: [
          { size: 22, font: "10px system-ui", stroke: "#566", grid: { stroke: "#0001" }, ticks: { show: false } },
          { size: 46, values: (_, ticks) => ticks.map(tick), font: "10px system-ui", stroke: "#566", grid: { stroke: "#0001" }, ticks: { show: false } },
        ],
        series: [{}, { stroke: colour, width: 1.5, points: { show: false } }],
      },
      [[], []],
      this.box,
    );
  }

  clear(): void {
    this.times = [];
    this.values = [];
  }

  add(frame: Frame): void {
    const last = this.times.at(-1);
    if (last === frame.time) return;
    if (last !== undefined && frame.time < last) this.clear();
    this.times.push(frame.time);
    this.values.push(this.all[this.source].read(frame));
    if (this.times.length > ROOM) {
      this.times.shift();
      this.values.shift();
    }
  }

  draw(): void {
    this.plot.setData([this.times, this.values]);
  }

  get count(): number {
    return this.times.length;
  }
}

/** A number of an axis, as short as it can be. */
function tick(value: number): string {
  const rounded = Number(value.toPrecision(4));
  return rounded !== 0 && Math.abs(rounded) < 1e-3 ? rounded.toExponential() : `${rounded}`;
}

export class Plots {
  private plots: Plot[];
  private turn = 0;

  constructor(scene: Scene, place: HTMLElement) {
    const all = sources(scene);
    this.plots = [0, 3, 6].map((source, k) => new Plot(all, source, COLOURS[k]));
    place.replaceChildren(...this.plots.map((plot) => plot.box));
  }

  add(frame: Frame): void {
    for (const plot of this.plots) plot.add(frame);
  }

  /** Draws one of them, which is often enough to look at. */
  draw(): void {
    this.turn = (this.turn + 1) % this.plots.length;
    this.plots[this.turn].draw();
  }

  /** Moments in each. */
  counts(): number[] {
    return this.plots.map((plot) => plot.count);
  }
}
