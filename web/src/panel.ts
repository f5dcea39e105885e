// The controls next to the picture.

import { LARGEST, type Layers } from "./overlays.ts";
import type { Sight } from "./bodies.ts";
import { brief, button, check, choice, element, fold, paint, shortened, slider, type Slider } from "./elements.ts";
import type { Frame } from "./frame.ts";
import type { Command } from "./link.ts";
import type { Replay } from "./replay.ts";
import { nameOf, type Scene } from "./scene.ts";
import type { Stage } from "./stage.ts";
import type { FrameBuffer } from "./frame_buffer.ts";

const SPEEDS: [string, string][] = [
  ["0.1", "0.1 ×"],
  ["0.25", "0.25 ×"],
  ["0.5", "0.5 ×"],
  ["1", "1 ×"],
  ["2", "2 ×"],
  ["4", "4 ×"],
  ["0", "fastest"],
];

const LAYERS: [keyof Layers, string][] = [
  ["contacts", "contacts"],
  ["forces", "forces"],
  ["largest", `largest ${LARGEST}`],
  ["constraints", "limits, welds"],
  ["cones", "friction cones"],
  ["tendons", "tendons"],
  ["frames", "frames"],
  ["joints", "joint axes"],
  ["masses", "centres of mass"],
  ["inertia", "inertia boxes"],
];

/** The selectable numbers of environments side by side. */
const GRIDS = [1, 4, 9, 16, 25, 36, 49, 64];

/** The selectable durations of a saved recording, s. */
const SAVED = [5, 10, 30];

/** The range of a slider without limits. */
const OPEN: [number, number] = [-3.1416, 3.1416];

export class Panel {
  chosen: number | null = null;
  private controls: Slider[] = [];
  private joints: { slider: Slider; qpos: number }[] = [];
  private equalities: HTMLInputElement[] = [];
  private clock = element("output", { id: "clock" });
  private pause: HTMLButtonElement;
  private time: HTMLInputElement | null = null;
  private past = this.makePast();
  private facts = element("div", { id: "facts" });
  private rows = new Map<number, HTMLElement>();
  private paused = false;
  /** The environment of a batch that is interacted with. */
  env = 0;
  private selection = { env: 0, first: 0, count: 1 };
  private envFields: HTMLInputElement[] = [];
  private grid: HTMLSelectElement | null = null;

  constructor(
    private scene: Scene,
    private stage: Stage,
    private sight: Sight,
    private layers: Layers,
    private send: (command: Command) => void,
    private replay: Replay | null,
    private frameBuffer: FrameBuffer | null,
  ) {
    this.pause = button("pause", "pause or continue (space)", () => this.toggle());
    this.pause.id = "pause";
    document.getElementById("bar")!.replaceChildren(...this.bar());
    document.getElementById("panel")!.replaceChildren(...this.sections());
    document.title = `${scene.name} · Clench`;
  }

  private get live(): boolean {
    return this.scene.active && this.replay === null;
  }

  toggle(): void {
    if (this.replay) this.replay.playing = !this.replay.playing;
    else this.send({ do: "pause", on: !this.paused });
  }

  private bar(): HTMLElement[] {
    const { scene, replay } = this;
    const title = element("strong", {}, scene.name || "Clench");
    if (replay) {
      const last = replay.frames.length - 1;
      this.time = element("input", { id: "time", type: "range", min: "0", max: `${last}`, step: "1" });
      this.time.oninput = () => {
        replay.playing = false;
        replay.seek(this.time!.valueAsNumber);
      };
      const speed = choice(SPEEDS.slice(0, -1), "1", (value) => (replay.speed = Number(value)));
      return [title, this.pause, this.time, speed, ...this.cameras(), this.clock];
    }
    if (!this.live) return [title, ...this.cameras(), this.clock];
    const keys = scene.keyframes.map((name, index): [string, string] => [`${index}`, nameOf("key", index, name)]);
    const keyframe = choice([["", "keyframe"], ...keys], "", (value) => {
      if (value !== "") this.send({ do: "keyframe", index: Number(value) });
      keyframe.value = "";
    });
    const step = button("step", "one step (→)", () => this.send({ do: "step", count: 1 }));
    step.id = "step";
    return [
      title,
      this.pause,
      step,
      ...(scene.rewinds ? [button("back", "go back one second (←)", () => this.send({ do: "rewind", seconds: 1 })), this.past] : []),
      button("reset", "reset (backspace)", () => this.send({ do: "reset" })),
      ...(keys.length > 0 ? [keyframe] : []),
      choice(SPEEDS, "1", (value) => this.send({ do: "speed", factor: Number(value) })),
      ...(scene.envs > 1 ? this.envControls() : []),
      ...this.cameras(),
      ...(this.frameBuffer ? [this.saves(this.frameBuffer)] : []),
      this.clock,
    ];
  }

