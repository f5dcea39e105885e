// The connection to the server. It requests a frame when the last one has been drawn.

import { decode, whole, type Frame } from "./frame.ts";
import type { Scene } from "./scene.ts";

export type Command = { do: string } & Record<string, unknown>;

export interface Listener {
  scene(scene: Scene): void;
  frame(frame: Frame): void;
  error(text: string): void;
  lost(): void;
}

/** The delay before reconnecting, ms. */
const PAUSE = 1000;

export class Link {
  private socket: WebSocket | null = null;
  private scene: Scene | null = null;
  /** The last frame that was received. */
  private last: ArrayBuffer | null = null;

  constructor(private listener: Listener) {
    this.connect();
  }

  private connect(): void {
    const token = new URLSearchParams(location.search).get("token") ?? "";
    const address = `${location.origin.replace(/^http/, "ws")}/socket?token=${encodeURIComponent(token)}`;
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    socket.onmessage = (event) => this.take(event.data as string | ArrayBuffer);
    socket.onclose = () => {
      this.listener.lost();
      setTimeout(() => this.connect(), PAUSE);
    };
    this.socket = socket;
  }

  private take(data: string | ArrayBuffer): void {
    if (typeof data === "string") {
      const message = JSON.parse(data) as Scene | { error: string };
      if ("error" in message) {
        this.listener.error(message.error);
        return;
      }
      this.scene = message;
      this.last = null;
      this.listener.scene(message);
      this.next();
    } else {
      this.last = this.scene && whole(this.scene, data, this.last);
      const frame = this.scene && this.last && decode(this.scene, this.last);
      if (frame) this.listener.frame(frame);
      requestAnimationFrame(() => this.next());
    }
  }

  private next(): void {
    this.say({ do: "next", changes: this.last !== null });
  }

  private say(what: object): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(what));
  }

  send(command: Command): void {
    this.say(command);
  }
}
