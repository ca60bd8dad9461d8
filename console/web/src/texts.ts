// Every text of the page, in English and German. States, conditions and limits are found by their recorded number.

export type Language = "en" | "de";

const states: [string, string][] = [
  ["off", "aus"],
  ["checking", "prüft"],
  ["ready", "bereit"],
  ["aligning", "fährt zum Start"],
  ["haptic", "haptisch"],
  ["cutting", "schneidet"],
  ["paused", "angehalten"],
  ["stop 0", "Stopp 0"],
  ["stop 1", "Stopp 1"],
  ["stop 2", "Stopp 2"],
  ["fault", "Fehler"],
  ["recovery", "Wiederanlauf"],
];

// what a state does; the English words are the server's own
const does: string[] = [
  "befiehlt nichts; folgt einem Arm, der sagt, wo er ist",
  "der Arm bewegt sich selbst; eine Bedingung fehlt noch",
  "jede Bedingung gilt; wartet auf die Übergabe des Arms",
  "fährt zum Beginn, solange die Zustimmtaste gehalten ist",
  "rendert; die Spindel steht",
  "rendert; die Spindel dreht",
  "hält unter Strom, die Spindel steht; prüft die Bedingungen",
  "der Arm ist nicht unter Kontrolle",
  "bremst bis zum Stillstand; verlangt keine Bewegung mehr",
  "bremst bis zum Stillstand, bleibt unter Strom",
  "steht mit einem Fehler; verlangt keine Bewegung",
  "wartet auf den Arm und auf jede Bedingung",
];

const permits: [string, string][] = [
  ["a message of the arm", "Nachricht des Arms"],
  ["arm handed over, no safety stop", "Arm übergeben, kein Sicherheitshalt"],
  ["PLC permits, enabling switch held", "Freigabe der SPS, Zustimmtaste gehalten"],
  ["force sensor fresh", "Kraftsensor aktuell"],
  ["contact model fresh", "Kontaktmodell aktuell"],
  ["arm where it is commanded", "Arm dort, wo er sein soll"],
  ["tool not deeper than the force limit", "Werkzeug nicht tiefer als die Kraftgrenze"],
  ["spindle's drive ready", "Spindelantrieb bereit"],
  ["way to the start checked", "Weg zum Start geprüft"],
  ["hand off the handle at rest", "Hand ruht nicht auf dem Griff"],
];

const limits: [string, string][] = [
  ["force of the coupling", "Kraft der Kopplung"],
  ["arm's torque", "Moment des Arms"],
  ["stored energy", "gespeicherte Energie"],
  ["power into the hand", "Leistung an die Hand"],
  ["tool speed", "Werkzeuggeschwindigkeit"],
  ["workspace", "Arbeitsraum"],
  ["zones", "Zonen"],
  ["joints", "Gelenke"],
  ["elbow speed", "Ellbogengeschwindigkeit"],
  ["depth", "Tiefe"],
  ["model's age", "Alter des Modells"],
  ["sensor's age", "Alter des Sensors"],
  ["age governor", "Altersregler"],
  ["passivity", "Passivität"],
  ["energy tank", "Energietank"],
  ["speed into bone", "Eintritt in Knochen"],
  ["guidance along the plan", "Führung am Plan"],
  ["deflection", "Nachgeben"],
];

// which bound the cell's limit of the force is (session/summary/limit_rows.cpp)
const bounds: Record<string, [string, string]> = {
  cell: ["the cell's", "der Zelle"],
  ceiling: ["ceiling of every cell", "Obergrenze jeder Zelle"],
  "stored energy": ["stored energy", "gespeicherte Energie"],
};

// metrics of a rubric (procedure/assessment/score.cpp); the English words are the server's own
const metrics: Record<string, string> = {
  axis_error: "Achsfehler",
  superior_shift: "Verschiebung des Zentrums nach superior",
  medial_shift: "Verschiebung des Zentrums nach medial",
  posterior_shift: "Verschiebung des Zentrums nach posterior",
  diameter_error: "Durchmesserfehler",
  form_p95: "Unrundheit, 95. Perzentil",
  coverage: "Überdachung",
  opening_shift: "Verschiebung der Öffnung von ihrer Achse",
  depth_error: "Tiefenfehler",
  unroofed: "geöffnetes Dach über dem Ziel",
  over_reamed: "zu viel gefräst",
  under_reamed: "zu wenig gefräst",
  cartilage_left: "Knorpelrest im Dach",
  rim_preserved: "erhaltener Rand",
  time: "Zeit",
  cutting_time: "Schnittzeit",
  path: "Weg des Kopfes nahe der Pfanne",
  force_mean: "Handkraft beim Schneiden, Mittel",
  force_peak: "Handkraft beim Schneiden, Spitze",
  wrong_way: "Anteil des Handimpulses quer zur Achse",
  outside: "Schnitt außerhalb der Führung",
  tremor: "Tremor, 6 bis 14 Hz",
  breach: "Durchbruch",
  "breach (assumed)": "Durchbruch (angenommen)",
};

