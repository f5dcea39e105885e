// The lights of a model, or a sun and a sky if it has none.

import * as THREE from "three";
import type { Frame } from "./frame.ts";
import type { Light, Numbers3, Scene } from "./scene.ts";

/** Matt surfaces in three.js divide the light of a lamp by this. */
const MATT = Math.PI;

/** The same as in crates/clench-render/src/light.rs. */
const TO_SUN = new THREE.Vector3(0.15, -0.551, 0.821);

/** Creates a colour; lights are added in sRGB values. */
function colour([red, green, blue]: Numbers3): THREE.Color {
  return new THREE.Color().setRGB(red, green, blue, THREE.SRGBColorSpace);
}

interface Lamp {
  light: Light;
  /** The row in frames. */
  row: number;
  lamp: THREE.DirectionalLight | THREE.SpotLight | THREE.PointLight;
}

/** The lighting of the picture. */
export class Lights {
  readonly group = new THREE.Group();
  /** True if the model has its own lights. */
  readonly own: boolean;
  private lamps: Lamp[] = [];
  private sun = new THREE.DirectionalLight(0xffffff, 2.8);
  /** A sun and a sky, and the lights of the model. */
  private day = new THREE.Group();
  private night = new THREE.Group();
  private head: THREE.DirectionalLight | null = null;

  constructor(
    scene: Scene,
    private extent: number,
    /** The parent of the headlight, which follows the camera. */
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
    // A laptop can draw only one shadow map sixty times a second.
    const casting = lights.findIndex(({ active, castshadow }) => active && castshadow);
    lights.forEach((light, row) => {
      if (!light.active) return;
      everywhere.add(colour(light.ambient));
      const lamp = made(light);
      this.lamps.push({ light, row, lamp });
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

  /**
   * Extends light and shadows to all environments side by side. The model's lights have one position: several
   * environments are drawn in daylight.
   */
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

  /**
   * Moves the lights to their poses in a frame, for a view of `target`; `offset` is the origin of the frame's
   * environment.
   */
  update(frame: Frame, target: THREE.Vector3, offset: THREE.Vector3, reach: number): void {
    this.sun.target.position.copy(target);
    this.sun.position.copy(target).addScaledVector(TO_SUN, 5.3 * reach * this.extent);
    for (const { light, row, lamp } of this.lamps) {
      const { data } = frame.rows.lights;
      const at = new THREE.Vector3().fromArray(data, 6 * row).add(offset);
      const along = new THREE.Vector3().fromArray(data, 6 * row + 3);
      if (lamp instanceof THREE.DirectionalLight) {
        // It shines everywhere, but all shadows must be within its shadow map.
        lamp.target.position.copy(target);
        lamp.position.copy(target).addScaledVector(along, -5 * reach * this.extent);
      } else {
        lamp.position.copy(at);
        const distance = at.distanceTo(target);
        const [constant, linear, square] = light.attenuation;
        // Use the attenuation at the centre of the picture everywhere.
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