  /** Creates the control that saves the last seconds as a page. */
  private saves(frameBuffer: FrameBuffer): HTMLElement {
    const options = SAVED.map((seconds): [string, string] => [`${seconds}`, `the last ${seconds} s`]);
    const list = choice([["", "save"], ...options], "", (seconds) => {
      list.value = "";
      if (seconds !== "") void frameBuffer.save(Number(seconds));
    });
    list.id = "save";
    list.title = "save the last seconds as a page that replays them";
    return list;
  }

  /** Creates the choice of the model's cameras, if it has any. */
  private cameras(): HTMLElement[] {
    const { cameras } = this.scene;
    if (cameras.length === 0) return [];
    const options = cameras.map(({ name }, index): [string, string] => [`${index}`, nameOf("camera", index, name)]);
    const list = choice([["", "free camera"], ...options], "", (value) => {
      this.stage.choose(value === "" ? null : Number(value));
    });
    list.id = "camera";
    return [list];
  }

  /** Creates a slider over the moments that rewinding can reach. */
  private makePast(): HTMLInputElement {
    const title = "go back to a moment of the last ten seconds";
    const made = element("input", { id: "past", type: "range", title, min: "0", max: "0", step: "any" });
    made.oninput = () => this.send({ do: "moment", time: made.valueAsNumber });
    made.onchange = () => made.blur();
    return made;
  }

  private showPast(frame: Frame): void {
    const { past } = frame.rows;
    if (past.count === 0 || document.activeElement === this.past) return;
    [this.past.min, this.past.max] = [`${past.data[0]}`, `${past.data[1]}`];
    this.past.valueAsNumber = frame.time;
  }

  /** Selects environments. */
  show(chosen: Partial<{ env: number; first: number; count: number }>): void {
    Object.assign(this.selection, chosen);
    this.send({ do: "show", ...this.selection });
  }

  private envControls(): HTMLElement[] {
    const max = this.scene.envs - 1;
    const field = (title: string, id: string, changed: (value: number) => void) => {
      const input = element("input", { type: "number", id, title, min: "0", max: `${max}`, step: "1", value: "0" });
      input.onchange = () => changed(Math.min(max, Math.max(0, Math.round(input.valueAsNumber || 0))));
      this.envFields.push(input);
      return input;
    };
    const grids = GRIDS.filter((count) => count === 1 || count <= this.scene.envs);
    const last = grids[grids.length - 1];
    if (last < Math.min(this.scene.envs, 64)) grids.push(Math.min(this.scene.envs, 64));
    const options = grids.map((count): [string, string] => [`${count}`, count === 1 ? "alone" : `of ${count}`]);
    this.grid = choice(options, "1", (value) => this.show({ count: Number(value) }));
    this.grid.id = "grid";
    return [
      element("label", { className: "check" }, "environment", field("the selected environment", "env", (env) => this.show({ env }))),
      this.grid,
      element("label", { className: "check" }, "from", field("the first of the environments side by side", "first", (first) => this.show({ first }))),
    ];
  }

  /** Reads the selection of other pages or of the program. */
  private readSelection(frame: Frame): void {
    const { chosen, envs } = frame.rows;
    if (chosen.count === 0) return;
    const [env, first] = chosen.data;
    const count = Math.max(1, envs.count);
    this.env = env;
    this.selection = { env, first, count: this.grid?.value === `${count}` ? count : this.wider(count) };
    const fields = this.envFields.filter((field) => document.activeElement !== field);
    for (const field of fields) field.value = `${field.id === "env" ? env : first}`;
    if (this.grid && document.activeElement !== this.grid) this.grid.value = `${this.selection.count}`;
  }

