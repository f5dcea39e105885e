// The camera, lights and ground, and the drawing of frames.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { RoomEnvironment } from "three/addons/environments/RoomEnvironment.js";
import { Bodies, type Copy, type Hit, type Sight } from "./bodies.ts";
import { envsOf, type Env, type Frame } from "./frame.ts";
import { Labels } from "./labels.ts";
import { Lights } from "./lights.ts";
import { Overlays, type Layers } from "./overlays.ts";
import { localPose, readPoses, readPosesOf } from "./poses.ts";
import type { Geom, Scene } from "./scene.ts";

const SKY = 0xdfe6ee;
/** The vertical field of view of the free camera, degrees. */
const FOV = 42;
/** The initial directions to the free camera, for one and for several environments. */
const OBLIQUE = new THREE.Vector3(1.35, -1.55, 0.62).normalize();
const ABOVE = new THREE.Vector3(1.35, -1.55, 1.1).normalize();
/** The radius of the visible ball over that of the model. */
const ROOMY = 1.08;
/** The minimum share of the picture that counts as free, along each side. */
const LEAST_FREE = 0.35;

/** The elements around the free part of the picture: above, at the right, below. */
const AROUND = ["bar", "panel", "plots"];

/** A region of the picture, pixels. */
interface Area {
  x: number;
  y: number;
  width: number;
  height: number;
}

export class Stage {
  readonly camera = new THREE.PerspectiveCamera(FOV, 1, 0.01, 500);
  readonly bodies: Bodies;
  readonly overlays: Overlays;
  readonly controls: OrbitControls;
  readonly poses: THREE.Matrix4[] = [];
  /** The camera of the model in use; null for the free camera. */
  through: number | null = null;
  /** The body that the camera follows. */
  followed: number | null = null;
  private renderer: THREE.WebGLRenderer;
  private world = new THREE.Scene();
  readonly lights: Lights;
  private centre = new THREE.Vector3();
  /** The height of the ground, or of the lowest point that is visible initially, m. */
  private lowest = 0;
  private followedAt: THREE.Vector3 | null = null;
  /** True if a user has moved the free camera. */
  private isMoved = false;
  private sizes = new ResizeObserver(() => {
    this.fit();
    if (!this.isMoved && this.through === null && this.followed === null) this.home();
  });
  /** The shown environments, in the order of their positions. */
  private envs: Env[] = [];
  /** The width of all environments relative to a single one. */
  private reach = 1;
  private copies: Copy[] = [];
  readonly labels = new Labels();
  /** A border around the selected environment. */
  readonly border = new THREE.Mesh(borderShape(), new THREE.MeshBasicMaterial({ color: 0xf08a24, toneMapped: false, fog: false }));
  /** The position of the selected environment's origin. */
  readonly offset = new THREE.Vector3();
  /** The length scale of the model, m. */
  readonly extent: number;

  constructor(
    private scene: Scene,
    first: Frame,
    sight: Sight,
    layers: Layers,
    private container: HTMLElement,
  ) {
    this.renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
    this.renderer.toneMapping = THREE.ACESFilmicToneMapping;
    this.renderer.toneMappingExposure = 0.95;
    container.append(this.renderer.domElement);

    readPoses(first, this.poses);
    this.extent = this.measure(scene);
    this.world.background = new THREE.Color(SKY);
    this.world.fog = new THREE.Fog(SKY, 9 * this.extent, 34 * this.extent);
    this.lights = new Lights(scene, this.extent, this.camera);
    this.world.add(this.lights.group, this.camera);
    if (this.lights.own) {
      // The author's lights stay unchanged.
      this.renderer.toneMapping = THREE.NoToneMapping;
    } else {
      const surroundings = new THREE.PMREMGenerator(this.renderer);
      this.world.environment = surroundings.fromScene(new RoomEnvironment(), 0.04).texture;
      this.world.environmentIntensity = 0.42;
    }
    this.bodies = new Bodies(scene, sight, 1);
    this.overlays = new Overlays(scene, layers, this.heaviest(scene), Math.min(this.extent, usualSize(scene)));
    this.world.add(this.bodies.group, this.overlays.group, this.labels.group, this.border, this.ground(scene));
    this.border.scale.setScalar(1.42 * this.extent);
    this.border.visible = false;

    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.addEventListener("start", () => (this.isMoved = true));
    // The surrounding controls receive their sizes after the picture, and their lines of text change.
    for (const part of [container, ...AROUND.map((id) => document.getElementById(id))]) if (part) this.sizes.observe(part);
    this.fit();
    this.home();
  }

