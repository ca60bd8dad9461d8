// The card of the procedure: its tools, where the tool is along the plan, the score so far, and the requests of `osteon
// tell` as buttons.

import { inLanguage } from "./message_texts";
import type { PlanNote, ProcedureAsk, ProcedureNote, ScoreNote } from "./messages";
import { figure, metricName, t, type Word } from "./texts";

/** A diameter as text, with a decimal only if it is not whole. */
const sizeOf = ({ diameter_mm: mm }: { diameter_mm: number }): string => `${figure(mm, Math.abs(mm - Math.round(mm)) < 1e-6 ? 0 : 1)} mm`;

type AskProcedure = (ask: ProcedureAsk, value?: number, confirmed?: true) => void;

export class ProcedureCard {
  private plan: PlanNote | null = null;
  private note: ProcedureNote | null = null;
  private score: ScoreNote | null = null;
  private enabled = false;

  constructor(
    private readonly card: HTMLElement,
    private readonly overlay: HTMLElement,
    private readonly ask: AskProcedure,
  ) {}

  begin(plan: PlanNote): void {
    this.plan = plan;
    this.build();
  }

  show(note: ProcedureNote): void {
    this.note = note;
    this.update();
  }

  showScore(score: ScoreNote): void {
    this.score = score;
    this.updateScore();
  }

  /** If the cell refused to finish because the plan is not finished, lets a person confirm the end. @returns whether the
   *  answer was this refusal */
  takeAnswer(done: boolean, reason: string): boolean {
    if (done || !reason.startsWith("finish: the plan is not finished")) return false;
    if (confirm(`${inLanguage(reason)}\n\n${t("finishAsk")}`)) this.ask("finish", undefined, true);
    return true;
  }

  setTexts(): void {
    this.build();
  }

  enable(enabled: boolean): void {
    this.enabled = enabled;
    for (const each of this.card.querySelectorAll<HTMLButtonElement | HTMLInputElement>("button, input")) each.disabled = !enabled;
    this.disableNext();
  }

  private build(): void {
    if (!this.plan) return this.card.replaceChildren();
    const heading = Object.assign(document.createElement("h2"), { textContent: `${t("procedure")}: ${this.plan.name}` });
    const steps = Object.assign(document.createElement("div"), { className: "bar", id: "steps" });
    steps.append(
      ...this.plan.reamers.map((reamer, i) => {
        const step = this.button(`step-${i}`, sizeOf(reamer), () => this.change("tool", i));
        step.setAttribute("aria-pressed", "false");
        return step;
      }),
    );
    const table = document.createElement("table");
    table.id = "procedure-figures";
    const buttons = Object.assign(document.createElement("div"), { className: "bar" });
    buttons.append(
      this.button("next-tool", t("nextTool"), () => this.change("next_tool"), "N"),
      this.button("undo-pass", t("undoPass"), () => this.ask("undo_pass"), "U"),
      this.button("save-pass", t("save"), () => this.ask("save"), "S"),
    );
    if (this.plan.kind === "cup") buttons.append(this.button("keep-cup", t("keepCup"), () => this.ask("cup")));
    buttons.append(this.button("finish", t("finish"), () => this.ask("finish"), "E"));
    const score = Object.assign(document.createElement("div"), { id: "score" });
    this.card.replaceChildren(heading, steps, table, score, buttons);
    if (this.plan.corridor) this.card.append(this.guidance());
    this.enable(this.enabled);
    this.update();
    this.updateScore();
  }

  /** The field for the guidance's gain. */
  private guidance(): HTMLElement {
    const form = Object.assign(document.createElement("form"), { className: "gain", noValidate: true });
    const label = Object.assign(document.createElement("label"), { textContent: `${t("guidance")} (0 … 1)`, htmlFor: "guidance-gain" });
    const input = Object.assign(document.createElement("input"), { id: "guidance-gain", type: "number", step: "any", min: "0", max: "1" });
    input.value = String(this.note?.guidance ?? 0);
    const set = Object.assign(document.createElement("button"), { id: "set-guidance", className: "small", textContent: t("set") });
    form.append(label, input, set);
    form.onsubmit = (event) => {
      event.preventDefault();
      if (Number.isFinite(input.valueAsNumber)) this.ask("guidance", input.valueAsNumber);
    };
    return form;
  }

  /** Requests another reamer. If the plan wants it, a person must first confirm that the reamer is mounted. @param index of
   *  the reamer, for `tool` */
  private change(ask: "next_tool" | "tool", index?: number): void {
    if (!this.plan || !this.note) return;
    const reamer = this.plan.reamers[index ?? this.note.tool + 1];
    const mm = reamer?.diameter_mm;
    const confirmed = this.plan.confirms && mm !== undefined && confirm(t("confirmTool").replace("{}", sizeOf(reamer)));
    if (this.plan.confirms && !confirmed) return;
    this.ask(ask, index === undefined ? undefined : mm, confirmed ? true : undefined);
  }