  /** Returns the smallest choice for this count: at the end of a batch fewer environments are shown than requested. */
  private wider(count: number): number {
    const counts = Array.from(this.grid?.options ?? [], ({ value }) => Number(value));
    return counts.find((choice) => choice >= count) ?? count;
  }

  private sections(): HTMLElement[] {
    const { scene } = this;
    const parts = [fold("Show", true, this.layerChecks()), fold("Selection", true, this.facts)];
    if (this.live) {
      if (scene.controls.length > 0) parts.push(fold("Controls", false, this.controlSliders()));
      if (scene.joints.length > 0) parts.push(fold("Joints", false, this.jointSliders()));
      if (scene.equalities.length > 0) parts.push(fold("Equalities", true, this.equalityChecks()));
      parts.push(fold("Solver", false, this.solver()));
    }
    parts.push(fold("Bodies", false, this.tree()));
    this.describe(null);
    return parts;
  }

  private layerChecks(): HTMLElement {
    const box = element("div", { className: "checks" });
    for (const [key, text] of LAYERS) {
      box.append(check(text, this.layers[key], (on) => (this.layers[key] = on)));
    }
    box.append(check("sites", this.sight.sites, (on) => (this.sight.sites = on)));
    if (this.scene.trees.some((tree) => tree !== null)) {
      box.append(check("islands", this.sight.islands, (on) => (this.sight.islands = on)));
    }
    const rebuild = (key: "hulls" | "transparent") => (on: boolean) => {
      this.sight[key] = on;
      this.stage.bodies.rebuild();
    };
    box.append(check("transparent", this.sight.transparent, rebuild("transparent")));
    if (this.scene.meshes.length > 0) box.append(check("collision hulls", this.sight.hulls, rebuild("hulls")));
    const used = new Set([...this.scene.geoms, ...this.scene.sites].map(({ group }) => group));
    if (used.size > 1) {
      [...used].sort().forEach((group) => {
        box.append(check(`group ${group}`, this.sight.groups[group], (on) => (this.sight.groups[group] = on)));
      });
    }
    const { overlays } = this.stage;
    const first = overlays.forceScale;
    const scale = slider("arrow length", -2, 2, (power) => (overlays.forceScale = first * 10 ** power), (power) =>
      `${Number((1000 * first * 10 ** power).toPrecision(2))} mm/N`,
    );
    scale.show(0);
    return element("div", {}, box, scale.row);
  }

  private controlSliders(): HTMLElement {
    this.controls = this.scene.controls.map(({ name, range }, index) => {
      const [low, high] = range ?? [-1, 1];
      return slider(nameOf("control", index, name), low, high, (value) =>
        this.send({ do: "control", index, value }),
      );
    });
    return element("div", { id: "controls" }, ...this.controls.map(({ row }) => row));
  }

  private jointSliders(): HTMLElement {
    const box = element("div", {});
    this.scene.joints.forEach((joint, index) => {
      if (joint.kind !== "slide" && joint.kind !== "hinge") return;
      const [low, high] = joint.range ?? OPEN;
      const made = slider(nameOf("joint", index, joint.name), low, high, (value) => {
        this.send({ do: "pause", on: true });
        this.send({ do: "position", index: joint.qpos, value });
      });
      this.joints.push({ slider: made, qpos: joint.qpos });
      box.append(made.row);
    });
    return box;
  }

  private equalityChecks(): HTMLElement {
    const box = element("div", { id: "equalities" });
    this.scene.equalities.forEach(({ name, kind }, index) => {
      const label = check(nameOf(kind, index, name), true, (on) => this.send({ do: "equality", index, on }));
      this.equalities.push(label.querySelector("input")!);
      box.append(label);
    });
    return box;
  }

  private solver(): HTMLElement {
    const number = (text: string, key: string, value: string) => {
      const field = element("input", { type: "number", placeholder: value, min: "0", step: "any" });
      field.onchange = () => this.send({ do: "options", [key]: field.valueAsNumber });
      return element("label", { className: "slider" }, element("span", {}, text), field);
    };
    return element(
      "div",
      {},
      check("elliptic cones", false, (on) => this.send({ do: "options", elliptic: on })),
      number("iterations", "iterations", "of the file"),
      number("tolerance", "tolerance", "of the file"),
      number("noslip", "noslip_iterations", "of the file"),
    );
  }

