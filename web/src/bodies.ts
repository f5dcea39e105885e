// The geoms and sites of a model, drawn by instances: all elements of equal shape and surface take one call.

import * as THREE from "three";
import { localPose } from "./poses.ts";
import type { Geom, Numbers4, Placed, Scene } from "./scene.ts";
import { materialOf, shapeOf } from "./shapes.ts";

/** The visible elements that users select. */
export interface Sight {
  groups: boolean[];
  hulls: boolean;
  transparent: boolean;
  sites: boolean;
  /** True to draw bodies in the colours of their islands. */
  islands: boolean;
}

interface Drawn {
  placed: Placed;
  index: number;
  local: THREE.Matrix4;
  mesh: THREE.InstancedMesh;
  slot: number;
  /** The index of its environment among those side by side. */
  copyIndex: number;
}

/** The state of a drawn environment. */
export interface Copy {
  poses: THREE.Matrix4[];
  fails: boolean;
  /** The sleep state of each tree, if available. */
  asleep: Float32Array;
  /** The island of each tree, by the lowest index of its trees, if available; -1 if no constraint acts on the tree. */
  islands: Float32Array;
  /** The selected body. */
  chosen: number | null;
}

/** The element under the pointer. */
export interface Hit {
  geom: number;
  body: number;
  point: THREE.Vector3;
  /** The index of the environment among those side by side. */
  copyIndex: number;
}

const SLEEPING = new THREE.Color(0.45, 0.45, 0.48);
const CHOSEN = new THREE.Color(1.0, 0.62, 0.12);
const FAILED = new THREE.Color(0.75, 0.1, 0.1);
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
    /** The number of environments with allocated instances. */
    private capacity: number,
  ) {
    this.rebuild();
  }

  /** Allocates instances for `capacity` environments. */
  resize(capacity: number): void {
    if (capacity === this.capacity) return;
    this.capacity = capacity;
    this.rebuild();
  }

  /** Rebuilds all instances after the visible elements have changed. */
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
      // Opaque elements of one shape can differ in colour.
      const opacity = rgba[3] < 1 ? rgba.join() : "";
      const key = [kind, size.join(), material, mesh, hfield, opacity].join("|");
      alike.set(key, [...(alike.get(key) ?? []), index]);
    });
    const drawn: Drawn[] = [];
    for (const indices of alike.values()) {
      const first = all[indices[0]];
      // All environments share a plane of the world.
      const shared = first.kind === "plane" && first.body === 0 && this.capacity > 1;
      const copies = shared ? 1 : this.capacity;
      const surface = materialOf(this.scene, first);
      surface.color.set(0xffffff);
      if (surface.emissiveIntensity === 0) surface.emissive.set(0);
      if (this.sight.transparent && geoms && first.kind !== "plane") {
        surface.transparent = true;
        surface.opacity *= THROUGH;
        surface.depthWrite = false;
      }
      const endless: Placed = { ...first, size: [0, 0, first.size[2]] };
      const shape = shapeOf(this.scene, shared ? endless : first, this.sight.hulls);
      const mesh = new THREE.InstancedMesh(shape, surface, indices.length * copies);
      mesh.castShadow = geoms && !surface.transparent && first.kind !== "plane";
      mesh.receiveShadow = geoms;
      mesh.frustumCulled = false;
      const here = Array.from({ length: indices.length * copies }, (_, slot) => {
        const index = indices[slot % indices.length];
        const placed = all[index];
        mesh.setColorAt(slot, tint(placed.rgba));
        return { placed, index, local: localPose(placed), mesh, slot, copyIndex: Math.floor(slot / indices.length) };
      });
      if (geoms) this.shown.set(mesh, here);
      this.group.add(mesh);
      drawn.push(...here);
    }
    return drawn;
  }

  /** Updates all poses and colours; there are as many copies as allocated environments. */
  update(copies: Copy[]): void {
    const matrix = new THREE.Matrix4();
    for (const drawn of this.geoms) {
      const { body, group, rgba } = drawn.placed;
      const { poses, fails, asleep, islands, chosen } = copies[drawn.copyIndex];
      const visible = this.sight.groups[group] ?? true;
      matrix.multiplyMatrices(poses[body], drawn.local);
      drawn.mesh.setMatrixAt(drawn.slot, visible ? matrix : NOWHERE);
      const tree = this.scene.trees[body];
      const colour = tint(rgba);
      if (this.sight.islands && tree !== null && islands[tree] >= 0) colour.lerp(islandColour(islands[tree]), 0.8);
      if (tree !== null && asleep[tree] >= 0) colour.lerp(SLEEPING, 0.75);
      if (fails && body !== 0) colour.lerp(FAILED, 0.7);
      if (body === chosen && body !== 0) colour.lerp(CHOSEN, 0.55);
      drawn.mesh.setColorAt(drawn.slot, colour);
    }
    for (const drawn of this.sites) {
      const { body, group } = drawn.placed;
      matrix.multiplyMatrices(copies[drawn.copyIndex].poses[body], drawn.local);
      drawn.mesh.setMatrixAt(drawn.slot, this.sight.sites && (this.sight.groups[group] ?? true) ? matrix : NOWHERE);
    }
    for (const mesh of this.group.children as THREE.InstancedMesh[]) {
      mesh.instanceMatrix.needsUpdate = true;
      if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
      mesh.boundingSphere = null;
    }
  }

  /** Returns the nearest geom along a ray. */
  pick(ray: THREE.Raycaster): Hit | null {
    for (const hit of ray.intersectObjects([...this.shown.keys()], false)) {
      const drawn = this.shown.get(hit.object)?.[hit.instanceId ?? -1];
      if (drawn) return { geom: drawn.index, body: drawn.placed.body, point: hit.point, copyIndex: drawn.copyIndex };
    }
    return null;
  }
}

/** Returns a colour that differs clearly between consecutive indices: the hue advances by the golden ratio. */
function islandColour(island: number): THREE.Color {
  return new THREE.Color().setHSL((0.11 + 0.618034 * island) % 1, 0.72, 0.5, THREE.SRGBColorSpace);
}

function tint(rgba: Numbers4): THREE.Color {
  return new THREE.Color().setRGB(rgba[0], rgba[1], rgba[2], THREE.SRGBColorSpace);
}
