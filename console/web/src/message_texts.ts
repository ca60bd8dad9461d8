// The cell's own messages in German: refusals, what a fault has measured, events, why a PLC withholds power. Each entry
// repeats a message of the C++ sources, with {} for every value, and its translation. A test in tests/console searches
// the sources for each entry, so it fails if a message is changed there and not here. A message without an entry stays
// in English.

import { germanFault } from "./fault_texts";
import { germanName, getLanguage } from "./texts";

const messages: [string, string][] = [
  // refusals: console/server, session/run, session/procedure
  ["this page watches: take the operator's role first", "diese Seite sieht zu: erst „Bedienen“ wählen"],
  ["another page has the role", "eine andere Seite bedient"],
  ["a running cell has no time line", "eine laufende Zelle hat keine Zeitleiste"],
  ["gains: nothing runs whose gains could be changed", "Verstärkungen: es läuft nichts, dessen Verstärkungen änderbar wären"],
  ["procedure: this run has no plan", "Eingriff: dieser Lauf hat keinen Plan"],
  ["a recording takes no requests", "eine Aufzeichnung nimmt keine Anfragen an"],
  ["the page took nothing for three seconds and was closed; it is connected again",
    "die Seite nahm drei Sekunden lang nichts an und wurde getrennt; sie ist wieder verbunden"],
  ["found a request to a simulated cell alone, accepted by the run that commands it",
    "Anfrage an eine simulierte Zelle allein; nur der Lauf nimmt sie an, der sie steuert"],
  ["the cell is {}: nothing moves that could be paused", "die Zelle ist im Zustand „{}“: nichts bewegt sich, das anzuhalten wäre"],
  ["the cell is {}, not paused", "die Zelle ist im Zustand „{}“, nicht angehalten"],
  ["found the fault {}, which no recovery clears: {}", "Fehler „{}“, den kein Neuanlauf löscht: {}"],
  ["the cell is {}: there is no fault to recover from", "die Zelle ist im Zustand „{}“: es gibt keinen Fehler"],
  ["the cell is {}: a recovery is accepted at rest, before a stop is asked for",
    "die Zelle ist im Zustand „{}“: ein Neuanlauf geht nur im Stillstand, bevor der Lauf beendet wird"],
  ["guidance: found {}, accepted 0 … 1", "Führung: {} gefunden, erlaubt 0 … 1"],
  ["no change of the gains that could be undone", "keine Änderung der Verstärkungen, die rückgängig zu machen wäre"],
  ["stiffness: found {} N/m, accepted {} … {}", "Steifigkeit: {} N/m gefunden, erlaubt {} … {}"],
  ["drag: the impedance law has no virtual tool", "Dämpfung: das Impedanzgesetz hat kein virtuelles Werkzeug"],
  ["drag: found {} N s/m, accepted {} … {}", "Dämpfung: {} N·s/m gefunden, erlaubt {} … {}"],
  ["the run has ended", "der Lauf ist zu Ende"],
  ["another request is being carried out: ask again", "eine andere Anfrage läuft noch: noch einmal versuchen"],
  ["the cell is no longer paused: retract the tool, then pause",
    "die Zelle ist nicht mehr angehalten: Werkzeug zurückziehen, dann anhalten"],
  ["the cell is not paused: retract the tool, then pause", "die Zelle ist nicht angehalten: Werkzeug zurückziehen, dann anhalten"],
  ["the cell is not paused", "die Zelle ist nicht angehalten"],
  ["next: {} mm is the plan's last tool", "nächstes Werkzeug: {} mm ist das letzte des Plans"],
  ["tool: {} mm is in use", "Werkzeug: {} mm ist im Einsatz"],
  ["tool: found {} mm, accepted the plan's: {}", "Werkzeug: {} mm gefunden, erlaubt die des Plans: {}"],
  ["undo: there is no pass to take back", "rückgängig: es gibt keinen Gang, der zurückzunehmen wäre"],
  ["save: the tool touches bone: retract it first", "sichern: das Werkzeug berührt Knochen: erst zurückziehen"],
  ["finish: the tool touches bone: retract it first", "abschließen: das Werkzeug berührt Knochen: erst zurückziehen"],
  ["finish: the plan is not finished: {}; `finish confirmed` ends the session so", "abschließen: der Plan ist nicht fertig: {}"],
  ["finish: the session is saved", "abschließen: die Sitzung ist gesichert"],
  ["the session is finished: the run ends", "die Sitzung ist abgeschlossen: der Lauf endet"],
  ["no pass of its last tool, {} mm, counts", "kein Gang seines letzten Werkzeugs, {} mm, zählt"],
  ["its last tool stopped {} mm short of its planned depth, accepted {} mm",
    "sein letztes Werkzeug blieb {} mm über der geplanten Tiefe, erlaubt {} mm"],
  ["of the planned cavity {} of {} mm³ are left: the last tool is not at its depth",
    "von der geplanten Höhle sind {} von {} mm³ übrig: das letzte Werkzeug ist nicht in seiner Tiefe"],
  ["the plan has no guidance", "der Plan hat keine Führung"],
  ["the sensor's reading at rest is not known yet: ask again in a second",
    "der Ruhewert des Sensors ist noch nicht bekannt: in einer Sekunde noch einmal versuchen"],
  ["retract {} mm first: the tool of {} mm would be {}", "erst {} mm zurückziehen: das Werkzeug mit {} mm wäre {}"],
  ["{} mm in bone", "{} mm im Knochen"],
  ["{} mm from bone, accepted 0.5 mm", "{} mm vom Knochen, erlaubt ab 0.5 mm"],
  ["{}: found no file, accepted a result of `osteon tune {}`", "{}: keine Datei gefunden; `osteon tune {}` macht sie, vor dem Lauf"],
  ["{}: found another file, accepted a tune.json of `osteon tune {}`", "{}: andere Datei gefunden, erlaubt tune.json von `osteon tune {}`"],
  ["{}: found the {} law, accepted the cell's, {}: run `osteon tune {}` again",
    "{}: Gesetz {} gefunden, erlaubt das der Zelle, {}: `osteon tune {}` noch einmal ausführen"],
  ["{}: found a result of the cell {}, accepted one of `osteon tune {}`", "{}: Ergebnis der Zelle {} gefunden, erlaubt eines von `osteon tune {}`"],
  ["{}: found a {} of {} {}, accepted the cell's, {}: run `osteon tune {}` again",
    "{}: {} von {} {} gefunden, erlaubt wie in der Zelle {}: `osteon tune {}` noch einmal ausführen"],
  // why the arm ended commanding or did not begin it: hil/fri/fri_stop.cpp. The first entry that matches is used, so
  // these stand before more general entries that match them too.
  ["timeout before quality GOOD: session closed after {} s", "Verbindung nicht rechtzeitig GOOD: Sitzung nach {} s geschlossen"],
  ["control mode: {} control, the program's command mode needs {} control",
    "Regelungsart: {} gefunden, die Befehlsart des Programms braucht {}"],
  ["not mirrored: A{} commanded {} rad off the interpolator before the motion began, accepted {}",
    "nicht gespiegelt: A{} vor Beginn der Bewegung {} rad neben dem Interpolator befohlen, erlaubt {}"],
  ["count: {} values of a joint position, torque or wrench in a command, accepted {}",
    "Anzahl: {} Werte für Gelenke, Momente oder Kräfte in einem Befehl, erlaubt {}"],
  ["not finite: A{} commanded {}", "nicht endlich: A{} auf {} befohlen"],
  ["not finite: wrench commanded {}", "nicht endlich: Kraft {} befohlen"],
  ["joint limit: A{} commanded {} rad, accepted at {} {}", "Gelenkgrenze: A{} auf {} rad befohlen, erlaubt {} {}"],
  ["most", "höchstens"],
  ["least", "mindestens"],
  ["joint step: A{} moved {} rad in one command, accepted {}", "Gelenksprung: A{} um {} rad in einem Befehl, erlaubt {}"],
  ["illegal axis delta: A{} commanded {} rad from where it is, accepted {}",
    "zu weit entfernt: A{} um {} rad neben seiner Stellung befohlen, erlaubt {}"],
  // what a fault has measured: session/summary/fault_seen.cpp
  ["the last is {}; {} deadlines in a row{}", "die letzte ist {}; {} Fristen nacheinander{}"],
  ["{} N asked of the coupling", "{} N von der Kopplung verlangt"],
  ["the model is {}", "das Modell ist {}"],
  ["the reading is {}", "der Messwert ist {}"],
  ["{}; the PLC's word: {}", "{}; das Wort der SPS: {}"],
  ["{}; its status: {}", "{}; sein Status: {}"],
  ["session state {} ({})", "Sitzungszustand {} ({})"],
  ["safety stop {}", "Sicherheitshalt {}"],
  ["{} N in {} ms, accepted {} N", "{} N in {} ms, erlaubt {} N"],
  ["{}, accepted {} {}", "{}, erlaubt {} {}"],
  ["{} ms old", "{} ms alt"],
  ["not there yet", "noch nicht da"],
  ["none yet", "noch keines"],
  ["ENABLING_SWITCH (979) is not held", "ENABLING_SWITCH (979) ist nicht gehalten"],
  ["no connection to the PLC", "keine Verbindung zur SPS"],
  ["the PLC's registers are too old", "die Register der SPS sind zu alt"],
  ["the PLC answers, but PLC_HEARTBEAT (983) stands still", "die SPS antwortet, doch PLC_HEARTBEAT (983) steht still"],
  ["EMERGENCY_STOP (978) is 1", "EMERGENCY_STOP (978) ist 1"],
  ["RUN_PERMITTED (974) is 0", "RUN_PERMITTED (974) ist 0"],
  // events: session/run, session/procedure
  ["fault: {}; {}", "Fehler: {}; {}"],
  ["end: {}", "Ende: {}"],
  ["{} s of rendering were over", "{} s Rendern waren vorbei"],
  ["the operator's stop", "von der Bedienung beendet"],
  ["the terminal was closed (SIGHUP)", "das Terminal wurde geschlossen (SIGHUP)"],
  ["the engine's process has ended: {}", "der Prozess der Simulation ist zu Ende: {}"],
  ["packing: {}", "Packung: {}"],
  ["tool: {} mm", "Werkzeug: {} mm"],
  ["undo: pass {}", "rückgängig: Gang {}"],
  ["resume: {}", "weiter: {}"],
  ["{}: {} mm, at ({}, {}, {}) mm of the bone", "{}: {} mm, bei ({}, {}, {}) mm des Knochens"],
  // a simulated cell alone: session/run/cell_screen.cpp, hil/fri/fri_stop.cpp
  ["{}; the drives have no power, the PLC withholds it: {}", "{}; die Antriebe sind stromlos, die SPS hält den Strom zurück: {}"],
  ["{}; no PLC master has connected to {} yet: the drives have no power",
    "{}; noch hat sich keine Steuerung mit {} verbunden: die Antriebe sind stromlos"],
  ["the arm has sent nothing yet ({})", "der Arm hat noch nichts gesendet ({})"],
  ["its session is IDLE", "seine Sitzung ist IDLE"],
  ["no arm controller listens on {}: the arm's messages come back",
    "keine Armsteuerung hört auf {}: die Nachrichten des Arms kommen zurück"],
  ["no arm controller answers the arm's messages to {}", "keine Armsteuerung beantwortet die Nachrichten des Arms an {}"],
  ["{} -> {}: {}", "{} -> {}: {}"],
  ["{}: the PLC took it ({})", "{}: die SPS nahm ihn weg ({})"],
  ["the drives have no power", "die Antriebe sind stromlos"],
  ["{} answers in a row lost, the arm ends commanding at {}", "{} Antworten nacheinander verloren, der Arm beendet bei {}"],
  ["{} answers lost within a second, the arm ends commanding at {}",
    "{} Antworten in einer Sekunde verloren, der Arm beendet bei {}"],
  ["emergency stop, level {}", "Not-Halt, Stufe {}"],
  // what the PLC withholds power for: hil/plc/plc_logic.cpp
  ["emergency stop", "Not-Halt"],
  ["controller's heartbeat lost", "Lebenszeichen der Steuerung verloren"],
  ["guard's heartbeat lost", "Lebenszeichen des Wächters verloren"],
  ["guard withdrew the request", "der Wächter zog die Anforderung zurück"],
  ["no controller yet", "noch keine Steuerung"],
  ["no guard yet", "noch kein Wächter"],
  ["no mode", "keine Betriebsart"],
  ["not enabled", "nicht freigegeben"],
  ["not requested", "nicht angefordert"],
  ["not reset", "nicht zurückgesetzt"],
];

const escaped = (text: string): string => text.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");
const patterns: [RegExp, string][] = messages.map(([english, german]) => [
  new RegExp(`^${english.split("{}").map(escaped).join("(.*?)")}$`),
  german,
]);

/** Translates a message of the cell into the page's language, and the values in it, which may be messages too. */
export function inLanguage(text: string): string {
  return getLanguage() === "de" ? german(text) : text;
}

/** Translates a list of messages that are separated by ", ". */
export function listInLanguage(text: string): string {
  return getLanguage() === "de" ? germanList(text) : text;
}

const germanList = (text: string): string => text.split(", ").map(german).join(", ");

/** A message in German; a text that is no known message, fault or name stays as it is. */
function german(text: string): string {
  const [, fault, of] = /^fault: (.*?); (.*)$/.exec(text) ?? [];
  if (of && germanFault(fault)) return `Fehler: ${germanFault(fault)!.name}; ${germanFault(fault)!.reaction}`;
  for (const [pattern, germanText] of patterns) {
    const found = pattern.exec(text);
    if (!found) continue;
    const values = found.slice(1);
    return germanText.replace(/{}/g, () => german(values.shift() ?? ""));
  }
  return germanFault(text)?.name ?? germanName(text) ?? text;
}
