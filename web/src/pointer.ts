// The pointer in the picture: names under it, clicks that select, drags that pull.

import * as THREE from "three";
import type { Command } from "./link.ts";
import type { Panel } from "./panel.ts";
import { nameOf, type Scene } from "./scene.ts";
import type { Stage } from "./stage.ts";

/** The maximum movement of a click, pixels. */
const CLICK = 4;

export function listen(scene: Scene, stage: Stage, panel: Panel, send: (command: Command) => void): void {
  const { canvas } = stage;
  const label = document.getElementById("label")!;
  let pressed: { x: number; y: number } | null = null;
  let pulled: { body: number; point: [number, number, number]; plane: THREE.Plane } | null = null;
  let turned: { body: number; from: THREE.Quaternion; x: number; y: number } | null = null;

  const pull = (event: PointerEvent) => {
    const target = stage.rayAt(event.clientX, event.clientY).ray.intersectPlane(pulled!.plane, new THREE.Vector3());
    if (target) send({ do: "drag", body: pulled!.body, point: pulled!.point, target: target.sub(stage.offset).toArray() });
  };

  /** Rotates the body with the pointer like a rolling ball: half a turn over the height of the picture. */
  const rotate = (event: PointerEvent) => {
    const { body, from, x, y } = turned!;
    const scale = Math.PI / canvas.clientHeight;
    const axis = (k: number) => new THREE.Vector3().setFromMatrixColumn(stage.camera.matrixWorld, k);
    const rolled = new THREE.Quaternion()
      .setFromAxisAngle(axis(1), scale * (event.clientX - x))
      .multiply(new THREE.Quaternion().setFromAxisAngle(axis(0), scale * (event.clientY - y)))
      .multiply(from)
      .normalize();
    send({ do: "turn", body, target: [rolled.w, rolled.x, rolled.y, rolled.z] });
  };

  canvas.addEventListener(
    "pointerdown",
    (event) => {
      pressed = { x: event.clientX, y: event.clientY };
      if (!(event.ctrlKey || event.shiftKey || event.metaKey) || !scene.active) return;
      const hit = stage.bodies.pick(stage.rayAt(event.clientX, event.clientY));
      if (!hit || !scene.bodies[hit.body].free) return;
      // Only the environment whose contacts are shown can be interacted with.
      const env = stage.envAt(hit);
      if (env !== null && env !== panel.env) {
        panel.show({ env });
        return;
      }
      stage.controls.enabled = false;
      canvas.setPointerCapture(event.pointerId);
      panel.choose(hit.body);
      if (event.button === 2 || event.altKey) {
        const from = new THREE.Quaternion().setFromRotationMatrix(stage.poses[hit.body]);
        turned = { body: hit.body, from, x: event.clientX, y: event.clientY };
        rotate(event);
        return;
      }
      const facing = stage.camera.getWorldDirection(new THREE.Vector3());
      const local = hit.point.clone().sub(stage.offset).applyMatrix4(stage.poses[hit.body].clone().invert());
      pulled = {
        body: hit.body,
        point: local.toArray(),
        plane: new THREE.Plane().setFromNormalAndCoplanarPoint(facing, hit.point),
      };
      pull(event);
    },
    { capture: true },
  );

  canvas.addEventListener("pointermove", (event) => {
    if (pulled || turned) {
      if (pulled) pull(event);
      else rotate(event);
      return;
    }
    if (event.buttons !== 0) return;
    const hit = stage.bodies.pick(stage.rayAt(event.clientX, event.clientY));
    label.hidden = !hit;
    if (!hit) return;
    const body = scene.bodies[hit.body];
    const geom = nameOf("geom", hit.geom, scene.geoms[hit.geom].name);
    const owner = nameOf("body", hit.body, hit.body === 0 ? "world" : body.name);
    label.textContent = geom === owner ? owner : `${geom} · ${owner}`;
    label.style.transform = `translate(${event.clientX + 14}px, ${event.clientY + 14}px)`;
  });

  canvas.addEventListener("pointerup", (event) => {
    if (pulled || turned) {
      send({ do: "release" });
      pulled = turned = null;
      stage.controls.enabled = stage.through === null;
    } else if (pressed && Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) < CLICK) {
      const hit = stage.bodies.pick(stage.rayAt(event.clientX, event.clientY));
      const env = hit && stage.envAt(hit);
      if (env !== null && env !== panel.env) panel.show({ env });
      panel.choose(hit?.body ?? null);
    }
    pressed = null;
  });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());

  window.onkeydown = (event) => {
    if (event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement) return;
    if (event.key === " ") panel.toggle();
    else if (event.key === "h") stage.home();
    else if (!scene.active) return;
    else if (event.key === "ArrowRight") send({ do: "step", count: 1 });
    else if (event.key === "ArrowLeft" && scene.rewinds) send({ do: "rewind", seconds: 1 });
    else if (event.key === "Backspace") send({ do: "reset" });
    else return;
    event.preventDefault();
  };
}