const words = {
  connected: ["connected", "verbunden"],
  lost: ["connection lost: tries again", "Verbindung verloren: neuer Versuch"],
  ended: [
    "the run has ended, or is out of reach; its last picture stays",
    "der Lauf ist zu Ende oder nicht erreichbar; das letzte Bild bleibt",
  ],
  operator: ["you operate", "Sie bedienen"],
  watch: ["you watch", "Sie sehen zu"],
  pages: ["pages", "Seiten"],
  page: ["page", "Seite"],
  takeRole: ["Operate", "Bedienen"],
  giveRole: ["Hand over", "Abgeben"],
  large: ["Large", "Groß"],
  sound: ["Sound", "Ton"],
  pause: ["Pause", "Anhalten"],
  resume: ["Resume", "Weiter"],
  recover: ["Recover", "Neu anlaufen"],
  recoverNow: [
    "Recover clears it: motion begins anew once every condition holds",
    "„Neu anlaufen“ löscht ihn: Bewegung beginnt neu, sobald jede Bedingung gilt",
  ],
  recoverNever: ["no recovery clears it: a new run is needed", "kein Neuanlauf löscht ihn: ein neuer Lauf ist nötig"],
  stop: ["Stop", "Beenden"],
  stopAsk: ["The tool is cutting. End the run?", "Das Werkzeug schneidet. Lauf beenden?"],
  gains: ["Gains", "Verstärkungen"],
  stiffness: ["Stiffness", "Steifigkeit"],
  drag: ["Drag", "Dämpfung"],
  ownGain: ["the cell's own", "der Zelle eigene"],
  accepted: ["accepted", "erlaubt"],
  margin: ["Planes' age: stable up to", "Alter der Ebenen: stabil bis"],
  noTune: ["No result of osteon tune: margin and recommended gains are not known", "Kein Ergebnis von osteon tune: Reserve und empfohlene Verstärkungen sind nicht bekannt"],
  gainMargin: ["gain margin", "Verstärkungsreserve"],
  askedMargin: ["asked for", "verlangt"],
  atLeast: ["at least", "mindestens"],
  marginUnknown: ["not known of these gains", "für diese Verstärkungen nicht bekannt"],
  notStable: ["not stable with all hands", "nicht mit allen Händen stabil"],
  noneStable: ["no gains are stable with all hands", "keine Verstärkungen sind mit allen Händen stabil"],
  stableWall: ["stable wall at this drag, up to", "stabile Wand bei dieser Dämpfung, bis"],
  recommended: ["recommended", "empfohlen"],
  now: ["now", "jetzt"],
  set: ["Set", "Setzen"],
  undo: ["Undo", "Rückgängig"],
  gainsNote: [
    "within a second; stiffness rises only while nothing presses",
    "binnen einer Sekunde; Steifigkeit steigt nur, solange nichts drückt",
  ],
  force: ["Force to the hand", "Kraft an die Hand"],
  limitOf: ["limit", "Grenze"],
  hand: ["Hand", "Hand"],
  torqueToHand: ["Torque", "Moment"],
  depth: ["Depth", "Tiefe"],
  depthLeft: ["To the depth limit", "Bis zur Tiefengrenze"],
  deepest: ["Deepest so far", "Tiefster Punkt"],
  speed: ["Tool speed", "Werkzeuggeschwindigkeit"],
  feed: ["Feed along the axis", "Vorschub längs der Achse"],
  spindle: ["Spindle", "Spindel"],
  bend: ["Tool bends", "Werkzeug biegt sich"],
  layer: ["Tissue yields", "Gewebe gibt nach"],
  mount: ["Bone moves", "Knochen bewegt sich"],
  removed: ["Bone removed", "Knochen entfernt"],
  acting: ["Limits acting now", "Wirkende Grenzen"],
  since: ["for", "seit"],
  none: ["none", "keine"],
  conditions: ["Conditions of motion", "Bedingungen der Bewegung"],
  conditionsHeld: ["held when motion began; one that ends is a fault", "galten beim Beginn; endet eine, ist es ein Fehler"],
  conditionsLater: ["looked at again once the cell waits for motion", "werden wieder geprüft, wenn die Zelle wartet"],
  health: ["Health", "Zustand"],
  armAge: ["Age of the arm's message", "Alter der Nachricht des Arms"],
  plcAge: ["Age of the PLC's word", "Alter des Worts der SPS"],
  modelAge: ["Contact model's age", "Alter des Kontaktmodells"],
  sensorAge: ["Force sensor's age", "Alter des Kraftsensors"],
  boneAge: ["Picture of the bone", "Bild des Knochens"],
  boneBehind: ["bone {} s behind", "Knochen {} s zurück"],
  frame: ["Simulation frame", "Simulationsschritt"],
  tickMost: ["Tick, 99 % below", "Takt, 99 % unter"],
  wakeupMost: ["Wake-up, 99 % below", "Aufwachen, 99 % unter"],
  lostMessages: ["Messages lost", "Verlorene Nachrichten"],
  ofTheArm: ["of the arm", "des Arms"],
  answers: ["answers", "Antworten"],
  diskLeft: ["Disk left", "Freier Speicherplatz"],
  tick: ["Tick, worst", "Takt, schlimmster"],
  wakeup: ["Wake-up, worst", "Aufwachen, spätestes"],
  handToArm: ["Hand to arm", "Hand bis Arm"],
  handMovesArm: ["the hand moves it itself", "die Hand bewegt ihn selbst"],
  boneToHand: ["Bone to hand", "Knochen bis Hand"],
  assumed: ["assumed", "angenommen"],
  events: ["Events", "Ereignisse"],
  aloneCommanded: ["the arm follows its controller", "der Arm folgt seiner Steuerung"],
  aloneWaits: ["waits for a controller: osteon run", "wartet auf eine Steuerung: osteon run"],
  drives: ["Drives", "Antriebe"],
  powerOn: ["powered", "unter Strom"],
  powerOff: ["without power", "ohne Strom"],
  withheld: ["the PLC withholds power", "die SPS hält den Strom zurück"],
  script: ["Operator's script", "Skript der Bedienung"],
  scriptDone: ["done", "zu Ende"],
  scriptGoesOn: ["goes on", "läuft"],
  sent: ["Messages sent", "Nachrichten gesendet"],
  answered: ["Answered", "Beantwortet"],
  answersLost: ["Answers lost", "Verlorene Antworten"],
  overruns: ["Cycles begun late", "Verspätete Takte"],
  play: ["Play", "Abspielen"],
  halt: ["Halt", "Halt"],
  eventBefore: ["event before", "voriges Ereignis"],
  eventNext: ["next event", "nächstes Ereignis"],
  time: ["time", "Zeit"],
  speedOf: ["speed of the playback", "Geschwindigkeit der Wiedergabe"],
  recording: ["recording", "Aufzeichnung"],
  fault: ["Fault", "Fehler"],
  seen: ["Seen", "Gesehen"],
  did: ["The cell", "Die Zelle"],
  cure: ["Go on", "Weiter"],
  acknowledge: ["Acknowledge", "Quittieren"],
  showAgain: ["Show again", "Wieder zeigen"],
  stopPage: ["Once the run has ended, all of it is in", "Nach dem Ende des Laufs steht alles in"],
  rendered: ["rendered", "gerendert"],
  of: ["of", "von"],
  paused: ["paused", "angehalten"],
  waits: ["waits for the first message", "wartet auf die erste Nachricht"],
  freeze: ["Freeze", "Einfrieren"],
  picture: ["Picture", "Bild"],
  zoomHint: ["zoom: drag, back: double click", "Zoom: ziehen, zurück: Doppelklick"],
  forceChart: ["Force", "Kraft"],
  removedChart: ["Volume", "Volumen"],
  tickChart: ["Tick", "Takt"],
  virtualTime: ["not measured: virtual time", "nicht gemessen: virtuelle Zeit"],
  apart: ["Tools apart", "Abstand der Werkzeuge"],
  turned: ["turned", "verdreht"],
  largest: ["Largest difference", "Größter Unterschied"],
  noDifference: ["No difference", "Kein Unterschied"],
  ticksCompared: ["ticks compared", "Takte verglichen"],
  boneMap: ["Bone difference", "Knochenunterschied"],
  firstDeeper: ["first deeper", "erste tiefer"],
  secondDeeper: ["second deeper", "zweite tiefer"],
  noBoneDifference: ["The bones do not differ", "Die Knochen unterscheiden sich nicht"],
  at: ["at", "bei"],
  first: ["first", "erste"],
  second: ["second", "zweite"],
  difference: ["difference", "Unterschied"],
  whole: ["Cell", "Zelle"],
  site: ["Site", "Stelle"],
  axis: ["Along the axis", "Längs der Achse"],
  above: ["From above", "Von oben"],
  behind: ["From the hand", "Von der Hand"],
  clip: ["Cut open", "Schnitt"],
  arm: ["Arm", "Arm"],
  zones: ["Zones", "Zonen"],
  follow: ["Follow", "Folgen"],
  plan: ["Plan", "Plan"],
  planDistance: ["Distance to plan", "Abstand zum Plan"],
  stillToCut: ["still to cut", "noch zu schneiden"],
  beyondPlan: ["beyond the plan", "über den Plan hinaus"],
  procedure: ["Procedure", "Eingriff"],
  nextTool: ["Next tool", "Nächstes Werkzeug"],
  undoPass: ["Undo pass", "Gang zurück"],
  save: ["Save", "Sichern"],
  keepCup: ["Keep cup", "Pfanne merken"],
  guidance: ["Guidance", "Führung"],
  off: ["off", "aus"],
  toGo: ["To go", "Noch"],
  tilt: ["Tilt", "Neigung"],
  aside: ["Aside", "Seitlich"],
  axisSoFar: ["Axis error so far", "Achsfehler bisher"],
  removedByTool: ["Removed by this tool", "Von diesem Werkzeug entfernt"],
  outside: ["Cutting outside of the corridor", "Schnitt außerhalb der Führung"],
  passes: ["Passes", "Gänge"],
  undone: ["undone", "zurückgenommen"],
  cup: ["Cup", "Pfanne"],
  kept: ["kept", "gemerkt"],
  finish: ["Finish", "Abschließen"],
  finishAsk: ["End the session all the same?", "Die Sitzung trotzdem beenden?"],
  scoreSoFar: ["Score so far", "Punkte bisher"],
  scoreWaits: ["known once a pass has ended", "bekannt, sobald ein Gang beendet ist"],
  points: ["points", "Punkte"],
  open: ["open", "offen"],
  scoreOf: ["passes: {}; {} s ago", "Gänge: {}; vor {} s"],
  cutSince: ["cut since", "seitdem geschnitten"],
  notFinished: ["The plan is not finished", "Der Plan ist nicht fertig"],
  guidedScore: ["guided: not to be ranked with sessions without guidance", "geführt: nicht mit Sitzungen ohne Führung zu vergleichen"],
  confirmTool: ["Is the tool of {} mounted?", "Ist das Werkzeug mit {} montiert?"],
  hint: [
    "turn: drag or arrows, move: right button or Shift + arrows, zoom: wheel or + −",
    "drehen: ziehen oder Pfeiltasten, verschieben: rechte Taste oder Umschalt + Pfeile, Zoom: Rad oder + −",
  ],
} satisfies Record<string, [string, string]>;

