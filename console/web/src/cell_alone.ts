// The column of figures for `osteon cell`: the arm's session, what withholds power, and counts of messages.

import type { CellNote, Hello, Status } from "./messages";
import { byId, element, set, table } from "./elements";
import { inLanguage, listInLanguage } from "./message_texts";
import { figure, t } from "./texts";

export class CellAlone {
  private note: CellNote | null = null;

  take(note: CellNote): void {
    this.note = note;
  }

  show(status: Status, hello: Hello): void {
    const note = this.note;
    if (!note) return;
    const panel = byId("state");
    const level = note.commanded ? "good" : note.stop && note.answered > 0 ? "bad" : "look";
    if (panel.className !== level) panel.className = level;
    const does = note.commanded ? t("aloneCommanded") : (note.answered > 0 && inLanguage(note.stop)) || t("aloneWaits");
    const withheld = note.power_on || !note.blocks ? [] : [element("div", "does", `${t("withheld")}: ${listInLanguage(note.blocks)}`)];
    set("state", element("div", "name", note.session), element("div", "does", does), ...withheld);
    set(
      "figures",
      table([
        [t("hand"), `${figure(status.hand_N, 1)} N`],
        [t("speed"), `${figure(status.speed_mm_per_s, 0)} ${t("of")} ${figure(hello.speed_limit_mm_per_s, 0)} mm/s`],
        [t("spindle"), `${figure(status.spindle_rpm, 0)} rpm`],
        [t("drives"), t(note.power_on ? "powerOn" : "powerOff")],
        [t("script"), t(note.script_done ? "scriptDone" : "scriptGoesOn")],
      ]),
    );
    set(
      "health",
      element("h2", "", t("health")),
      table([
        [t("sent"), String(note.sent)],
        [t("answered"), String(note.answered)],
        [t("answersLost"), String(note.lost)],
        [t("overruns"), String(note.overruns)],
      ]),
    );
  }
}
