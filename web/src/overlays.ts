// Overlays: contacts, forces, friction cones, tendons, frames, joint axes, centres of mass.

import * as THREE from "three";
import type { Frame, Rows } from "./frame.ts";
import { Instances, standing, stretched, UP } from "./instances.ts";
import { Marks } from "./marks.ts";
import { poseOf } from "./poses.ts";
import type { Scene } from "./scene.ts";

/** The overlays that users select. */
export interface Layers {
  contacts: boolean;
  forces: boolean;
  /** True to show only the {@link LARGEST} contacts with the largest forces. */
  largest: boolean;
  /** Forces and torques of limits and equalities. */
  constraints: boolean;
  cones: boolean;
  tendons: boolean;
  frames: boolean;
  joints: boolean;
  masses: boolean;
  inertia: boolean;
}

/** The exaggeration of the displacement of a contact since it stuck: a tenth of a millimetre is shown as 3 cm. */
const EXAGGERATION = 300;
const STUCK = new THREE.Color(0x8a5cd6);
/** The number of shown contacts if only the largest are. */
export const LARGEST = 50;
/** The number of contacts above which their marks become smaller and thinner, down to a limit. */
const CROWD = 24;
const THINNEST = 0.45;
/** The opacity factor of the farthest of many contacts. */
const FARTHEST = 0.25;

const NORMAL = new THREE.Color(0x2f7de1);
const FRICTION = new THREE.Color(0xf08a24);
const PULL = new THREE.Color(0xd5348b);
const EQUALITY = new THREE.Color(0x8d5bd1);
const LIMIT = new THREE.Color(0xc9a400);
const STICKS = new THREE.Color(0x2eb872);
const SLIPS = new THREE.Color(0xe0342c);

/**
 * Creates a bright, unshaded material that is visible through objects in front of it, such as for a force inside a
 * foot.
 */
function glow(opacity: number, through = true): THREE.MeshBasicMaterial {
  return new THREE.MeshBasicMaterial({
    transparent: true,
    opacity,
    depthTest: !through,
    depthWrite: false,
    toneMapped: false,
  });
}

/** Returns the tendons whose limits exert a force. */
function strainedTendons(frame: Frame): Set<number> {
  const { data, count } = frame.rows.constraints;
  const rows = Array.from({ length: count }, (_, row) => data.subarray(3 * row, 3 * row + 3));
  return new Set(rows.filter(([kind, , force]) => kind === 2 && force > 0).map(([, tendon]) => tendon));
}

export class Overlays {
  readonly group = new THREE.Group();
  /** The length of force arrows, m/N. */
  forceScale = 0.002;
  /** The tendons at their limits. */
  private strained = new Set<number>();
  /** The relative thickness of contact marks: 1 for few contacts. */
  private thin = 1;
  private discs = new Instances(new THREE.CylinderGeometry(1, 1, 0.12, 32), glow(0.85), 3);
  private shafts = new Instances(standing(new THREE.CylinderGeometry(1, 1, 1, 12)), glow(0.95), 5);
  private heads = new Instances(standing(new THREE.ConeGeometry(1, 1, 20)), glow(0.95), 6);
  private cones = new Instances(
    standing(new THREE.ConeGeometry(1, 1, 40, 1, true).rotateX(Math.PI)),
    new THREE.MeshBasicMaterial({
      transparent: true,
      opacity: 0.22,
      side: THREE.DoubleSide,
      depthWrite: false,
      toneMapped: false,
    }),
    2,
  );
  private strings = new Instances(
    standing(new THREE.CylinderGeometry(1, 1, 1, 10)),
    new THREE.MeshStandardMaterial({ roughness: 0.6 }),
  );
  private balls = new Instances(new THREE.SphereGeometry(1, 20, 14), glow(0.9), 4);
  private boxes = new Instances(new THREE.BoxGeometry(2, 2, 2), glow(0.3), 4);
  private marks: Marks;

