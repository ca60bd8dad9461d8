// The card of the gains: present values, the cell's own values, the accepted range, and the fields that change them.

import type { GainsNote } from "./messages";
import { inLanguage } from "./message_texts";
import { figure, t } from "./texts";

type AskGains = (ask: "stiffness" | "drag" | "undo_gains", value?: number) => void;
const PER_MM = 1e-3; // N/m to N/mm

export class GainsCard {
  private note: GainsNote | null = null;
  private enabled = false;
  private model_age_ms: number | null = null;

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

  /** Shows the age of the contact model beside the largest age at which the gains are stable. */
  showAge(model_age_ms: number | null): void {
    this.model_age_ms = model_age_ms;
    const margin = this.card.querySelector("#gains-margin");
    if (!margin || !this.note) return;
    const stable = this.note.stable_age_ms;
    const now = model_age_ms === null ? "" : `; ${t("now")} ${figure(model_age_ms, 1)} ms ${model_age_ms <= stable ? "✓" : "!"}`;
    margin.textContent = `${figure(stable, 1)} ms${now}`;
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
    this.card.replaceChildren(heading, ...rows, ...(note.has_drag ? [margin] : []), this.tuned(note), hint, undo);
    this.enable(this.enabled);
    this.showAge(this.model_age_ms);
  }

  /** The results of `osteon tune`: margin of the present gains, stiffest stable wall at the present drag, recommended gains. */
  private tuned(note: GainsNote): HTMLElement {
    const made = Object.assign(document.createElement("div"), { id: "gains-tune", className: "dim" });
    const line = (text: string): void => made.append(Object.assign(document.createElement("div"), { textContent: text }));
    const { tune } = note;
    if (!tune) {
      line(t("noTune"));
      if (note.tune_why) line(inLanguage(note.tune_why));
      return made;
    }
    const asked = `${t("askedMargin")} ${figure(tune.asked_margin, 2)}`;
    if (tune.margin === null) line(`${t("gainMargin")}: ${t("marginUnknown")}`);
    else if (tune.margin === 0) line(`${t("gainMargin")}: ▲ ${t("notStable")}`);
    else line(`${t("gainMargin")}: ${t("atLeast")} ${figure(tune.margin, 2)} (${asked}) ${tune.margin >= tune.asked_margin ? "✓" : "▲"}`);
    if (tune.wall_N_per_m !== null)
      line(`${t("stableWall")} ${figure(tune.wall_N_per_m * PER_MM, 1)} N/mm; ${t("now")} ${figure(note.stiffness_N_per_m * PER_MM, 1)}`);
    const best = tune.recommended;
    if (!best) line(`${t("recommended")}: ▲ ${t("noneStable")}`);
    else {
      const parts = [`${figure(best.drag_Ns_per_m, 0)} N·s/m`];
      if (best.mass_kg !== null) parts.unshift(`${figure(best.mass_kg, 1)} kg`);
      if (best.stiffness_N_per_m !== null) parts.unshift(`${figure(best.stiffness_N_per_m * PER_MM, 1)} N/mm`);
      line(`${t("recommended")}: ${parts.join(", ")} (${t("gainMargin")} ${figure(best.margin, 2)})`);
    }
    return made;
  }

  /** The field of one gain. @param scale from SI to `unit` @param now, own, low, high present and own value, range: in SI */
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
