// Many of one shape, drawn in one call.

import * as THREE from "three";

/** The axis that shapes are drawn along before they are turned. */
export const UP = new THREE.Vector3(0, 1, 0);

/** As many of one shape as a frame needs. */
export class Many {
  readonly group = new THREE.Group();
  private mesh: THREE.InstancedMesh;
  private count = 0;

  constructor(
    private shape: THREE.BufferGeometry,
    private surface: THREE.Material,
    private order = 0,
  ) {
    this.mesh = this.make(64);
  }

  private make(room: number): THREE.InstancedMesh {
    const mesh = new THREE.InstancedMesh(this.shape, this.surface, room);
    mesh.frustumCulled = false;
    mesh.renderOrder = this.order;
    mesh.setColorAt(0, new THREE.Color());
    this.group.clear();
    this.group.add(mesh);
    return mesh;
  }

  begin(most: number): void {
    this.count = 0;
    if (most > this.mesh.instanceMatrix.count) {
      this.mesh.dispose();
      this.mesh = this.make(2 * most);
    }
  }

  add(place: THREE.Matrix4, colour: THREE.Color): void {
    this.mesh.setMatrixAt(this.count, place);
    this.mesh.setColorAt(this.count, colour);
    this.count += 1;
  }

  end(): void {
    this.mesh.count = this.count;
    this.mesh.instanceMatrix.needsUpdate = true;
    if (this.mesh.instanceColor) this.mesh.instanceColor.needsUpdate = true;
  }

  /** The length of an instance along its own y, as it is drawn. */
  lengthOf(index: number): number {
    const place = new THREE.Matrix4();
    this.mesh.getMatrixAt(index, place);
    return new THREE.Vector3().setFromMatrixColumn(place, 1).length();
  }

  get size(): number {
    return this.count;
  }
}

/** From y = 0 to y = 1. */
export function standing(geometry: THREE.BufferGeometry): THREE.BufferGeometry {
  return geometry.translate(0, 0.5, 0);
}

/** A unit shape along y, so wide, and so long along a direction from a point. */
export function stretched(from: THREE.Vector3, along: THREE.Vector3, wide: number, long: number): THREE.Matrix4 {
  const turn = new THREE.Quaternion().setFromUnitVectors(UP, along);
  return new THREE.Matrix4().compose(from, turn, new THREE.Vector3(wide, long, wide));
}
