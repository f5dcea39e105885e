// Poses of bodies in frames.

import * as THREE from "three";
import type { Frame, Rows } from "./frame.ts";
import type { Numbers3, Numbers4 } from "./scene.ts";

export const ONE = new THREE.Vector3(1, 1, 1);

export function poseOf(pos: ArrayLike<number>, quat: ArrayLike<number>): THREE.Matrix4 {
  // Quaternions of models have w first, those of three.js have it last.
  const rotation = new THREE.Quaternion(quat[1], quat[2], quat[3], quat[0]);
  return new THREE.Matrix4().compose(new THREE.Vector3(pos[0], pos[1], pos[2]), rotation, ONE);
}

export function localPose(placed: { pos: Numbers3; quat: Numbers4 }): THREE.Matrix4 {
  return poseOf(placed.pos, placed.quat);
}

/** Reads the poses of `count` rows from `first` on; extends `poses` as needed. */
function read({ data }: Rows, first: number, count: number, poses: THREE.Matrix4[]): void {
  for (let body = 0; body < count; body++) {
    const at = 7 * (first + body);
    poses[body] = poseOf(data.subarray(at, at + 3), data.subarray(at + 3, at + 7));
  }
}

/** Reads the pose of every body. */
export function readPoses(frame: Frame, poses: THREE.Matrix4[]): void {
  read(frame.rows.bodies, 0, frame.rows.bodies.count, poses);
}

/** Reads the pose of every body of the k-th shown environment. */
export function readPosesOf(k: number, frame: Frame, poses: THREE.Matrix4[]): void {
  const { count } = frame.rows.bodies;
  read(frame.rows.poses, k * count, count, poses);
}
