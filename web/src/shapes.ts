// Geometry and materials of geoms and sites.

import * as THREE from "three";
import { bytesOf, type Geom, type Placed, type Scene, type Surface } from "./scene.ts";
import { cover, paint, textureOf } from "./textures.ts";

/** Half the side of an infinite plane, m. */
const FAR = 60;

/** Rotates three.js's cylinders and capsules from y to the model's z axis. */
function upright(geometry: THREE.BufferGeometry): THREE.BufferGeometry {
  return geometry.rotateX(Math.PI / 2);
}

/** Creates the shape of an element with its size. */
export function shapeOf(scene: Scene, placed: Placed & Partial<Geom>, hulls: boolean): THREE.BufferGeometry {
  const made = shape(scene, placed, hulls);
  const found = textureOf(scene, placed);
  if (found) cover(made, placed, found.kind);
  return made;
}

function shape(scene: Scene, placed: Placed & Partial<Geom>, hulls: boolean): THREE.BufferGeometry {
  const [x, y, z] = placed.size;
  switch (placed.kind) {
    case "plane":
      return new THREE.PlaneGeometry(2 * (x || FAR), 2 * (y || FAR));
    case "sphere":
      return new THREE.SphereGeometry(x, 40, 24);
    case "ellipsoid":
      return new THREE.SphereGeometry(1, 40, 24).scale(x, y, z);
    case "capsule":
      return upright(new THREE.CapsuleGeometry(x, 2 * y, 12, 32));
    case "cylinder":
      return upright(new THREE.CylinderGeometry(x, x, 2 * y, 40));
    case "box":
      return new THREE.BoxGeometry(2 * x, 2 * y, 2 * z);
    case "mesh": {
      const mesh = scene.meshes[placed.mesh!];
      return hulls && mesh.hull ? surface(mesh.hull, null) : surface(mesh, mesh.texcoords);
    }
    default:
      return terrain(scene, placed.hfield!);
  }
}

/** Creates triangles with a normal each, so that edges stay sharp; fine meshes look smooth. */
function surface({ vertices, faces }: Surface, texcoords: string | null): THREE.BufferGeometry {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(bytesOf(vertices)), 3));
  geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(bytesOf(faces)), 1));
  const flat = geometry.toNonIndexed();
  flat.computeVertexNormals();
  if (texcoords) flat.setAttribute("uv", new THREE.BufferAttribute(new Float32Array(bytesOf(texcoords)), 2));
  return flat;
}

function terrain(scene: Scene, index: number): THREE.BufferGeometry {
  const { rows, columns, size, heights } = scene.height_fields[index];
  const [halfX, halfY, elevation] = size;
  const values = new Float32Array(bytesOf(heights));
  const geometry = new THREE.PlaneGeometry(2 * halfX, 2 * halfY, columns - 1, rows - 1);
  const positions = geometry.attributes.position;
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < columns; column++) {
      const vertex = row * columns + column;
      positions.setXYZ(
        vertex,
        -halfX + (2 * halfX * column) / (columns - 1),
        -halfY + (2 * halfY * row) / (rows - 1),
        elevation * values[vertex],
      );
    }
  }
  // Rows run upwards here and downwards in three.js, so the winding of triangles is reversed.
  const corners = geometry.index!;
  for (let t = 0; t < corners.count; t += 3) {
    const swapped = corners.getX(t + 1);
    corners.setX(t + 1, corners.getX(t + 2));
    corners.setX(t + 2, swapped);
  }
  geometry.computeVertexNormals();
  return geometry;
}

/** Creates the material of a geom or site. Colours of models are in sRGB. */
export function materialOf(scene: Scene, placed: Placed): THREE.MeshStandardMaterial {
  const [red, green, blue, alpha] = placed.rgba;
  const material = placed.material === null ? null : scene.materials[placed.material];
  const colour = new THREE.Color().setRGB(red, green, blue, THREE.SRGBColorSpace);
  const surface = new THREE.MeshStandardMaterial({
    color: colour,
    emissive: colour,
    emissiveIntensity: material?.emission ?? 0,
    roughness: 1 - 0.65 * (material?.shininess ?? 0.5),
    metalness: 0.05,
    transparent: alpha < 1,
    opacity: alpha,
    depthWrite: alpha >= 1,
    side: placed.kind === "plane" || placed.kind === "hfield" ? THREE.DoubleSide : THREE.FrontSide,
  });
  void paint(scene, placed, surface);
  return surface;
}
