// Geometry and surfaces of geoms and sites.

import * as THREE from "three";
import { bytesOf, type Geom, type Placed, type Scene, type Surface } from "./scene.ts";

/** Half the side of a plane without one, m. */
const FAR = 60;

/** Turns z up, which a model has, into what three's cylinders and capsules have along y. */
function upright(geometry: THREE.BufferGeometry): THREE.BufferGeometry {
  return geometry.rotateX(Math.PI / 2);
}

/** A shape by its own measure; instances are scaled where their sizes differ alone. */
export function shapeOf(scene: Scene, placed: Placed & Partial<Geom>, hulls: boolean): THREE.BufferGeometry {
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
      return surface((hulls && mesh.hull) || mesh);
    }
    default:
      return terrain(scene, placed.hfield!);
  }
}

/** Triangles with a normal each, so that edges stay sharp; smooth where the mesh is fine. */
function surface({ vertices, faces }: Surface): THREE.BufferGeometry {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(bytesOf(vertices)), 3));
  geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(bytesOf(faces)), 1));
  const flat = geometry.toNonIndexed();
  flat.computeVertexNormals();
  return flat;
}

function terrain(scene: Scene, index: number): THREE.BufferGeometry {
  const { rows, columns, size, heights } = scene.height_fields[index];
  const [halfX, halfY, elevation] = size;
  const values = new Float32Array(bytesOf(heights));
  const geometry = new THREE.PlaneGeometry(2 * halfX, 2 * halfY, columns - 1, rows - 1);
  const place = geometry.attributes.position;
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < columns; column++) {
      const vertex = row * columns + column;
      place.setXYZ(
        vertex,
        -halfX + (2 * halfX * column) / (columns - 1),
        -halfY + (2 * halfY * row) / (rows - 1),
        elevation * values[vertex],
      );
    }
  }
  // Rows run upwards here and downwards in three, so triangles are wound the other way.
  const corners = geometry.index!;
  for (let t = 0; t < corners.count; t += 3) {
    const swapped = corners.getX(t + 1);
    corners.setX(t + 1, corners.getX(t + 2));
    corners.setX(t + 2, swapped);
  }
  geometry.computeVertexNormals();
  return geometry;
}

const drawn = new Map<string, THREE.Texture>();

/** Paints a computed texture. */
function paint(scene: Scene, index: number): THREE.CanvasTexture {
  const { pattern, mark, rgb1, rgb2, markrgb } = scene.textures[index];
  const side = 256;
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = side;
  const pen = canvas.getContext("2d")!;
  const css = (rgb: number[]) => `rgb(${rgb.map((part) => Math.round(255 * part)).join(" ")})`;
  pen.fillStyle = css(rgb1);
  pen.fillRect(0, 0, side, side);
  if (pattern === "checker") {
    pen.fillStyle = css(rgb2);
    pen.fillRect(side / 2, 0, side / 2, side / 2);
    pen.fillRect(0, side / 2, side / 2, side / 2);
  } else if (pattern === "gradient") {
    const half = side / 2;
    const fill = pen.createRadialGradient(half, half, 0, half, half, side * 0.7);
    fill.addColorStop(0, css(rgb2));
    fill.addColorStop(1, css(rgb1));
    pen.fillStyle = fill;
    pen.fillRect(0, 0, side, side);
  }
  pen.strokeStyle = css(markrgb);
  pen.lineWidth = 2;
  if (mark === "edge") pen.strokeRect(0, 0, side, side);
  if (mark === "cross") {
    pen.beginPath();
    pen.moveTo(side / 2, 0);
    pen.lineTo(side / 2, side);
    pen.moveTo(0, side / 2);
    pen.lineTo(side, side / 2);
    pen.stroke();
  }
  return new THREE.CanvasTexture(canvas);
}

function textureOf(scene: Scene, placed: Placed): THREE.Texture | null {
  const material = placed.material === null ? null : scene.materials[placed.material];
  if (!material || material.texture === null) return null;
  const key = `${placed.material} ${material.uniform ? placed.size.join() : ""} ${placed.kind}`;
  let texture = drawn.get(key);
  if (!texture) {
    texture = paint(scene, material.texture);
    texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
    texture.colorSpace = THREE.SRGBColorSpace;
    texture.anisotropy = 8;
    const [x, y] = placed.size;
    const metres = material.uniform ? [2 * (x || FAR), 2 * (y || FAR)] : [1, 1];
    texture.repeat.set(material.repeat[0] * metres[0], material.repeat[1] * metres[1]);
    drawn.set(key, texture);
  }
  return texture;
}

/** How a geom or site reflects light. Colours of models are what a screen shows, sRGB. */
export function materialOf(scene: Scene, placed: Placed): THREE.MeshStandardMaterial {
  const [red, green, blue, alpha] = placed.rgba;
  const said = placed.material === null ? null : scene.materials[placed.material];
  const colour = new THREE.Color().setRGB(red, green, blue, THREE.SRGBColorSpace);
  return new THREE.MeshStandardMaterial({
    color: colour,
    map: textureOf(scene, placed),
    emissive: colour,
    emissiveIntensity: said?.emission ?? 0,
    roughness: 1 - 0.65 * (said?.shininess ?? 0.5),
    metalness: 0.05,
    transparent: alpha < 1,
    opacity: alpha,
    depthWrite: alpha >= 1,
    side: placed.kind === "plane" || placed.kind === "hfield" ? THREE.DoubleSide : THREE.FrontSide,
  });
}