  get canvas(): HTMLCanvasElement {
    return this.renderer.domElement;
  }

  /** Returns the size of the movable geoms, or of all if none is movable, m; sets `centre` to their centre. */
  private measure(scene: Scene): number {
    const bounds = new THREE.Box3();
    const whole = new THREE.Box3();
    const fixedBoxes: THREE.Box3[] = [];
    const lost = this.strays();
    for (const geom of scene.geoms) {
      if (lost.has(geom.body)) continue;
      const box = boxOf(geom, this.poses[geom.body]);
      whole.union(box);
      if (geom.body > 0) bounds.union(box);
      else if (geom.kind !== "plane" && geom.kind !== "hfield") fixedBoxes.push(box);
    }
    // An object that carries the model, such as the base of an arm, is included; a room is not.
    const size = bounds.isEmpty() ? 0 : diagonal(bounds);
    const near = bounds.clone().expandByScalar(0.5 * size);
    for (const box of fixedBoxes) if (box.intersectsBox(near) && diagonal(box) < size) bounds.union(box);
    const seen = bounds.isEmpty() ? whole : bounds;
    if (seen.isEmpty()) return 1;
    seen.getCenter(this.centre);
    this.lowest = seen.min.z;
    return Math.max(0.05, 0.6 * diagonal(seen));
  }

  /** Returns the weight, N, and the size, m, of the heaviest child of the world with its descendants. */
  private heaviest(scene: Scene): { weight: number; size: number } {
    const root = scene.bodies.map((_, body) => body);
    scene.bodies.forEach(({ parent }, body) => {
      if (body > 0 && parent > 0) root[body] = root[parent];
    });
    const masses = scene.bodies.map(() => 0);
    scene.bodies.forEach(({ mass }, body) => (masses[root[body]] += body > 0 ? mass : 0));
    const heaviest = masses.indexOf(Math.max(...masses));
    const bounds = new THREE.Box3();
    for (const geom of scene.geoms) if (root[geom.body] === heaviest) bounds.union(boxOf(geom, this.poses[geom.body]));
    return { weight: 9.81 * masses[heaviest], size: bounds.isEmpty() ? this.extent : Math.min(this.extent, 0.6 * diagonal(bounds)) };
  }

  /** Returns the bodies that are far away from most others. */
  private strays(): Set<number> {
    const positions = this.poses.slice(1).map((pose) => new THREE.Vector3().setFromMatrixPosition(pose));
    const middle = (numbers: number[]) => numbers.sort((a, b) => a - b)[numbers.length >> 1] ?? 0;
    const centre = new THREE.Vector3(
      middle(positions.map(({ x }) => x)),
      middle(positions.map(({ y }) => y)),
      middle(positions.map(({ z }) => z)),
    );
    const distances = positions.map((position) => position.distanceTo(centre));
    const usual = middle([...distances]);
    return new Set(distances.flatMap((distance, k) => (distance > 8 * usual + 1 ? [k + 1] : [])));
  }

  /** Draws grid lines on the lowest plane, or below a model without ground; a floor with a texture needs none. */
  private ground(scene: Scene): THREE.Object3D {
    const planes = scene.geoms.filter((geom) => geom.kind === "plane" && geom.body === 0);
    const floor = planes.reduce<(typeof planes)[0] | null>((low, plane) => (low && low.pos[2] <= plane.pos[2] ? low : plane), null);
    const hasPicture = floor !== null && floor.material !== null && scene.materials[floor.material].texture !== null;
    if (floor) this.lowest = floor.pos[2];
    if (hasPicture || (!floor && scene.geoms.some(({ kind }) => kind === "hfield"))) return new THREE.Group();
    const cell = this.extent > 1.2 ? 0.5 : this.extent > 0.25 ? 0.1 : 0.02;
    const grid = new THREE.GridHelper(80 * cell, 80, 0x6b7684, 0x98a2ae);
    grid.rotateX(Math.PI / 2);
    grid.position.z = this.lowest + 0.0006 * this.extent;
    const lines = grid.material as THREE.LineBasicMaterial;
    lines.transparent = true;
    lines.opacity = 0.42;
    lines.depthWrite = false;
    return grid;
  }

