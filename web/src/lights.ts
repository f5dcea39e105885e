// The lights of a model, or where it has none a sun and a sky.

import * as THREE from "three";
import type { Frame } from "./frame.ts";
import type { Light, Numbers3, Scene } from "./scene.ts";

/** Matt surfaces in three.js reflect the light of a lamp divided by this. */
const MATT = Math.PI;

/** As crates/clench-render/src/light.rs has it. */
const TO_SUN = new THREE.Vector3(0.15, -0.551, 0.821);

/** Colours of lights add up on screens. */
function colour([red, green, blue]: Numbers3): THREE.Color {
  return new THREE.Color().setRGB(red, green, blue, THREE.SRGBColorSpace);
}

interface Lamp {
  told: Light;
  /** Its number in frames. */
  row: number;
  lamp: THREE.DirectionalLight | THREE.SpotLight | THREE.PointLight;
}

/** What lights the picture. */
export class Lights {
  readonly group = new THREE.Group();
  /** Whether the model has lights of its own. */
  readonly own: boolean;
  private lamps: Lamp[] = [];
  private sun = new THREE.DirectionalLight(0xffffff, 2.8);
  /** A sun and a sky, and what the model has. */
  private day = new THREE.Group();
  private night = new THREE.Group();
  private head: THREE.DirectionalLight | null = null;

  constructor(
    scene: Scene,
    private extent: number,
    /** Light that goes with the camera is a part of it. */
    camera: THREE.Camera,
  ) {
    this.own = scene.lights.length > 0;
    this.group.add(this.day, this.night);
    if (this.own) this.ofModel(scene, camera);
    this.day.add(new THREE.HemisphereLight(0xffffff, 0xb9b4ac, 0.7));
    this.add(this.day, this.sun, true);
  }

  private ofModel({ lights, headlight }: Scene, camera: THREE.Camera): void {
    const everywhere = new THREE.Color(0);
    if (headlight.active) {
      everywhere.add(colour(headlight.ambient));
      this.head = new THREE.DirectionalLight(colour(headlight.diffuse), MATT);
      this.head.position.set(0, 0, 1);
      camera.add(this.head, this.head.target);
    }
    // One shadow is what a laptop draws sixty times a second.
    const casting = lights.findIndex(({ active, castshadow }) => active && castshadow);
    lights.forEach((told, row) => {
      if (!told.active) return;
      everywhere.add(colour(told.ambient));
      const lamp = made(told);
      this.lamps.push({ told, row, lamp });
      this.add(this.night, lamp, row === casting);
    });
    this.night.add(new THREE.AmbientLight(everywhere, MATT));
  }

  private add(group: THREE.Group, lamp: Lamp["lamp"], casts: boolean): void {
    if (casts) {
      lamp.castShadow = true;
      lamp.shadow.mapSize.set(2048, 2048);
      lamp.shadow.bias = -0.0002;
      lamp.shadow.normalBias = 0.004 * this.extent;
      lamp.shadow.radius = 3;
    }
    group.add(lamp);
    if (!(lamp instanceof THREE.PointLight)) group.add(lamp.target);
  }

  /** Lets light and shadows reach all environments side by side. Lights of a model are in one place: several are in daylight. */
  shade(reach: number, several: boolean): void {
    this.night.visible = this.own && !several;
    this.day.visible = !this.night.visible;
    if (this.head) this.head.visible = this.night.visible;
    const half = 2.4 * reach * this.extent;
    for (const lamp of [this.sun, ...this.lamps.map(({ lamp }) => lamp)]) {
      if (!lamp.castShadow) continue;
      const { camera } = lamp.shadow;
      if (camera instanceof THREE.OrthographicCamera) {
        camera.left = camera.bottom = -half;
        camera.right = camera.top = half;
      }
      camera.near = 0.1 * this.extent;
      camera.far = 14 * reach * this.extent;
      camera.updateProjectionMatrix();
    }
  }

  /** Puts lights where they are in a frame, seen from a point; `offset` is the origin of the environment that it is of. */
  update(frame: Frame, target: THREE.Vector3, offset: THREE.Vector3, reach: number): void {
    this.sun.target.position.copy(target);
    this.sun.position.copy(target).addScaledVector(TO_SUN, 5.3 * reach * this.extent);
    for (const { told, row, lamp } of this.lamps) {
      const { data } = frame.rows.lights;
      const at = new THREE.Vector3().fromArray(data, 6 * row).add(offset);
      const along = new THREE.Vector3().fromArray(data, 6 * row + 3);
      if (lamp instanceof THREE.DirectionalLight) {
        // It shines everywhere: what matters is that all shadows are within its picture.
        lamp.target.position.copy(target);
        lamp.position.copy(target).addScaledVector(along, -5 * reach * this.extent);
      } else {
        lamp.position.copy(at);
        const distance = at.distanceTo(target);
        const [constant, linear, square] = told.attenuation;
        // As weak everywhere as in the middle of the picture.
        lamp.intensity = MATT / Math.max(constant + linear * distance + square * distance * distance, 1e-9);
        if (lamp instanceof THREE.SpotLight) lamp.target.position.copy(at).add(along);
      }
    }
  }
}

function made({ kind, diffuse, cutoff, exponent }: Light): Lamp["lamp"] {
  const shade = colour(diffuse);
  if (kind === "directional") return new THREE.DirectionalLight(shade, MATT);
  if (kind === "point") return new THREE.PointLight(shade, MATT, 0, 0);
  const angle = Math.min(Math.max((cutoff * Math.PI) / 180, 0.01), Math.PI / 2);
  // A spot without exponent has a sharp edge.
  return new THREE.SpotLight(shade, MATT, 0, angle, exponent > 0 ? 1 : 0, 0);
}
