// Texts in the picture, which face the camera with a constant size on the screen.

import * as THREE from "three";

/** The height of a line over the height of the picture. */
const HEIGHT = 0.034;
/** The height of a line, pixels. */
const PIXELS = 48;

interface Painted {
  texture: THREE.CanvasTexture;
  /** The width over the height. */
  aspect: number;
}

export class Labels {
  readonly group = new THREE.Group();
  private painted = new Map<string, Painted>();
  private used = 0;

  begin(): void {
    this.used = 0;
  }

  /** Adds a text; `size` is relative to the default size. */
  add(text: string, at: THREE.Vector3, colour: THREE.Color, size = 1): void {
    const sprite = this.sprite();
    const { texture, aspect } = this.paint(text, colour);
    sprite.material.map = texture;
    sprite.position.copy(at);
    sprite.scale.set(size * HEIGHT * aspect, size * HEIGHT, 1);
    sprite.visible = true;
  }

  get count(): number {
    return this.used;
  }

  end(): void {
    this.group.children.slice(this.used).forEach((sprite) => (sprite.visible = false));
    // Changing numbers would fill the memory with textures of old ones.
    if (this.painted.size > 200 + this.used) this.clear();
  }

  private clear(): void {
    for (const { texture } of this.painted.values()) texture.dispose();
    this.painted.clear();
  }

  private sprite(): THREE.Sprite {
    let sprite = this.group.children[this.used] as THREE.Sprite | undefined;
    if (!sprite) {
      const material = new THREE.SpriteMaterial({ sizeAttenuation: false, depthTest: false, toneMapped: false, fog: false });
      sprite = new THREE.Sprite(material);
      sprite.renderOrder = 9;
      this.group.add(sprite);
    }
    this.used += 1;
    return sprite;
  }

  private paint(text: string, colour: THREE.Color): Painted {
    const key = `${colour.getHexString()} ${text}`;
    const known = this.painted.get(key);
    if (known) return known;
    const canvas = document.createElement("canvas");
    const pen = canvas.getContext("2d")!;
    const font = `600 ${0.62 * PIXELS}px system-ui, sans-serif`;
    pen.font = font;
    canvas.width = Math.max(1, Math.ceil(pen.measureText(text).width + 0.7 * PIXELS));
    canvas.height = PIXELS;
    pen.fillStyle = "#ffffffd8";
    pen.beginPath();
    pen.roundRect(1, 1, canvas.width - 2, canvas.height - 2, 0.25 * PIXELS);
    pen.fill();
    pen.font = font;
    pen.fillStyle = `#${colour.getHexString()}`;
    pen.textBaseline = "middle";
    pen.fillText(text, 0.35 * PIXELS, 0.53 * PIXELS);
    const texture = new THREE.CanvasTexture(canvas);
    texture.colorSpace = THREE.SRGBColorSpace;
    const made = { texture, aspect: canvas.width / canvas.height };
    this.painted.set(key, made);
    return made;
  }
}
