// Camera, light, ground, and the picture of a frame.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { RoomEnvironment } from "three/addons/environments/RoomEnvironment.js";
import { Bodies, type Copy, type Hit, type Sight } from "./bodies.ts";
import { envsOf, type Env, type Frame } from "./frame.ts";
import { Labels } from "./labels.ts";
import { Lights } from "./lights.ts";
import { Overlays, type Layers } from "./overlays.ts";
import { localPose, readPoses, readPosesOf } from "./poses.ts";
import type { Scene } from "./scene.ts";

const SKY = 0xdfe6ee;
/** Vertical field of view of the free camera, degrees. */
const FOV = 42;

export class Stage {
  readonly camera = new THREE.PerspectiveCamera(FOV, 1, 0.01, 500);
  readonly bodies: Bodies;
  readonly overlays: Overlays;
  readonly controls: OrbitControls;
  readonly poses: THREE.Matrix4[] = [];
  /** The camera of the model that one looks through. */
  through: number | null = null;
  /** The body that the camera follows. */
  followed: number | null = null;
  private renderer: THREE.WebGLRenderer;
  private world = new THREE.Scene();
  readonly lights: Lights;
  private centre = new THREE.Vector3();
  private followedAt: THREE.Vector3 | null = null;
  /** The environments that are seen, in the order of their places. */
  private envs: Env[] = [];
  /** How much wider they are than one alone. */
  private reach = 1;
  private copies: Copy[] = [];
  private faults = new Labels();
  /** Where the origin of the chosen environment is. */
  readonly offset = new THREE.Vector3();
  /** A length that suits the whole, m. */
  readonly extent: number;

  constructor(
    private scene: Scene,
    first: Frame,
    sight: Sight,
    layers: Layers,
    private place: HTMLElement,
  ) {
    this.renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
    this.renderer.toneMapping = THREE.ACESFilmicToneMapping;
    this.renderer.toneMappingExposure = 0.95;
    place.append(this.renderer.domElement);

    readPoses(first, this.poses);
    this.extent = this.measure(scene);
    this.world.background = new THREE.Color(SKY);
    this.world.fog = new THREE.Fog(SKY, 9 * this.extent, 34 * this.extent);
    this.lights = new Lights(scene, this.extent, this.camera);
    this.world.add(this.lights.group, this.camera);
    if (this.lights.own) {
      // Light that an author chose stays as it is.
      this.renderer.toneMapping = THREE.NoToneMapping;
    } else {
      const surroundings = new THREE.PMREMGenerator(this.renderer);
      this.world.environment = surroundings.fromScene(new RoomEnvironment(), 0.04).texture;
      this.world.environmentIntensity = 0.42;
    }
    this.bodies = new Bodies(scene, sight, 1);
    this.overlays = new Overlays(scene, layers, this.extent, Math.min(this.extent, usualSize(scene)));
    this.world.add(this.bodies.group, this.overlays.group, this.faults.group, this.ground(scene));

    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.home();
    new ResizeObserver(() => this.fit()).observe(place);
    this.fit();
  }

  get canvas(): HTMLCanvasElement {
    return this.renderer.domElement;
  }

  /** The size of what can move, or of all where nothing can, m; `centre` is put in its middle. */
  private measure(scene: Scene): number {
    const bounds = new THREE.Box3();
    const whole = new THREE.Box3();
    const lost = this.strays();
    for (const geom of scene.geoms) {
      if (lost.has(geom.body)) continue;
      const place = this.poses[geom.body].clone().multiply(localPose(geom));
      const at = new THREE.Vector3().setFromMatrixPosition(place);
      const flat = geom.kind === "plane";
      const reach = flat ? 0.5 : Math.min(Math.hypot(...geom.size), 5);
      const ball = new THREE.Box3().setFromCenterAndSize(at, new THREE.Vector3(reach, reach, reach).multiplyScalar(1.2));
      whole.union(ball);
      if (geom.body > 0) bounds.union(ball);
    }
    const seen = bounds.isEmpty() ? whole : bounds;
    if (seen.isEmpty()) return 1;
    seen.getCenter(this.centre);
    return Math.max(0.05, seen.getSize(new THREE.Vector3()).length() * 0.6);
  }

  /** Bodies that have gone far away from most others. */
  private strays(): Set<number> {
    const places = this.poses.slice(1).map((pose) => new THREE.Vector3().setFromMatrixPosition(pose));
    const middle = (numbers: number[]) => numbers.sort((a, b) => a - b)[numbers.length >> 1] ?? 0;
    const centre = new THREE.Vector3(
      middle(places.map(({ x }) => x)),
      middle(places.map(({ y }) => y)),
      middle(places.map(({ z }) => z)),
    );
    const distances = places.map((place) => place.distanceTo(centre));
    const usual = middle([...distances]);
    return new Set(distances.flatMap((distance, k) => (distance > 8 * usual + 1 ? [k + 1] : [])));
  }

