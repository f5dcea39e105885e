// The marks that the program draws: spheres, lines, arrows, texts.

import * as THREE from "three";
import { textsOf, type Frame } from "./frame.ts";
import { Labels } from "./labels.ts";
import { Instances, standing, stretched, UP } from "./instances.ts";

/** The number of opacity levels: marks of one level share a call. */
const STEPS = 10;

class Solids {
  readonly balls: Instances;
  readonly shafts: Instances;
  readonly heads: Instances;

  constructor(opacity: number) {
    const transparent = opacity < 1;
    const surface = new THREE.MeshStandardMaterial({ roughness: 0.6, transparent, opacity, depthWrite: !transparent });
    this.balls = new Instances(new THREE.SphereGeometry(1, 24, 16), surface);
    this.shafts = new Instances(standing(new THREE.CylinderGeometry(1, 1, 1, 14)), surface);
    this.heads = new Instances(standing(new THREE.ConeGeometry(1, 1, 20)), surface);
  }

  all(): Instances[] {
    return [this.balls, this.shafts, this.heads];
  }
}

export class Marks {
  readonly group = new THREE.Group();
  private solids = new Map<number, Solids>();
  private labels = new Labels();

  constructor() {
    this.group.add(this.labels.group);
  }

  update(frame: Frame): void {
    const { data, count } = frame.rows.marks;
    this.solids.forEach((solids) => solids.all().forEach((many) => many.begin(count)));
    this.labels.begin();
    const texts = count > 0 ? textsOf(frame) : [];
    for (let row = 0; row < count; row++) this.add(data.subarray(12 * row, 12 * row + 12), texts[row], count);
    this.solids.forEach((solids) => solids.all().forEach((many) => many.end()));
    this.labels.end();
  }

  private of(opacity: number, max: number): Solids {
    const step = Math.round(opacity * STEPS);
    let solids = this.solids.get(step);
    if (!solids) {
      solids = new Solids(step / STEPS);
      solids.all().forEach((many) => {
        many.begin(max);
        this.group.add(many.group);
      });
      this.solids.set(step, solids);
    }
    return solids;
  }

  private add(mark: Float32Array, text: string, max: number): void {
    const kind = mark[0];
    const from = new THREE.Vector3(mark[1], mark[2], mark[3]);
    const along = new THREE.Vector3(mark[4], mark[5], mark[6]).sub(from);
    const radius = mark[7];
    const colour = new THREE.Color().setRGB(mark[8], mark[9], mark[10], THREE.SRGBColorSpace);
    if (kind === 3) {
      this.labels.add(text, from, colour);
      return;
    }
    const { balls, shafts, heads } = this.of(mark[11], max);
    const length = along.length();
    const direction = length > 0 ? along.divideScalar(length) : UP;
    const head = kind === 2 ? Math.min(5 * radius, 0.5 * length) : 0;
    if (kind === 0) balls.add(stretched(from, UP, radius, radius), colour);
    else shafts.add(stretched(from, direction, radius, length - head), colour);
    if (kind === 2) {
      heads.add(stretched(from.addScaledVector(direction, length - head), direction, 2.4 * radius, head), colour);
    }
  }

  /** Returns the numbers of balls, shafts, heads and texts. */
  counts(): number[] {
    const counts = [0, 0, 0, this.labels.count];
    this.solids.forEach((solids) => solids.all().forEach((many, k) => (counts[k] += many.size)));
    return counts;
  }
}
