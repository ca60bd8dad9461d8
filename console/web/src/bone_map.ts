// The map of two bones' difference: a switch, the scale of its colours, and the largest difference in words.

import { SCALE_BACKGROUND } from "./difference_colours";
import type { BoneDifference } from "./messages";
import { figure, t } from "./texts";

const KEY = "b"; // shortcut of the switch

export class BoneMap {
  private readonly button = document.createElement("button");
  private readonly scale = document.createElement("span");
  private readonly largest = document.createElement("output");
  private on = false;

  /** @param ask called with the state that the switch asks for */
  constructor(parent: HTMLElement, ask: (on: boolean) => void) {
    this.button.className = "small";
    this.button.dataset.key = KEY;
    const hint = document.createElement("kbd");
    hint.textContent = KEY.toUpperCase();
    this.button.append(t("boneMap"), hint);
    this.button.onclick = () => ask(!this.on);
    this.scale.className = "scale";
    parent.append(this.button, this.scale, this.largest);
    this.show({ type: "bone_difference", on: false, range_mm: 1, largest_mm: 0, at_mm: [0, 0, 0], limit_mm: 0 });
  }

  show(note: BoneDifference): void {
    this.on = note.on;
    this.button.setAttribute("aria-pressed", String(note.on));
    this.scale.hidden = this.largest.hidden = !note.on;
    const digits = note.range_mm < 0.1 ? 2 : 1;
    const bar = document.createElement("i");
    bar.style.background = SCALE_BACKGROUND;
    this.scale.replaceChildren(`${t("firstDeeper")} ${figure(note.range_mm, digits)}`, bar, `${figure(note.range_mm, digits)} mm ${t("secondDeeper")}`);
    this.largest.textContent = this.inWords(note);
  }

  /** The largest difference in words; at the map's limit as "≥", since a larger one is not measured. */
  private inWords({ largest_mm, at_mm, limit_mm }: BoneDifference): string {
    if (largest_mm === 0) return t("noBoneDifference");
    const size = Math.abs(largest_mm), beyond = size >= 0.999 * limit_mm ? "≥ " : "";
    const deeper = largest_mm > 0 ? t("secondDeeper") : t("firstDeeper");
    return `${t("largest")}: ${beyond}${figure(size, 2)} mm, ${deeper}, ${t("at")} ${at_mm.map((x) => figure(x, 1)).join(" ")} mm`;
  }
}