  /** Lines on the lowest plane, a metre or a tenth of the model apart. */
  private ground(scene: Scene): THREE.Object3D {
    const planes = scene.geoms.filter((geom) => geom.kind === "plane" && geom.body === 0);
    if (planes.length === 0) return new THREE.Group();
    const lowest = Math.min(...planes.map((plane) => plane.pos[2]));
    const cell = this.extent > 1.2 ? 0.5 : this.extent > 0.25 ? 0.1 : 0.02;
    const grid = new THREE.GridHelper(80 * cell, 80, 0x6b7684, 0x98a2ae);
    grid.rotateX(Math.PI / 2);
    grid.position.z = lowest + 0.0006 * this.extent;
    const lines = grid.material as THREE.LineBasicMaterial;
    lines.transparent = true;
    lines.opacity = 0.42;
    lines.depthWrite = false;
    return grid;
  }

  /** Looks at the whole model, or all environments side by side, from the side and above. */
  home(): void {
    const side = this.side();
    const reach = 1 + 0.66 * (side - 1);
    this.reach = reach;
    this.lights.shade(reach);
    const away = new THREE.Vector3(1.35, -1.55, side > 1 ? 1.1 : 0.62).multiplyScalar(1.55 * reach * this.extent);
    // The plots cover more of the lower edge than the bar of the upper: what matters stands a little higher.
    this.controls.target.copy(this.centre).addScaledVector(this.camera.up, -0.09 * this.extent);
    this.camera.position.copy(this.controls.target).add(away);
    this.camera.near = 0.01 * this.extent;
    this.camera.far = 120 * reach * this.extent;
    this.camera.updateProjectionMatrix();
    this.controls.update();
  }

  private fit(): void {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  /** How many environments are in a row. */
  private side(): number {
    return Math.ceil(Math.sqrt(Math.max(1, this.envs.length)));
  }

  /** Where the origin of an environment is drawn: they stand in a square around that of the world. */
  private placeOf(k: number): THREE.Vector3 {
    const side = this.side();
    const at = (index: number) => 1.5 * this.extent * (index - (side - 1) / 2);
    return this.envs.length > 1 ? new THREE.Vector3(at(k % side), -at(Math.floor(k / side)), 0) : new THREE.Vector3();
  }

  /** Which environment stands at a place, if several do. */
  envAt(hit: Hit): number | null {
    return this.envs.length > 1 ? this.envs[hit.place].index : null;
  }

  /** Finds out which environments a frame shows, and where each stands. */
  private spread(frame: Frame, chosen: number | null): void {
    const envs = envsOf(frame);
    const others = envs.length !== this.envs.length;
    this.envs = envs;
    const room = Math.max(1, envs.length);
    this.bodies.resize(room);
    this.copies = Array.from({ length: room }, (_, k) => this.copies[k] ?? newCopy());
    // Of several, the one whose contacts are told is where its bodies are.
    const own = Math.max(0, envs.findIndex(({ index }) => index === frame.rows.chosen.data[0]));
    this.copies.forEach((copy, k) => {
      if (envs.length > 1) readPosesOf(k, frame, copy.poses);
      else readPoses(frame, copy.poses);
      const at = this.placeOf(k);
      for (const pose of copy.poses) pose.setPosition(new THREE.Vector3().setFromMatrixPosition(pose).add(at));
      copy.fails = (envs[k]?.fault ?? "") !== "";
      copy.asleep = k === own ? frame.rows.asleep.data : NOTHING;
      copy.islands = k === own ? frame.rows.islands.data : NOTHING;
      copy.chosen = k === own ? chosen : null;
    });
    this.offset.copy(this.placeOf(own));
    if (others) this.home();
    this.faults.begin();
    envs.forEach(({ index, fault }, k) => {
      if (fault === "") return;
      const at = this.placeOf(k).add(this.centre);
      this.faults.add(`${index}: ${fault}`, at, new THREE.Color(0x8c1616));
    });
    this.faults.end();
  }

  draw(frame: Frame, chosen: number | null): void {
    readPoses(frame, this.poses);
    this.spread(frame, chosen);
    this.bodies.update(this.copies);
    this.overlays.group.position.copy(this.offset);
    this.overlays.update(frame, this.poses);
    this.follow();
    this.controls.update();
    if (this.through !== null) this.lookThrough(frame, this.through);
    this.lights.update(frame, this.controls.target, this.offset, this.reach);
    this.renderer.render(this.world, this.camera);
  }

  /** Chooses a camera of the model, or the free one. */
  choose(camera: number | null): void {
    this.through = camera;
    this.controls.enabled = camera === null;
    if (camera !== null) return;
    this.camera.fov = FOV;
    this.fit();
    this.home();
  }

  /** Puts the camera where one of the model's is. One with parallel lines of sight is far away, with a narrow view. */
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

  /** Gives back what the graphics card holds. */
  dispose(): void {
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

  /** The ray through a point of the window. */
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

const NOTHING = new Float32Array();

function newCopy(): Copy {
  return { poses: [], fails: false, asleep: NOTHING, islands: NOTHING, chosen: null };
}

/** A length that marks on bodies are measured by: several times the half size of a usual geom, m. */
function usualSize(scene: Scene): number {
  const moving = scene.geoms.filter((geom) => geom.body > 0);
  const sizes = moving.map((geom) => Math.hypot(...geom.size)).sort((a, b) => a - b);
  return 7 * (sizes[sizes.length >> 1] ?? 1) || 1;
}
