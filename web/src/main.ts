// The viewer's page: a live simulation from the server, or an embedded recording.

import "./style.css";
import type { Sight } from "./bodies.ts";
import type { Frame } from "./frame.ts";
import { Link, type Command } from "./link.ts";
import type { Layers } from "./overlays.ts";
import { Panel } from "./panel.ts";
import { Plots } from "./plots.ts";
import { Replay } from "./replay.ts";
import type { Scene } from "./scene.ts";
import { Stage } from "./stage.ts";
import { FrameBuffer } from "./frame_buffer.ts";
import { listen } from "./pointer.ts";

/** The groups of geoms that are hidden initially, as in MuJoCo. */
const HIDDEN = [3, 4, 5];

const sight: Sight = {
  groups: Array.from({ length: 32 }, (_, group) => !HIDDEN.includes(group)),
  hulls: false,
  transparent: false,
  sites: true,
  islands: false,
};
const layers: Layers = {
  contacts: true,
  forces: true,
  largest: false,
  constraints: true,
  cones: false,
  tendons: true,
  frames: false,
  joints: false,
  masses: false,
  inertia: false,
};

/** The parts of the page that require a scene and a frame. */
interface Parts {
  stage: Stage;
  panel: Panel;
  plots: Plots;
}

const view = document.getElementById("view")!;
const notice = document.getElementById("notice")!;

function notify(text: string): void {
  notice.textContent = text;
  notice.hidden = text === "";
}

function open(
  scene: Scene,
  first: Frame,
  send: (command: Command) => void,
  past: Replay | FrameBuffer,
): Parts {
  const replay = past instanceof Replay ? past : null;
  const frameBuffer = past instanceof FrameBuffer ? past : null;
  view.replaceChildren();
  const stage = new Stage(scene, first, sight, layers, view);
  const panel = new Panel(scene, stage, sight, layers, send, replay, frameBuffer);
  const plots = new Plots(scene, document.getElementById("plots")!);
  listen(replay ? { ...scene, active: false } : scene, stage, panel, send);
  return { stage, panel, plots };
}

function show(parts: Parts, frame: Frame): void {
  parts.stage.draw(frame, parts.panel.chosen);
  parts.panel.update(frame);
  parts.plots.add(frame);
  parts.plots.draw();
  // The drawn objects, for tests and for the console.
  Object.assign(window, { clench: { ...parts, frame } });
}

function watch(): void {
  let scene: Scene | null = null;
  let parts: Parts | null = null;
  const frameBuffer = new FrameBuffer(notify);
  const link = new Link({
    scene(loaded) {
      scene = loaded;
      parts?.stage.dispose();
      parts = null;
      frameBuffer.begin(loaded);
      notify("");
    },
    frame(frame) {
      frameBuffer.store(frame);
      parts ??= open(scene!, frame, (command) => link.send(command), frameBuffer);
      show(parts, frame);
    },
    error: notify,
    lost: () => notify("The simulation has ended, or cannot be reached. If it was restarted, open the address that it printed."),
  });
}

function play(replay: Replay): void {
  if (replay.frames.length === 0) {
    notify("This recording is empty.");
    return;
  }
  const parts = open(replay.scene, replay.frames[0], () => {}, replay);
  let last = performance.now();
  let plotted = -1;
  const tick = (now: number) => {
    const frame = replay.advance((now - last) / 1000);
    // The plots show all moments up to this one, including those that were not drawn.
    if (replay.at < plotted) plotted = -1;
    while (plotted < replay.at) parts.plots.add(replay.frames[++plotted]);
    show(parts, frame);
    last = now;
    requestAnimationFrame(tick);
  };
  requestAnimationFrame(tick);
}

notify("");
const replay = Replay.inPage();
if (replay) play(replay);
else watch();