  /** Views the whole model, or all environments side by side, from the side and above. */
  home(): void {
    const side = this.side();
    this.reach = 1 + 0.66 * (side - 1);
    this.lights.shade(this.reach, side > 1);
    const height = this.container.clientHeight;
    const free = this.free();
    // The free part of the picture must show a ball that contains everything.
    const radius = ROOMY * (this.extent / 1.2) + 1.5 * this.extent * (side - 1) * Math.SQRT1_2;
    const up = Math.tan((FOV * Math.PI) / 360);
    const angle = Math.atan(up * Math.min(free.height / height, free.width / height));
    const distance = height > 0 ? radius / Math.sin(angle) : radius;
    this.controls.target.copy(this.centre);
    this.camera.position.copy(this.centre).addScaledVector(side > 1 ? ABOVE : OBLIQUE, distance);
    this.camera.near = 0.01 * this.extent;
    this.camera.far = 120 * this.reach * this.extent;
    this.camera.updateProjectionMatrix();
    this.controls.update();
  }

  /** Returns the part of the picture that no control covers, or the whole picture if that part is small. */
  free(): Area {
    const { clientWidth: width, clientHeight: height } = this.container;
    const [bar, panel, plots] = AROUND.map((id) => document.getElementById(id)?.getBoundingClientRect());
    const right = panel?.width ? panel.left : width;
    const top = bar?.height ? bar.bottom : 0;
    const bottom = plots?.height ? plots.top : height;
    const area = { x: 0, y: top, width: right, height: bottom - top };
    const isWide = area.width > LEAST_FREE * width && area.height > LEAST_FREE * height;
    return isWide ? area : { x: 0, y: 0, width, height };
  }

  /** Fits the picture to its container. The free camera looks through the centre of the free part. */
  fit(): void {
    const { clientWidth: width, clientHeight: height } = this.container;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    if (this.through === null) {
      const { x, y, width: wide, height: high } = this.free();
      this.camera.setViewOffset(width, height, width / 2 - (x + wide / 2), height / 2 - (y + high / 2), width, height);
    } else {
      this.camera.clearViewOffset();
    }
    this.camera.updateProjectionMatrix();
  }

  /** Returns the number of environments in a row. */
  private side(): number {
    return Math.ceil(Math.sqrt(Math.max(1, this.envs.length)));
  }

  /** Returns the drawn origin of an environment: they form a square around the origin of the world. */
  private offsetOf(k: number): THREE.Vector3 {
    const side = this.side();
    const at = (index: number) => 1.5 * this.extent * (index - (side - 1) / 2);
    return this.envs.length > 1 ? new THREE.Vector3(at(k % side), -at(Math.floor(k / side)), 0) : new THREE.Vector3();
  }

  /** Returns the environment at a position, if there are several. */
  envAt(hit: Hit): number | null {
    return this.envs.length > 1 ? this.envs[hit.copyIndex].index : null;
  }

  /** Updates the shown environments of a frame and their positions. */
  private spread(frame: Frame, chosen: number | null): void {
    const envs = envsOf(frame);
    const others = envs.length !== this.envs.length;
    this.envs = envs;
    const capacity = Math.max(1, envs.length);
    this.bodies.resize(capacity);
    this.copies = Array.from({ length: capacity }, (_, k) => this.copies[k] ?? newCopy());
    // Contacts are drawn in the selected environment.
    const own = Math.max(0, envs.findIndex(({ index }) => index === frame.rows.chosen.data[0]));
    this.copies.forEach((copy, k) => {
      if (envs.length > 1) readPosesOf(k, frame, copy.poses);
      else readPoses(frame, copy.poses);
      const at = this.offsetOf(k);
      for (const pose of copy.poses) pose.setPosition(new THREE.Vector3().setFromMatrixPosition(pose).add(at));
      copy.fails = (envs[k]?.fault ?? "") !== "";
      copy.asleep = k === own ? frame.rows.asleep.data : EMPTY;
      copy.islands = k === own ? frame.rows.islands.data : EMPTY;
      copy.chosen = k === own ? chosen : null;
    });
    this.offset.copy(this.offsetOf(own));
    if (others) this.home();
    this.labels.begin();
    envs.forEach(({ index, fault }, k) => {
      const at = this.offsetOf(k).add(this.centre).addScaledVector(this.camera.up, 0.8 * this.extent);
      const [text, colour] = fault === "" ? [`${index}`, 0x33414d] : [`${index}: ${fault}`, 0x8c1616];
      // Relative to a camera distance that grows with their number.
      if (envs.length > 1) this.labels.add(text, at, new THREE.Color(colour), 2 / (1 + this.side()));
    });
    this.labels.end();
    this.border.visible = envs.length > 1;
    this.border.position.copy(this.offset).setZ(this.lowest + 0.002 * this.extent);
    this.border.position.x += this.centre.x;
    this.border.position.y += this.centre.y;
  }

