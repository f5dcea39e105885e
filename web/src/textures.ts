// Textures on surfaces; crates/clench-view/src/surfaces.rs defines their mapping.

import * as THREE from "three";
import type { Placed, Scene } from "./scene.ts";

type Picture = Scene["textures"][number];

/** The requested textures; a texture appears when the browser has decoded it. */
const planes = new Map<Picture, Promise<THREE.Texture>>();
const cubes = new Map<Picture, Promise<THREE.CubeTexture>>();

async function decoded({ png }: Picture): Promise<HTMLImageElement> {
  const image = new Image();
  image.src = `data:image/png;base64,${png}`;
  await image.decode();
  return image;
}

function once<T>(known: Map<Picture, Promise<T>>, picture: Picture, make: (image: HTMLImageElement) => T): Promise<T> {
  const made = known.get(picture) ?? decoded(picture).then(make);
  known.set(picture, made);
  return made;
}

/** Returns the texture of a geom or site, if it has one. */
export function textureOf(scene: Scene, placed: Placed): Picture | null {
  const material = placed.material === null ? null : scene.materials[placed.material];
  const picture = material?.texture == null ? null : scene.textures[material.texture];
  return picture && picture.kind !== "sky" ? picture : null;
}

function plane(image: HTMLImageElement): THREE.Texture {
  const made = new THREE.Texture(image);
  made.wrapS = made.wrapT = THREE.RepeatWrapping;
  made.colorSpace = THREE.SRGBColorSpace;
  made.anisotropy = 8;
  // The first row of an image is the top row.
  made.flipY = false;
  made.needsUpdate = true;
  return made;
}

/** Creates the six sides of a cube from one image that contains them below each other, or repeats on all of them. */
function cube(image: HTMLImageElement): THREE.CubeTexture {
  const { width } = image;
  const sides = Array.from({ length: 6 }, (_, side) => {
    const canvas = document.createElement("canvas");
    canvas.width = canvas.height = width;
    const from = image.height > width ? side * width : 0;
    canvas.getContext("2d")!.drawImage(image, 0, from, width, width, 0, 0, width, width);
    return canvas;
  });
  const made = new THREE.CubeTexture(sides);
  made.colorSpace = THREE.SRGBColorSpace;
  made.generateMipmaps = true;
  made.minFilter = THREE.LinearMipmapLinearFilter;
  made.needsUpdate = true;
  return made;
}

/** Sets the texture coordinates of each vertex. Meshes may have their own. */
export function cover(geometry: THREE.BufferGeometry, { kind, scale }: Placed, on: Picture["kind"]): void {
  const [x, y, z] = scale;
  const { position, uv } = geometry.attributes;
  const at = new THREE.Vector3();
  const places = new Float32Array(3 * position.count);
  for (let corner = 0; corner < position.count; corner++) {
    at.fromBufferAttribute(position, corner);
    if (on === "cube") places.set([x * at.x, y * at.y, z * at.z], 3 * corner);
    else places.set([x * at.x - 0.5, -y * at.y - 0.5], 2 * corner);
  }
  if (on === "cube") geometry.setAttribute("around", new THREE.BufferAttribute(places, 3));
  else if (kind !== "mesh" || !uv) {
    geometry.setAttribute("uv", new THREE.BufferAttribute(places.subarray(0, 2 * position.count), 2));
  }
}

/** Applies the texture of an element to its material. */
export async function paint(scene: Scene, placed: Placed, surface: THREE.MeshStandardMaterial): Promise<void> {
  const picture = textureOf(scene, placed);
  if (!picture) return;
  if (picture.kind === "plane") surface.map = surface.emissiveMap = await once(planes, picture, plane);
  else surround(surface, await once(cubes, picture, cube));
  surface.needsUpdate = true;
}

/** Samples a cube texture from the centre of a geom; three.js only reflects cube textures. */
function surround(surface: THREE.MeshStandardMaterial, picture: THREE.CubeTexture): void {
  surface.customProgramCacheKey = () => "around";
  surface.onBeforeCompile = (shader) => {
    shader.uniforms.sides = { value: picture };
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\nattribute vec3 around;\nvarying vec3 vAround;")
      .replace("#include <begin_vertex>", "#include <begin_vertex>\nvAround = around;");
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", "#include <common>\nuniform samplerCube sides;\nvarying vec3 vAround;")
      .replace("#include <map_fragment>", "diffuseColor *= textureCube(sides, vAround);")
      .replace("#include <emissivemap_fragment>", "totalEmissiveRadiance *= textureCube(sides, vAround).rgb;");
  };
}
