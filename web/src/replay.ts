// The replay of an embedded recording, with a slider for time.

import { decode, type Frame } from "./frame.ts";
import { bytesOf, type Scene } from "./scene.ts";

interface Recording {
  scene: Scene;
  frames: string[];
}

export class Replay {
  readonly scene: Scene;
  readonly frames: Frame[];
  at = 0;
  playing = true;
  speed = 1;
  private clock = 0;

  constructor(recording: Recording) {
    this.scene = recording.scene;
    const decoded = recording.frames.map((frame) => decode(this.scene, bytesOf(frame)));
    this.frames = decoded.filter((frame): frame is Frame => frame !== null);
    this.clock = this.frames[0]?.time ?? 0;
  }

  /** Returns the embedded recording of the page, if there is one. */
  static inPage(): Replay | null {
    const carried = document.getElementById("recording")!.textContent;
    return carried ? new Replay(JSON.parse(carried) as Recording) : null;
  }

  /** Advances by real time, s, and restarts after the end. */
  advance(seconds: number): Frame {
    const { frames } = this;
    if (this.playing) {
      this.clock += seconds * this.speed;
      if (this.clock > frames[frames.length - 1].time) this.seek(0);
      while (this.at + 1 < frames.length && frames[this.at + 1].time <= this.clock) this.at += 1;
    }
    return frames[this.at];
  }

  seek(index: number): void {
    this.at = index;
    this.clock = this.frames[index].time;
  }
}
