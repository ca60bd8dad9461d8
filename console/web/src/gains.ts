// The card of the gains: what acts, what the cell's own are, how far it may be changed, and the change.

import type { GainsNote } from "./messages";
import { figure, t } from "./texts";

type AskGains = (ask: "stiffness" | "drag" | "undo_gains", value?: number) => void;
const PER_MM = 1e-3; // N/m to N/mm

export class GainsCard {
  private note: GainsNote | null = null;
  private enabled = false;
  private model_age_ms = 0;

  constructor(
    private readonly card: HTMLElement,
    private readonly ask: AskGains,
  ) {}

  show(note: GainsNote): void {
    this.note = note;
    this.build();
  }

  setTexts(): void {
    this.build();
  }

  enable(enabled: boolean): void {
    this.enabled = enabled;
    for (const each of this.card.querySelectorAll<HTMLButtonElement | HTMLInputElement>("button, input"))
      each.disabled = !enabled || (each.id === "undo-gains" && !this.note?.can_undo);
  }

  /** The age of the contact model, beside the greatest one at which the gains are stable. */
  showAge(model_age_ms: number): void {
    this.model_age_ms = model_age_ms;
    const margin = this.card.querySelector("#gains-margin");
    if (!margin || !this.note) return;
    const stable = this.note.stable_age_ms;
    margin.textContent = `${figure(stable, 1)} ms; ${t("now")} ${figure(model_age_ms, 1)} ms ${model_age_ms <= stable ? "✓" : "!"}`;
  }

  private build(): void {
    const note = this.note;
    if (!note) return this.card.replaceChildren();
    const heading = document.createElement("h2");
    heading.textContent = t("gains");
    const rows: HTMLElement[] = [
      this.row("stiffness", t("stiffness"), "N/mm", PER_MM, note.stiffness_N_per_m, note.own_stiffness_N_per_m, note.min_stiffness_N_per_m, note.own_stiffness_N_per_m),
    ];
    if (note.has_drag)
      rows.push(this.row("drag", t("drag"), "N·s/m", 1, note.drag_Ns_per_m, note.own_drag_Ns_per_m, note.own_drag_Ns_per_m, note.max_drag_Ns_per_m));
    const margin = document.createElement("div");
    margin.className = "dim";
    margin.append(`${t("margin")} `, Object.assign(document.createElement("span"), { id: "gains-margin" }));
    const hint = document.createElement("div");
    hint.className = "dim";
    hint.textContent = t("gainsNote");
    const undo = document.createElement("button");
    undo.id = "undo-gains";
    undo.className = "small";
    undo.textContent = t("undo");
    undo.onclick = () => this.ask("undo_gains");
    this.card.replaceChildren(heading, ...rows, ...(note.has_drag ? [margin] : []), hint, undo);
    this.enable(this.enabled);
    this.showAge(this.model_age_ms);
  }

  private row(id: "stiffness" | "drag", name: string, unit: string, scale: number, now: number, own: number, low: number, high: number): HTMLElement {
    const made = document.createElement("form");
    made.className = "gain";
    const label = document.createElement("label");
    label.textContent = `${name} (${unit})`;
    const input = document.createElement("input");
    input.id = `gain-${id}`;
    input.type = "number";
    input.step = "any";
    input.min = String(low * scale);
    input.max = String(high * scale);
    input.value = String(Number((now * scale).toFixed(3)));
    label.htmlFor = input.id;
    const set = document.createElement("button");
    set.className = "small";
    set.id = `set-${id}`;
    set.textContent = t("set");
    const range = document.createElement("div");
    range.className = "dim";
    range.textContent = `${t("now")} ${figure(now * scale, 1)}; ${t("ownGain")} ${figure(own * scale, 1)}; ${t("accepted")} ${figure(low * scale, 1)} … ${figure(high * scale, 1)}`;
    made.append(label, input, set, range);
    made.noValidate = true; // the cell says what it accepts
    made.onsubmit = (event) => {
      event.preventDefault();
      if (Number.isFinite(input.valueAsNumber)) this.ask(id, input.valueAsNumber / scale);
    };
    return made;
  }
}
