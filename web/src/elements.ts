// Elements of the page's controls.

export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  properties: Partial<HTMLElementTagNameMap[K]> = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

/** The outlines of the icons on buttons, in a square of 16. */
const ICONS = {
  pause: "M4 3h3v10H4zM9 3h3v10H9z",
  play: "M4 2.5v11l9-5.5z",
  step: "M3 3v10l6-5zM10 3h3v10h-3z",
  back: "M8 3v10L2 8zM14 3v10L8 8z",
  reset: "M8 2a6 6 0 1 0 5.8 4.5h-2A4.1 4.1 0 1 1 8 3.9V6.5l4-3.6L8-.4z",
};
export type Icon = keyof typeof ICONS;

export function paint(button: HTMLButtonElement, icon: Icon): void {
  if (button.dataset.icon === icon) return;
  button.dataset.icon = icon;
  button.innerHTML = `<svg viewBox="0 0 16 16" width="14" height="14"><path d="${ICONS[icon]}" fill="currentColor"/></svg>`;
}

export function button(icon: Icon, title: string, onclick: () => void): HTMLButtonElement {
  const made = element("button", { type: "button", title, onclick });
  paint(made, icon);
  return made;
}

export function check(text: string, on: boolean, changed: (on: boolean) => void): HTMLLabelElement {
  const box = element("input", { type: "checkbox", checked: on });
  box.onchange = () => changed(box.checked);
  return element("label", { className: "check" }, box, text);
}

export function choice(options: [string, string][], chosen: string, changed: (value: string) => void): HTMLSelectElement {
  const list = element("select", {}, ...options.map(([value, text]) => element("option", { value }, text)));
  list.value = chosen;
  list.onchange = () => changed(list.value);
  return list;
}

export interface Slider {
  row: HTMLElement;
  show(value: number): void;
}

/** Shortens a name to `max` characters by omitting the middle: both ends distinguish it from others. */
export function shortened(text: string, max: number): string {
  const head = Math.ceil((max - 1) / 2);
  return text.length <= max ? text : `${text.slice(0, head)}…${text.slice(head + 1 - max)}`;
}

/** The number of characters of a name before a slider. */
const LETTERS = 13;

/** Creates a slider that the simulation does not move while the user holds it. */
export function slider(
  text: string,
  low: number,
  high: number,
  changed: (value: number) => void,
  written: (value: number) => string = brief,
): Slider {
  const step = (high - low) / 1000 || 0.001;
  const range = element("input", { type: "range", min: `${low}`, max: `${high}`, step: `${step}` });
  const number = element("output", {});
  let held = false;
  range.onpointerdown = () => (held = true);
  range.onpointerup = () => (held = false);
  range.oninput = () => {
    number.value = written(range.valueAsNumber);
    changed(range.valueAsNumber);
  };
  const name = shortened(text, LETTERS);
  const row = element("label", { className: "slider" }, element("span", { title: name === text ? "" : text }, name), range, number);
  return {
    row,
    show(value) {
      if (held || document.activeElement === range) return;
      range.valueAsNumber = value;
      number.value = written(value);
    },
  };
}

export function fold(title: string, open: boolean, ...children: Node[]): HTMLDetailsElement {
  return element("details", { open }, element("summary", {}, title), element("div", { className: "content" }, ...children));
}

/** Smaller values are rounding errors of zero. */
const NEGLIGIBLE = 1e-9;

/** Formats a number with few digits. */
export function brief(value: number): string {
  const size = Math.abs(value);
  if (size < NEGLIGIBLE) return "0";
  if (size < 1e-3 || size >= 1e5) return value.toExponential(2);
  return value.toFixed(size >= 100 ? 1 : 3);
}
