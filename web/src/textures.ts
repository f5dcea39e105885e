// Pictures on surfaces: how they lie there is told by crates/clench-view/src/surfaces.rs.

import * as THREE from "three";
import type { Placed, Scene } from "./scene.ts";

type Picture = Scene["textures"][number];

/** What was asked for; a picture appears when the browser has decoded it. */
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

/** The picture of what a geom or site has as its surface, if it has one. */
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
  // The first row of a picture is its upper one.
  made.flipY = false;
  made.needsUpdate = true;
  return made;
}

/** The six sides of a cube, out of one picture that has them below each other, or is on all of them. */
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

/** Gives each corner of a shape its place in a picture. Meshes may have brought their own. */
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

/** Lets a surface show the picture of what has it. */
export async function paint(scene: Scene, placed: Placed, surface: THREE.MeshStandardMaterial): Promise<void> {
  const picture = textureOf(scene, placed);
  if (!picture) return;
  if (picture.kind === "plane") surface.map = surface.emissiveMap = await once(planes, picture, plane);
  else surround(surface, await once(cubes, picture, cube));
  surface.needsUpdate = true;
}

/** Three knows cubes of pictures as what surfaces mirror; here they are seen from the middle of a geom. */
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
