// The console's page: connects the stream to scene, figures and charts, and the operator to the cell.

import { CellAlone } from "./cell_alone";
import { Charts } from "./charts";
import { Connection } from "./connection";
import { byId } from "./elements";
import "./main.css";
import "./side.css";
import { inLanguage } from "./message_texts";
import type { Ask, Hello, Live, Message, Role, Status } from "./messages";
import { GainsCard } from "./gains";
import { Panels } from "./panels";
import { planLegend } from "./plan_colours";
import { ProcedureCard } from "./procedure";
import { SceneView, type Preset } from "./scene";
import { Sound } from "./sound";
import { Timeline } from "./timeline";
import { figure, getLanguage, setLanguage, t, type Language, type Word } from "./texts";

const CUTTING = 5; // safety::CellState
const BONE_IS_OLD_MS = 1000; // age of the shown bone from which the page warns
const REPORT_EVERY_MS = 200; // time between two reports to the server of drawn figures

/** Longest times of a tick, before the first tick. */
const noTicks = (): { compute_us: number; wakeup_us: number } => ({ compute_us: 0, wakeup_us: 0 });

class Page {
  private readonly scene = new SceneView(byId("scene") as HTMLCanvasElement);
  private readonly panels = new Panels();
  private readonly alone = new CellAlone();
  private readonly charts = new Charts(byId("charts"));
  private readonly sound = new Sound();
  private readonly timeline = new Timeline(byId("timeline"), {
    play: () => this.connection.ask("play"),
    halt: () => this.connection.ask("halt"),
    seek: (at_s) => this.connection.ask("seek", at_s),
    speed: (factor) => this.connection.ask("speed", factor),
  });
  private readonly gains = new GainsCard(byId("gains"), (ask, value) => this.connection.ask(ask, value));
  private readonly procedure = new ProcedureCard(byId("procedure"), byId("view-plan"), (ask, value, confirmed) =>
    this.connection.ask(ask, value, confirmed),
  );
  private readonly connection: Connection;
  private hello: Hello | null = null;
  private live: Live | null = null;
  private role: Role = { type: "role", mine: false, taken: false, pages: 0 };
  private connected = false;
  private said = ""; // text of the last answer, in English
  private gaveRoleBack = false;
  private reported_ms = 0;
  private worst = noTicks(); // longest times so far

  constructor() {
    if (new URLSearchParams(location.search).has("stream")) document.body.classList.add("side"); // of compare.html
    this.buildTexts();
    this.bindKeys();
    this.connection = new Connection({
      message: (message) => this.take(message),
      binary: (bytes) => {
        this.scene.surface.take(bytes);
        this.scene.redraw();
      },
      state: (connected) => this.showConnection(connected),
    });
  }

  private take(message: Message): void {
    switch (message.type) {
      case "hello":
        this.hello = message;
        document.body.classList.toggle("alone", message.command === "cell");
        this.scene.begin(message);
        this.panels.begin(message);
        this.charts.begin(message.fields);
        this.worst = noTicks();
        break;
      case "restart":
        this.charts.restart();
        this.worst = noTicks();
        this.panels.restart();
        break;
      case "playback":
        document.body.classList.add("viewing");
        this.timeline.show(message);
        this.panels.countFrom(message.start_s);
        if (message.error) this.say(message.error);
        break;
      case "timeline":
        this.timeline.showNews(message);
        break;
      case "cell":
        this.alone.take(message);
        break;
      case "gains":
        this.gains.show(message);
        this.showButtons();
        break;
      case "plan":
        document.body.classList.add("planned");
        document.body.classList.toggle("planned-cup", message.kind === "cup");
        this.scene.setPlan(message);
        this.procedure.begin(message);
        this.showButtons();
        break;
      case "procedure":
        this.scene.showPlan(message);
        this.procedure.show(message);
        break;
      case "score":
        this.procedure.showScore(message);
        break;
      case "bone_difference":
        this.scene.surface.setRange(message.range_mm);
        this.scene.redraw();
        break;
      case "surface":
        this.scene.surface.begin(message);
        this.scene.showBoneAlone(message.difference_step_mm !== undefined);
        break;
      case "surface_whole":
        this.scene.surface.complete();
        this.scene.redraw();
        break;
      case "live":
        this.takeLive(message);
        break;
      case "events":
        this.panels.addEvents(message.events);
        this.charts.addEvents(message.events);
        break;
      case "role":
        this.role = message;
        if (!message.taken && !this.gaveRoleBack && this.operable) this.connection.ask("role"); // the first page operates
        this.panels.showRole(message);
        this.showButtons();
        break;
      case "answer":
        if (message.done && message.ask === "role") break; // asked by the page itself: what is said stays
        if (this.procedure.takeAnswer(message.done, message.reason)) break;
        this.say(message.done ? "" : message.reason);
        break;
      case "closed":
        this.say(message.reason);
        break;
    }
  }