  draw(frame: Frame, chosen: number | null): void {
    readPoses(frame, this.poses);
    this.spread(frame, chosen);
    this.bodies.update(this.copies);
    this.overlays.group.position.copy(this.offset);
    this.overlays.update(frame, this.poses, this.camera.position.clone().sub(this.offset));
    this.follow();
    this.controls.update();
    if (this.through !== null) this.lookThrough(frame, this.through);
    this.lights.update(frame, this.controls.target, this.offset, this.reach);
    this.renderer.render(this.world, this.camera);
  }

  /** Selects a camera of the model, or the free one. */
  choose(camera: number | null): void {
    this.through = camera;
    this.controls.enabled = camera === null;
    if (camera === null) this.camera.fov = FOV;
    this.fit();
    if (camera === null) this.home();
  }

  /**
   * Moves the camera to the pose of a model's camera. An orthographic one is approximated by a distant, narrow view.
   */
  private lookThrough(frame: Frame, index: number): void {
    const { orthographic, fovy } = this.scene.cameras[index];
    const row = frame.rows.cameras.data.subarray(12 * index, 12 * index + 12);
    const axis = (k: number) => new THREE.Vector3(row[3 + 3 * k], row[4 + 3 * k], row[5 + 3 * k]);
    const turn = new THREE.Matrix4().makeBasis(axis(0), axis(1), axis(2));
    const { camera } = this;
    camera.position.set(row[0], row[1], row[2]).add(this.offset);
    camera.quaternion.setFromRotationMatrix(turn);
    camera.fov = fovy;
    if (orthographic) {
      const distance = 40 * this.extent;
      camera.position.addScaledVector(axis(2), distance);
      camera.fov = (2 * Math.atan(0.5 * fovy / distance) * 180) / Math.PI;
    }
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
  }

  /** Releases the resources of the GPU. */
  dispose(): void {
    this.sizes.disconnect();
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }

  private follow(): void {
    if (this.followed === null) {
      this.followedAt = null;
      return;
    }
    const now = new THREE.Vector3().setFromMatrixPosition(this.poses[this.followed]).add(this.offset);
    if (this.followedAt) {
      const moved = now.clone().sub(this.followedAt);
      this.controls.target.add(moved);
      this.camera.position.add(moved);
    }
    this.followedAt = now;
  }

  /** Returns the ray through a point of the window. */
  rayAt(x: number, y: number): THREE.Raycaster {
    const frame = this.canvas.getBoundingClientRect();
    const at = new THREE.Vector2(
      (2 * (x - frame.left)) / frame.width - 1,
      1 - (2 * (y - frame.top)) / frame.height,
    );
    const ray = new THREE.Raycaster();
    ray.setFromCamera(at, this.camera);
    return ray;
  }
}

const EMPTY = new Float32Array();

function diagonal(box: THREE.Box3): number {
  return box.getSize(new THREE.Vector3()).length();
}

/** Returns an axis-aligned box around a geom; half a metre of a plane. */
function boxOf(geom: Geom, pose: THREE.Matrix4): THREE.Box3 {
  const [x, y, z] = geom.size.map((size) => Math.min(size, 5));
  const half: Record<string, [number, number, number]> = {
    plane: [0.25, 0.25, 0],
    sphere: [x, x, x],
    capsule: [x, x, x + y],
    cylinder: [x, x, y],
  };
  const corner = new THREE.Vector3(...(half[geom.kind] ?? [x, y, z]));
  return new THREE.Box3(corner.clone().negate(), corner).applyMatrix4(pose.clone().multiply(localPose(geom)));
}

/** Returns a hollow unit square. */
function borderShape(): THREE.ShapeGeometry {
  const square = (half: number) => [new THREE.Vector2(-half, -half), new THREE.Vector2(half, -half), new THREE.Vector2(half, half), new THREE.Vector2(-half, half)];
  const shape = new THREE.Shape(square(0.5));
  shape.holes.push(new THREE.Path(square(0.475)));
  return new THREE.ShapeGeometry(shape);
}

function newCopy(): Copy {
  return { poses: [], fails: false, asleep: EMPTY, islands: EMPTY, chosen: null };
}

/** Returns the length scale of marks on bodies: several times the half size of a typical geom, m. */
function usualSize(scene: Scene): number {
  const moving = scene.geoms.filter((geom) => geom.body > 0);
  const sizes = moving.map((geom) => Math.hypot(...geom.size)).sort((a, b) => a - b);
  return 7 * (sizes[sizes.length >> 1] ?? 1) || 1;
}