  constructor(
    private scene: Scene,
    private layers: Layers,
    /** The reference of the arrow length: an arrow for this weight, N, is about as long as this size, m. */
    heaviest: { weight: number; size: number },
    /** The length scale of marks on bodies, m. */
    private size: number,
  ) {
    for (const many of this.all()) this.group.add(many.group);
    this.marks = new Marks();
    this.group.add(this.marks.group);
    const { weight, size: length } = heaviest;
    if (weight > 0) this.forceScale = (0.8 * length) / weight;
  }

  /**
   * The length of torque arrows, m/(N m): equal to that of a force with this torque on a lever of a typical body's
   * length.
   */
  private get torqueScale(): number {
    return (3 * this.forceScale) / this.size;
  }

  private all(): Instances[] {
    return [this.discs, this.shafts, this.heads, this.cones, this.strings, this.balls, this.boxes];
  }

  /** Draws a frame, viewed from a point in the coordinates of its environment. */
  update(frame: Frame, poses: THREE.Matrix4[], eye: THREE.Vector3): void {
    const { contacts, spans, drag, turn, pushes } = frame.rows;
    const { scene, layers } = this;
    const marks = 3 * (scene.bodies.length + scene.joints.length);
    // A torque has two heads.
    const arrows = 3 * contacts.count + 3 * pushes.count + marks + 3;
    this.discs.begin(contacts.count);
    this.cones.begin(contacts.count);
    this.shafts.begin(arrows);
    this.heads.begin(arrows);
    this.strings.begin(spans.count);
    this.balls.begin(scene.bodies.length + 1);
    this.boxes.begin(scene.bodies.length);
    this.contacts(contacts, eye);
    this.thin = 1;
    if (layers.constraints) {
      for (let row = 0; row < pushes.count; row++) this.push(pushes.data.subarray(12 * row, 12 * row + 12));
    }
    this.strained = strainedTendons(frame);
    if (layers.tendons) {
      for (let row = 0; row < spans.count; row++) this.span(spans.data.subarray(7 * row, 7 * row + 7));
    }
    if (layers.frames) poses.forEach((pose, body) => body > 0 && this.axes(pose));
    if (layers.joints) scene.joints.forEach((_, joint) => this.joint(joint, poses));
    scene.bodies.forEach((_, body) => body > 0 && this.mass(body, poses[body]));
    if (drag.count > 0) this.drag(drag.data);
    if (turn.count > 0) this.turn(turn.data);
    this.marks.update(frame);
    for (const many of this.all()) many.end();
  }

  private contacts({ data, count, width }: Rows, eye: THREE.Vector3): void {
    let rows = Array.from({ length: count }, (_, row) => data.subarray(width * row, width * (row + 1)));
    const neighbours = this.neighbours(rows);
    if (this.layers.largest) rows = rows.sort((a, b) => b[12] - a[12]).slice(0, LARGEST);
    this.thin = Math.max(THINNEST, Math.min(1, Math.sqrt(CROWD / rows.length)));
    const distances = rows.map(([x, y, z]) => eye.distanceTo(new THREE.Vector3(x, y, z)));
    const near = Math.min(...distances);
    const depth = Math.max(...distances) - near;
    rows.forEach((row, k) => {
      const fade = rows.length > CROWD && depth > 0 ? 1 - ((1 - FARTHEST) * (distances[k] - near)) / depth : 1;
      this.contact(row, this.side(row, neighbours), fade);
    });
  }

  /** Returns the bodies that touch each body. */
  private neighbours(rows: Float32Array[]): Map<number, Set<number>> {
    const found = new Map<number, Set<number>>();
    for (const row of rows) {
      const [first, second] = this.bodiesOf(row);
      for (const [body, other] of [[first, second], [second, first]]) {
        if (!found.has(body)) found.set(body, new Set());
        found.get(body)!.add(other);
      }
    }
    return found;
  }