  private disableNext(): void {
    const next = this.card.querySelector<HTMLButtonElement>("#next-tool");
    if (next && this.plan && this.note) next.disabled = !this.enabled || this.note.tool + 1 >= this.plan.reamers.length;
  }

  /** Shows the newest note: the reamer in use, the table of figures, and the line over the picture. */
  private update(): void {
    const { plan, note } = this;
    const table = this.card.querySelector("#procedure-figures");
    if (!plan || !note || !table) return;
    plan.reamers.forEach((_, i) => this.card.querySelector(`#step-${i}`)!.setAttribute("aria-pressed", String(i === note.tool)));
    this.disableNext();
    const mark = (beyond: boolean): string => (plan.corridor ? (beyond ? " ▲" : " ✓") : "");
    const rows: [Word, string][] = [
      ["toGo", `${figure(note.to_go_mm, 1)} mm${mark(note.beyond.depth)}`],
      ["tilt", `${figure(note.tilt_deg, 1)}°${mark(note.beyond.tilt)}`],
      ["aside", `${figure(note.aside_mm, 1)} mm${mark(note.beyond.aside)}`],
      ["axisSoFar", note.axis_error_deg === null ? "–" : `${figure(note.axis_error_deg, 1)}°`],
      ["removedByTool", `${figure(note.removed_mm3, 0)} mm³`],
      ["passes", note.undone > 0 ? `${note.passes} (${note.undone} ${t("undone")})` : `${note.passes}`],
    ];
    if (plan.corridor) rows.splice(5, 0, ["outside", `${figure(note.outside_s, 1)} s`]);
    if (note.guidance !== null) rows.push(["guidance", note.guidance > 0 ? figure(note.guidance, 2) : t("off")]);
    if (note.cup) rows.push(["cup", t("kept")]);
    table.replaceChildren(
      ...rows.map(([word, value]) => {
        const row = document.createElement("tr");
        row.append(
          Object.assign(document.createElement("td"), { textContent: t(word) }),
          Object.assign(document.createElement("td"), { textContent: value }),
        );
        return row;
      }),
    );
    const line = [
      sizeOf(plan.reamers[note.tool]),
      `${t("toGo")} ${figure(note.to_go_mm, 1)} mm${mark(note.beyond.depth)}`,
      `${t("tilt")} ${figure(note.tilt_deg, 1)}°${mark(note.beyond.tilt)}`,
      `${t("aside")} ${figure(note.aside_mm, 1)} mm${mark(note.beyond.aside)}`,
    ];
    this.overlay.replaceChildren(...line.map((text) => Object.assign(document.createElement("span"), { textContent: text })));
  }

  /** Shows the score, its items and deductions, its age, and what is left of the plan. */
  private updateScore(): void {
    const { score } = this;
    const place = this.card.querySelector("#score");
    if (!score || !place) return;
    const line = (text: string): HTMLElement => Object.assign(document.createElement("div"), { className: "dim", textContent: text });
    const heading = Object.assign(document.createElement("b"), { textContent: t("scoreSoFar") });
    if (!score.known) return place.replaceChildren(heading, line(score.why || t("scoreWaits")));
    const table = document.createElement("table");
    const row = (name: string, value: string): void => {
      const [made, left, right] = ["tr", "td", "td"].map((tag) => document.createElement(tag));
      left.textContent = name;
      right.textContent = value;
      made.append(left, right);
      table.append(made);
    };
    row(t("points"), `${figure(score.total, 1)} ${t("of")} ${figure(score.of, 0)}; ${figure(score.open_points, 0)} ${t("open")}`);
    for (const item of score.items)
      if (item.weight > 0)
        row(metricName(item.metric, item.text), item.open ? t("open") : `${figure(item.points, 1)} ${t("of")} ${figure(item.weight, 0)}`);
    for (const deduction of score.deductions) row(metricName(deduction.name, deduction.name), `−${figure(deduction.points, 0)}`);
    const notes = [`${t("scoreOf").replace("{}", String(score.passes)).replace("{}", figure(score.age_s, 0))}${score.newer ? `; ${t("cutSince")}` : ""}`];
    if (score.unfinished) notes.push(`▲ ${t("notFinished")}: ${inLanguage(score.unfinished)}`);
    if (score.guided) notes.push(`▲ ${t("guidedScore")}`);
    place.replaceChildren(heading, table, ...notes.map(line));
  }

  private button(id: string, text: string, act: () => void, key?: string): HTMLButtonElement {
    const made = Object.assign(document.createElement("button"), { id, className: "small", textContent: text, onclick: act });
    if (!key) return made;
    made.dataset.key = key;
    made.append(Object.assign(document.createElement("kbd"), { textContent: key }));
    return made;
  }
}