  /** Shows a refusal, or why the page was closed. Keeps the English text, for a language that is chosen later. */
  private say(text: string): void {
    this.said = text;
    byId("answer").textContent = inLanguage(text);
  }

  private takeLive(live: Live): void {
    if (!this.hello) return;
    this.live = live;
    const compute = this.hello.fields.indexOf("compute_most_us"), wakeup = this.hello.fields.indexOf("wakeup_most_us");
    for (const row of live.windows) {
      this.worst.compute_us = Math.max(this.worst.compute_us, row[compute]);
      this.worst.wakeup_us = Math.max(this.worst.wakeup_us, row[wakeup]);
    }
    this.scene.show(live.view);
    this.charts.add(live.windows);
    this.showFigures();
    this.reportDrawn(live.windows[live.windows.length - 1][0]);
    this.gains.showAge(live.status.model_age_ms);
    this.sound.show(live.status);
    this.showButtons();
  }

  /**
   * Tells the server, a few times a second, that a tick's figures are drawn: at the begin of the frame after the one that
   * draws them. The server measures the time from the tick to this report by its own clock.
   */
  private reportDrawn(stamp_s: number): void {
    const now_ms = performance.now();
    if (!this.operable || document.hidden || now_ms - this.reported_ms < REPORT_EVERY_MS) return;
    this.reported_ms = now_ms;
    requestAnimationFrame(() => requestAnimationFrame(() => this.connection.ask("drawn", stamp_s)));
  }

  private showConnection(connected: boolean): void {
    this.connected = connected;
    byId("connection").textContent = connected ? t("connected") : this.hello ? t("ended") : t("lost");
    byId("connection").style.color = connected ? "var(--good)" : "var(--look)";
    this.showButtons();
  }

  private showFigures(): void {
    if (!this.live || !this.hello) return;
    if (this.hello.command === "cell") this.alone.show(this.live.status, this.hello);
    else this.panels.show(this.live.status, this.hello, this.worst);
    this.showBoneAge(this.live.status.bone_age_ms);
  }

  /** Warns if the shown bone is old, because the machine or this page's connection is busy. */
  private showBoneAge(age_ms: number | null | undefined): void {
    const behind_ms = typeof age_ms === "number" && this.connected ? age_ms + this.scene.surface.unfinished_ms() : 0;
    byId("view-behind").textContent =
      behind_ms > BONE_IS_OLD_MS ? `▲ ${t("boneBehind").replace("{}", figure(behind_ms / 1000, 1))}` : "";
  }

  /** False for a recording and for a simulated cell alone, which take no requests. */
  private get operable(): boolean {
    return this.hello?.command !== "view" && this.hello?.command !== "cell";
  }

  private get status(): Status | null {
    return this.live?.status ?? null;
  }

  private ask(ask: Ask): void {
    if (ask === "stop" && this.status?.state_number === CUTTING && !confirm(t("stopAsk"))) return;
    this.connection.ask(ask);
  }

  private showButtons(): void {
    const may = this.connected && this.role.mine;
    (byId("pause") as HTMLButtonElement).disabled = !may || !this.status?.can_pause;
    (byId("resume") as HTMLButtonElement).disabled = !may || !this.status?.can_resume;
    (byId("recover") as HTMLButtonElement).disabled = !may || !this.status?.can_recover;
    (byId("stop") as HTMLButtonElement).disabled = !may;
    this.gains.enable(may);
    this.procedure.enable(may);
  }