export type Word = keyof typeof words;

let language: Language = navigator.language.startsWith("de") ? "de" : "en";

export function setLanguage(chosen: Language): void {
  language = chosen;
}
export function getLanguage(): Language {
  return language;
}

/** The text of a pair in the page's language; `otherwise` without a pair. */
const pick = (pair: [string, string] | undefined, otherwise: string): string =>
  pair ? pair[language === "de" ? 1 : 0] : otherwise;

/** A word or sentence of the page. */
export const t = (word: Word): string => pick(words[word] as [string, string], word);
export const stateName = (number: number, otherwise: string): string => pick(states[number], otherwise);
export const stateDoes = (number: number, english: string): string => (language === "de" ? (does[number] ?? english) : english);
export const permitName = (number: number, otherwise: string): string => pick(permits[number], otherwise);
/** A state's or a limit's German name by its English one. */
export const germanName = (english: string): string | undefined =>
  [...states, ...limits].find(([name]) => name === english)?.[1];
export const boundName = (name: string): string => pick(bounds[name], name);
export const metricName = (metric: string, english: string): string => (language === "de" ? (metrics[metric] ?? english) : english);
export const limitName = (number: number, otherwise: string): string => pick(limits[number], otherwise);

/** A number with its digits after the point, as the language writes it. */
export function figure(value: number, digits: number): string {
  const rounded = Number(value.toFixed(digits)) + 0; // no -0
  return rounded.toLocaleString(language, { minimumFractionDigits: digits, maximumFractionDigits: digits, useGrouping: false });
}