  private bodiesOf(row: Float32Array): number[] {
    return [row[17], row[18]].map((geom) => this.scene.geoms[geom]?.body ?? 0);
  }

  /**
   * Returns the body that the force is drawn on: 1 for the second, which the normal points into, -1 for the first. It
   * is movable; of two movable bodies it is the one that touches fewer others, since both arrows of a body pinched
   * between two would overlap.
   */
  private side(row: Float32Array, neighbours: Map<number, Set<number>>): number {
    const [first, second] = this.bodiesOf(row);
    const { bodies } = this.scene;
    if (!bodies[first].free || !bodies[second].free) return bodies[first].free ? -1 : 1;
    return neighbours.get(first)!.size < neighbours.get(second)!.size ? -1 : 1;
  }

  private contact(row: Float32Array, side: number, fade: number): void {
    const place = new THREE.Vector3(row[0], row[1], row[2]);
    const axis = (k: number) => new THREE.Vector3(row[3 + 3 * k], row[4 + 3 * k], row[5 + 3 * k]).multiplyScalar(side);
    const [normal, first, second] = [axis(0), axis(1), axis(2)];
    const [pressure, along, across] = [row[12], row[13], row[14]];
    const friction = row[16];
    const sideways = Math.hypot(along, across);
    // 0 for no tangential force, 1 on the cone.
    const limit = friction * Math.max(pressure, 1e-9);
    const near = row[19] > 1 ? Math.min(1, sideways / limit) : 0;
    const colour = STICKS.clone().lerp(SLIPS, near);
    const radius = 0.018 * this.size * this.thin;
    if (this.layers.contacts) {
      this.discs.add(stretched(place, normal, radius, radius), pressure > 0 ? colour : new THREE.Color(0x9a9aa2), fade);
    }
    if (this.layers.contacts) {
      // The arrow shows the displacement of the body that is drawn on, relative to the other, since they stuck.
      const moved = first.clone().multiplyScalar(row[20]).addScaledVector(second, row[21]).multiplyScalar(EXAGGERATION);
      this.arrow(place.clone().sub(moved), moved, STUCK, fade);
    }
    if (pressure > 0 && this.layers.forces) {
      this.arrow(place, normal.clone().multiplyScalar(pressure * this.forceScale), NORMAL, fade);
      const force = first.multiplyScalar(along).addScaledVector(second, across);
      this.arrow(place, force.multiplyScalar(this.forceScale), FRICTION, fade);
    }
    if (pressure > 0 && this.layers.cones && row[19] > 1) {
      const height = pressure * this.forceScale;
      this.cones.add(stretched(place, normal, friction * height, height), colour, fade);
    }
  }

  /** Draws an arrow; very short ones are omitted. */
  private arrow(from: THREE.Vector3, along: THREE.Vector3, colour: THREE.Color, fade = 1): void {
    const length = along.length();
    const thick = 0.0085 * this.size * this.thin;
    if (length < 0.2 * thick) return;
    const direction = along.clone().divideScalar(length);
    const head = Math.min(4 * thick, 0.5 * length);
    this.shafts.add(stretched(from, direction, thick, length), colour, fade);
    const base = from.clone().addScaledVector(direction, length - head);
    this.heads.add(stretched(base, direction, 2.4 * thick, 1.15 * head), colour, fade);
  }

  private span(row: Float32Array): void {
    const { rgba, width } = this.scene.tendons[row[0]];
    const from = new THREE.Vector3(row[1], row[2], row[3]);
    const along = new THREE.Vector3(row[4], row[5], row[6]).sub(from);
    const length = along.length();
    if (length === 0) return;
    const colour = this.strained.has(row[0])
      ? LIMIT
      : new THREE.Color().setRGB(rgba[0], rgba[1], rgba[2], THREE.SRGBColorSpace);
    this.strings.add(stretched(from, along.divideScalar(length), width, length), colour);
  }