  /** Makes everything that has a text in the chosen language. */
  private buildTexts(): void {
    document.documentElement.lang = getLanguage();
    this.say(this.said);
    (byId("language") as HTMLSelectElement).value = getLanguage();
    byId("buttons").replaceChildren(
      this.button("pause", "pause", "P", () => this.ask("pause")),
      this.button("resume", "resume", "R", () => this.ask("resume")),
      this.button("recover", "recover", "V", () => this.ask("recover")),
      this.button("stop", "stop", "Esc", () => this.ask("stop")),
    );
    byId("stop").classList.add("stop");
    byId("large").textContent = t("large");
    byId("sound").textContent = t("sound");
    byId("view-hint").textContent = t("hint");
    const presets: [Preset, Word, string][] = [
      ["site", "site", "1"],
      ["axis", "axis", "2"],
      ["above", "above", "3"],
      ["behind", "behind", "4"],
      ["whole", "whole", "5"],
    ];
    byId("view-buttons").replaceChildren(
      ...presets.map(([preset, word, key]) => this.button(`preset-${preset}`, word, key, () => this.scene.preset(preset))),
      this.toggle("clip", "clip", "C", false, (on) => this.scene.clip(on)),
      this.toggle("arm", "arm", "A", true, (on) => this.scene.toggle("arm", on)),
      this.toggle("zones", "zones", "Z", false, (on) => this.scene.toggle("zones", on)),
      this.toggle("follow", "follow", "F", false, (on) => this.scene.setFollowing(on)),
      this.toggle("plan", "plan", "L", true, (on) => this.scene.toggle("plan", on)),
      this.toggle("plan-distance", "planDistance", "D", false, (on) => this.colourByPlan(on)),
    );
    byId("view-scale").replaceChildren(...planLegend());
    for (const each of byId("view-buttons").children) each.classList.add("small");
    this.panels.showRole(this.role);
    this.panels.addEvents([]);
    this.gains.setTexts();
    this.procedure.setTexts();
    this.timeline.setTexts();
    this.charts.build();
    this.showButtons();
  }

  /** Colours the bone by its distance to the planned cup, or by tissue. */
  private colourByPlan(on: boolean): void {
    byId("view-scale").hidden = !on;
    this.scene.colourBone(on);
  }

  /** A button that shows its shortcut. */
  private button(id: string, word: Word, key: string, act: () => void): HTMLButtonElement {
    const made = document.createElement("button");
    made.id = id;
    made.textContent = t(word);
    made.dataset.key = key;
    const hint = document.createElement("kbd");
    hint.textContent = key;
    made.append(hint);
    made.onclick = act;
    return made;
  }

  /** A switch. One with this id on the page is replaced, and its state is kept; otherwise it begins as `on`. */
  private toggle(id: string, word: Word, key: string, on: boolean, act: (on: boolean) => void): HTMLButtonElement {
    const before = document.getElementById(id)?.getAttribute("aria-pressed");
    const made = this.button(id, word, key, () => {
      const now = made.getAttribute("aria-pressed") !== "true";
      made.setAttribute("aria-pressed", String(now));
      act(now);
    });
    made.setAttribute("aria-pressed", before ?? String(on));
    return made;
  }

  private bindKeys(): void {
    byId("large").onclick = () => {
      const large = document.documentElement.classList.toggle("large");
      byId("large").setAttribute("aria-pressed", String(large));
    };
    byId("sound").onclick = () => byId("sound").setAttribute("aria-pressed", String(this.sound.toggle()));
    byId("take-role").onclick = () => {
      this.gaveRoleBack = this.role.mine;
      this.connection.ask(this.role.mine ? "watch" : "role");
    };
    byId("language").onchange = (event) => {
      setLanguage((event.target as HTMLSelectElement).value as Language);
      this.buildTexts();
      this.showConnection(this.connected);
      this.showFigures();
    };
    document.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey || event.target instanceof HTMLSelectElement) return;
      if (event.target instanceof HTMLInputElement) return; // the time line's own keys
      // with a recording, the arrow keys belong to the time line unless the picture has the focus
      const picture = byId("timeline").hidden || document.activeElement === byId("view");
      if ((picture || !event.key.startsWith("Arrow")) && this.scene.moveByKey(event)) return event.preventDefault();
      if (event.key === "ArrowRight") this.timeline.step(1);
      if (event.key === "ArrowLeft") this.timeline.step(-1);
      const key = event.key === "Escape" ? "Esc" : event.key.toUpperCase();
      const chosen = [...document.querySelectorAll<HTMLButtonElement>("button[data-key]")].find((b) => b.dataset.key === key);
      if (!chosen || chosen.disabled) return;
      event.preventDefault();
      chosen.click();
    });
  }
}

// for browser tests, and for a look from the browser's console
(window as unknown as { osteon: Page }).osteon = new Page();
