// The geoms and sites of a model, drawn by instances: as many of a shape and surface as there are take one call.

import * as THREE from "three";
import type { Frame } from "./frame.ts";
import { localPose } from "./poses.ts";
import type { Geom, Numbers4, Placed, Scene } from "./scene.ts";
import { materialOf, shapeOf } from "./shapes.ts";

/** What users choose to see. */
export interface Sight {
  groups: boolean[];
  hulls: boolean;
  transparent: boolean;
  sites: boolean;
}

interface Drawn {
  placed: Placed;
  index: number;
  local: THREE.Matrix4;
  mesh: THREE.InstancedMesh;
  slot: number;
}

const SLEEPING = new THREE.Color(0.45, 0.45, 0.48);
const CHOSEN = new THREE.Color(1.0, 0.62, 0.12);
const NOWHERE = new THREE.Matrix4().makeScale(0, 0, 0);
const THROUGH = 0.35;

export class Bodies {
  readonly group = new THREE.Group();
  private geoms: Drawn[] = [];
  private sites: Drawn[] = [];
  private shown = new Map<THREE.Object3D, Drawn[]>();

  constructor(
    private scene: Scene,
    private sight: Sight,
  ) {
    this.rebuild();
  }

  /** Makes everything anew, after what is seen has changed. */
  rebuild(): void {
    this.group.traverse((object) => {
      if (object instanceof THREE.InstancedMesh) object.dispose();
    });
    this.group.clear();
    this.shown.clear();
    this.geoms = this.instances(this.scene.geoms, true);
    this.sites = this.instances(this.scene.sites, false);
  }

  private instances(all: Placed[], geoms: boolean): Drawn[] {
    const alike = new Map<string, number[]>();
    all.forEach((placed, index) => {
      const { kind, size, material, rgba } = placed;
      const { mesh, hfield } = placed as Partial<Geom>;
      // Opaque ones of one shape can differ in colour.
      const opacity = rgba[3] < 1 ? rgba.join() : "";
      const key = [kind, size.join(), material, mesh, hfield, opacity].join("|");
      alike.set(key, [...(alike.get(key) ?? []), index]);
    });
    const drawn: Drawn[] = [];
    for (const indices of alike.values()) {
      const first = all[indices[0]];
      const surface = materialOf(this.scene, first);
      surface.color.set(0xffffff);
      if (surface.emissiveIntensity === 0) surface.emissive.set(0);
      if (this.sight.transparent && geoms && first.kind !== "plane") {
        surface.transparent = true;
        surface.opacity *= THROUGH;
        surface.depthWrite = false;
      }
      const shape = shapeOf(this.scene, first, this.sight.hulls);
      const mesh = new THREE.InstancedMesh(shape, surface, indices.length);
      mesh.castShadow = geoms && !surface.transparent && first.kind !== "plane";
      mesh.receiveShadow = geoms;
      mesh.frustumCulled = false;
      const here = indices.map((index, slot) => {
        const placed = all[index];
        mesh.setColorAt(slot, tint(placed.rgba));
        return { placed, index, local: localPose(placed), mesh, slot };
      });
      if (geoms) this.shown.set(mesh, here);
      this.group.add(mesh);
      drawn.push(...here);
    }
    return drawn;
  }

  /** Moves everything to where it is in a frame. */
  update(frame: Frame, poses: THREE.Matrix4[], chosen: number | null): void {
    const asleep = frame.rows.asleep;
    const place = new THREE.Matrix4();
    for (const drawn of this.geoms) {
      const { body, group, rgba } = drawn.placed as Geom;
      const visible = this.sight.groups[group] ?? true;
      place.multiplyMatrices(poses[body], drawn.local);
      drawn.mesh.setMatrixAt(drawn.slot, visible ? place : NOWHERE);
      const tree = this.scene.trees[body];
      const sleeps = tree !== null && tree < asleep.count && asleep.data[tree] >= 0;
      const colour = tint(rgba);
      if (sleeps) colour.lerp(SLEEPING, 0.75);
      if (body === chosen && body !== 0) colour.lerp(CHOSEN, 0.55);
      drawn.mesh.setColorAt(drawn.slot, colour);
    }
    for (const drawn of this.sites) {
      place.multiplyMatrices(poses[drawn.placed.body], drawn.local);
      drawn.mesh.setMatrixAt(drawn.slot, this.sight.sites ? place : NOWHERE);
    }
    for (const mesh of this.group.children as THREE.InstancedMesh[]) {
      mesh.instanceMatrix.needsUpdate = true;
      if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
      mesh.boundingSphere = null;
    }
  }

  /** The nearest geom along a ray. */
  pick(ray: THREE.Raycaster): { geom: number; body: number; point: THREE.Vector3 } | null {
    for (const hit of ray.intersectObjects([...this.shown.keys()], false)) {
      const drawn = this.shown.get(hit.object)?.[hit.instanceId ?? -1];
      if (drawn) return { geom: drawn.index, body: drawn.placed.body, point: hit.point };
    }
    return null;
  }
}

function tint(rgba: Numbers4): THREE.Color {
  return new THREE.Color().setRGB(rgba[0], rgba[1], rgba[2], THREE.SRGBColorSpace);
}