  private axes(pose: THREE.Matrix4): void {
    const place = new THREE.Vector3().setFromMatrixPosition(pose);
    [0xd94141, 0x3aa757, 0x3f6fd9].forEach((colour, k) => {
      const axis = new THREE.Vector3().setFromMatrixColumn(pose, k);
      this.arrow(place, axis.multiplyScalar(0.1 * this.size), new THREE.Color(colour));
    });
  }

  private joint(index: number, poses: THREE.Matrix4[]): void {
    const { kind, body, pos, axis } = this.scene.joints[index];
    if (kind === "free" || kind === "ball") return;
    const place = new THREE.Vector3(...pos).applyMatrix4(poses[body]);
    const along = new THREE.Vector3(...axis).transformDirection(poses[body]);
    this.arrow(place, along.multiplyScalar(0.14 * this.size), new THREE.Color(0x25a7b8));
  }

  private mass(body: number, pose: THREE.Matrix4): void {
    const { mass, inertia, ipos, iquat } = this.scene.bodies[body];
    if (mass <= 0) return;
    const centre = new THREE.Vector3(...ipos).applyMatrix4(pose);
    if (this.layers.masses) {
      const radius = 0.02 * this.size;
      this.balls.add(stretched(centre, UP, radius, radius), new THREE.Color(0x8d5bd1));
    }
    if (this.layers.inertia) {
      // The box of equal density with these moments of inertia: x² = 3/2 (Iy + Iz − Ix) / m for its half length x.
      const [x, y, z] = inertia;
      const half = (sum: number) => Math.sqrt(Math.max(0, (1.5 * sum) / mass));
      const place = pose.clone().multiply(poseOf(ipos, iquat));
      place.scale(new THREE.Vector3(half(y + z - x), half(x + z - y), half(x + y - z)));
      this.boxes.add(place, new THREE.Color(0x8d5bd1));
    }
  }

  private drag(row: Float32Array): void {
    const from = new THREE.Vector3(row[1], row[2], row[3]);
    const along = new THREE.Vector3(row[4], row[5], row[6]).sub(from);
    this.arrow(from, along, PULL);
    const radius = 0.012 * this.size;
    this.balls.add(stretched(from, UP, radius, radius), PULL);
  }

  /** Draws a limit or an equality: an arrow for its force, one with two heads for its torque. */
  private push(row: Float32Array): void {
    const colour = row[0] === 1 ? LIMIT : EQUALITY;
    const at = new THREE.Vector3(row[3], row[4], row[5]);
    const force = new THREE.Vector3(row[6], row[7], row[8]).multiplyScalar(this.forceScale);
    const torque = new THREE.Vector3(row[9], row[10], row[11]).multiplyScalar(this.torqueScale);
    this.arrow(at, force, colour);
    this.torque(at, torque, colour);
  }

  /** Draws an arrow along the axis of a torque, with two heads. */
  private torque(from: THREE.Vector3, along: THREE.Vector3, colour: THREE.Color): void {
    this.arrow(from, along, colour);
    const head = 4 * 0.0085 * this.size;
    if (along.length() > 2 * head) this.arrow(from, along.clone().setLength(along.length() - head), colour);
  }

  private turn(row: Float32Array): void {
    const from = new THREE.Vector3(row[1], row[2], row[3]);
    const left = new THREE.Vector3(row[4], row[5], row[6]).multiplyScalar(0.5 * this.size);
    this.torque(from, left, PULL);
    const radius = 0.012 * this.size;
    this.balls.add(stretched(from, UP, radius, radius), PULL);
  }

  /** Returns the numbers of balls, shafts, heads and texts of the program's marks, for tests. */
  markCounts(): number[] {
    return this.marks.counts();
  }

  /** Returns the ends of all arrows, m, for tests. */
  arrows(): [number[], number[]][] {
    return Array.from({ length: this.shafts.size }, (_, k) => this.shafts.endsOf(k));
  }

  /** The number of shown contacts, for tests. */
  get discCount(): number {
    return this.discs.size;
  }
}
