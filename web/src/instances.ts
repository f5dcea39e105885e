// Many instances of one shape, drawn in one call.

import * as THREE from "three";

/** The axis of shapes before they are rotated. */
export const UP = new THREE.Vector3(0, 1, 0);

/** The instances of one shape in a frame. */
export class Instances {
  readonly group = new THREE.Group();
  private mesh: THREE.InstancedMesh;
  private fades!: THREE.InstancedBufferAttribute;
  private count = 0;

  constructor(
    private shape: THREE.BufferGeometry,
    private surface: THREE.Material,
    private order = 0,
  ) {
    // Instances of three.js have a colour each, but no opacity.
    surface.onBeforeCompile = (shader) => {
      shader.vertexShader = `attribute float fade;\nvarying float vFade;\n${shader.vertexShader}`.replace(
        "#include <begin_vertex>",
        "#include <begin_vertex>\nvFade = fade;",
      );
      shader.fragmentShader = `varying float vFade;\n${shader.fragmentShader}`.replace(
        "#include <color_fragment>",
        "#include <color_fragment>\ndiffuseColor.a *= vFade;",
      );
    };
    this.mesh = this.make(64);
  }

  private make(capacity: number): THREE.InstancedMesh {
    const mesh = new THREE.InstancedMesh(this.shape, this.surface, capacity);
    this.fades = new THREE.InstancedBufferAttribute(new Float32Array(capacity), 1);
    this.shape.setAttribute("fade", this.fades);
    mesh.frustumCulled = false;
    mesh.renderOrder = this.order;
    mesh.setColorAt(0, new THREE.Color());
    this.group.clear();
    this.group.add(mesh);
    return mesh;
  }

  begin(max: number): void {
    this.count = 0;
    if (max > this.mesh.instanceMatrix.count) {
      this.mesh.dispose();
      this.mesh = this.make(2 * max);
    }
  }

  /** Adds an instance; `fade` is a factor on its surface's opacity, which has an effect on transparent surfaces. */
  add(matrix: THREE.Matrix4, colour: THREE.Color, fade = 1): void {
    this.mesh.setMatrixAt(this.count, matrix);
    this.mesh.setColorAt(this.count, colour);
    this.fades.setX(this.count, fade);
    this.count += 1;
  }

  end(): void {
    this.mesh.count = this.count;
    this.mesh.instanceMatrix.needsUpdate = true;
    this.fades.needsUpdate = true;
    if (this.mesh.instanceColor) this.mesh.instanceColor.needsUpdate = true;
  }

  /** Returns the ends of an instance along its y axis, as drawn. */
  endsOf(index: number): [number[], number[]] {
    const matrix = new THREE.Matrix4();
    this.mesh.getMatrixAt(index, matrix);
    const from = new THREE.Vector3().setFromMatrixPosition(matrix);
    const to = from.clone().add(new THREE.Vector3().setFromMatrixColumn(matrix, 1));
    return [from.toArray(), to.toArray()];
  }

  get size(): number {
    return this.count;
  }
}

/** Shifts a geometry to y = 0 to y = 1. */
export function standing(geometry: THREE.BufferGeometry): THREE.BufferGeometry {
  return geometry.translate(0, 0.5, 0);
}

/** Returns the pose of a unit shape along y with this width, from a point along a direction with this length. */
export function stretched(from: THREE.Vector3, along: THREE.Vector3, wide: number, long: number): THREE.Matrix4 {
  const rotation = new THREE.Quaternion().setFromUnitVectors(UP, along);
  return new THREE.Matrix4().compose(from, rotation, new THREE.Vector3(wide, long, wide));
}