  private tree(): HTMLElement {
    const box = element("div", { id: "tree" });
    const depth: number[] = [];
    this.scene.bodies.forEach((body, index) => {
      depth[index] = index === 0 ? 0 : depth[body.parent] + 1;
      const name = nameOf("body", index, index === 0 ? "world" : body.name);
      const text = shortened(name, Math.max(10, 30 - depth[index]));
      const row = element("div", { className: "body", title: name === text ? "" : name }, text);
      row.style.paddingLeft = `${0.4 + 0.8 * depth[index]}em`;
      row.onclick = () => this.choose(index);
      this.rows.set(index, row);
      box.append(row);
    });
    return box;
  }

  choose(body: number | null): void {
    if (this.chosen !== null) this.rows.get(this.chosen)?.classList.remove("chosen");
    this.chosen = body;
    if (body !== null) this.rows.get(body)?.classList.add("chosen");
    if (this.stage.followed !== null) this.stage.followed = body;
  }

  /** Shows the values of a frame. */
  update(frame: Frame): void {
    this.paused = frame.paused;
    this.readSelection(frame);
    const isPaused = this.replay ? !this.replay.playing : frame.paused;
    paint(this.pause, isPaused ? "play" : "pause");
    const speed = frame.rows.plots.data[8];
    const rate = this.live && !frame.paused ? ` · ${speed.toFixed(2)} ×` : "";
    this.clock.value = `${frame.time.toFixed(3)} s${rate} · ${frame.rows.contacts.count} contacts`;
    if (this.time && this.replay) this.time.valueAsNumber = this.replay.at;
    this.controls.forEach((control, index) => control.show(frame.rows.ctrl.data[index]));
    this.joints.forEach(({ slider: joint, qpos }) => joint.show(frame.rows.qpos.data[qpos]));
    this.equalities.forEach((box, index) => (box.checked = frame.rows.eq_active.data[index] > 0));
    this.showPast(frame);
    this.describe(frame);
  }

  private describe(frame: Frame | null): void {
    const body = this.chosen;
    if (body === null || frame === null) {
      this.facts.replaceChildren(
        element("p", { className: "hint" }, "Click a body to see its quantities. " + (this.live ? "Ctrl-drag pulls it; with the right button it rotates." : "")),
      );
      return;
    }
    const { name, mass } = this.scene.bodies[body];
    const pose = frame.rows.bodies.data.subarray(7 * body, 7 * body + 7);
    const lines: [string, string][] = [
      ["body", nameOf("body", body, body === 0 ? "world" : name)],
      ["mass", `${brief(mass)} kg`],
      ["position", [...pose.subarray(0, 3)].map(brief).join("  ")],
      ["quaternion", [...pose.subarray(3)].map(brief).join("  ")],
      ["contact force", `${brief(this.pushOn(body, frame))} N`],
    ];
    this.scene.joints.forEach((joint, index) => {
      if (joint.body !== body || joint.kind === "free" || joint.kind === "ball") return;
      const { qpos, qvel } = frame.rows;
      lines.push([
        shortened(nameOf("joint", index, joint.name), 16),
        `${brief(qpos.data[joint.qpos])}  (${brief(qvel.data[joint.dof])} /s)`,
      ]);
    });
    const follow = check("follow with the camera", this.stage.followed === body, (on) => {
      this.stage.followed = on ? body : null;
    });
    const table = element("table", {}, ...lines.map(([what, value]) =>
      element("tr", {}, element("td", {}, what), element("td", {}, value))));
    if (this.facts.querySelector("table") && this.facts.dataset.body === `${body}`) {
      this.facts.querySelector("table")!.replaceWith(table);
    } else {
      this.facts.replaceChildren(table, follow);
      this.facts.dataset.body = `${body}`;
    }
  }

  /** Returns the sum of the norms of the contact forces on a body, N. */
  private pushOn(body: number, frame: Frame): number {
    const { data, count, width } = frame.rows.contacts;
    let sum = 0;
    for (let row = 0; row < count; row++) {
      const contact = data.subarray(width * row, width * (row + 1));
      const touches = [contact[17], contact[18]].some((geom) => this.scene.geoms[geom]?.body === body);
      if (touches) sum += Math.hypot(contact[12], contact[13], contact[14]);
    }
    return sum;
  }
}
