// The scene that the server sends; see crates/clench-view/src/scene.rs.

export type Numbers3 = [number, number, number];
export type Numbers4 = [number, number, number, number];

export interface Placed {
  name: string;
  body: number;
  group: number;
  kind: string;
  pos: Numbers3;
  quat: Numbers4;
  size: Numbers3;
  rgba: Numbers4;
  material: number | null;
  /** The factors from coordinates to texture coordinates; see crates/clench-view/src/surfaces.rs. */
  scale: Numbers3;
}

export interface Geom extends Placed {
  mesh: number | null;
  hfield: number | null;
  friction: Numbers3;
  condim: number;
}

export interface Body {
  name: string;
  parent: number;
  mass: number;
  inertia: Numbers3;
  ipos: Numbers3;
  iquat: Numbers4;
  free: boolean;
}

export interface Joint {
  name: string;
  kind: "free" | "ball" | "slide" | "hinge";
  body: number;
  qpos: number;
  dof: number;
  range: [number, number] | null;
  pos: Numbers3;
  axis: Numbers3;
}

/** A light of the model; frames contain its pose. */
export interface Light {
  name: string;
  kind: "spot" | "directional" | "point";
  active: boolean;
  castshadow: boolean;
  attenuation: Numbers3;
  cutoff: number;
  exponent: number;
  ambient: Numbers3;
  diffuse: Numbers3;
}

export interface Surface {
  vertices: string;
  faces: string;
}

export interface Scene {
  name: string;
  timestep: number;
  sections: { name: string; width: number }[];
  /** The names of the stages of a step whose times are in frames. */
  stages: string[];
  bodies: Body[];
  geoms: Geom[];
  sites: Placed[];
  joints: Joint[];
  controls: { name: string; range: [number, number] | null }[];
  tendons: { name: string; rgba: Numbers4; width: number }[];
  equalities: { name: string; kind: string }[];
  sensors: { name: string; start: number; count: number }[];
  keyframes: string[];
  cameras: { name: string; orthographic: boolean; fovy: number }[];
  lights: Light[];
  headlight: { active: boolean; ambient: Numbers3; diffuse: Numbers3 };
  meshes: (Surface & { name: string; texcoords: string | null; hull: Surface | null })[];
  height_fields: { rows: number; columns: number; size: Numbers4; heights: string }[];
  materials: {
    texture: number | null;
    emission: number;
    specular: number;
    shininess: number;
    reflectance: number;
  }[];
  /** Images as PNG in base 64; the sides of a cube are below each other. */
  textures: { kind: "plane" | "cube" | "sky"; png: string }[];
  trees: (number | null)[];
  active: boolean;
  /** True if the simulation can be rewound. */
  rewinds: boolean;
  envs: number;
}

export function bytesOf(text: string): ArrayBuffer {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;
}

export function nameOf(kind: string, index: number, name: string): string {
  return name === "" ? `${kind} ${index}` : name;
}
