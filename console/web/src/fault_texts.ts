// The faults of safety/fault.cpp in German, by their English names. A test in tests/console requires an entry for each.

interface FaultText {
  name: string;
  cause: string;
  reaction: string;
  clearing: string;
}

const german: Record<string, [name: string, cause: string, reaction: string, clearing: string]> = {
  "arm message stale": [
    "Nachricht des Arms veraltet",
    "mehrmals nacheinander kam innerhalb der Frist keine Nachricht des Arms",
    "hält den letzten Befehl; der Arm ist nicht unter Kontrolle (Stopp 0)",
    "Kabel und Steuerung prüfen; dann neu anlaufen oder einen neuen Lauf beginnen",
  ],
  "contact model stale": [
    "Kontaktmodell veraltet",
    "länger als die Überwachung erlaubt kam kein Schritt der Simulation",
    "hält das Werkzeug, dann Stopp 1",
    "Last und Gerät der Simulation prüfen, einen neuen Lauf beginnen",
  ],
  "force sensor stale": [
    "Kraftsensor veraltet",
    "länger als die Überwachung erlaubt kam kein Wert des Kraftsensors",
    "blendet die Kraft des Bedieners aus, dann Stopp 1",
    "Kabel und Versorgung des Sensors prüfen, einen neuen Lauf beginnen",
  ],
  "coupling wrench rate": [
    "Kraft der Kopplung springt",
    "die Kraft änderte sich schneller, als ein Werkzeug an seiner Geschwindigkeitsgrenze in Knochen drücken kann: 1,5 K v_max",
    "Stopp 1",
    "von Hand zurückführen, Steifigkeit gegen die Geschwindigkeitsgrenze prüfen, einen neuen Lauf beginnen",
  ],
  "sensor force above limit": [
    "Sensorkraft über der Grenze",
    "die Hand drückte über Kraftgrenze und Toleranz hinaus, mehrere Takte nacheinander",
    "Stopp 1",
    "den Griff loslassen, einen neuen Lauf beginnen",
  ],
  "tool speed above limit": [
    "Werkzeug zu schnell",
    "das befohlene Werkzeug war schneller als seine Grenze, obwohl es schon gebremst war",
    "Stopp 1",
    "einen neuen Lauf beginnen; kommt es wieder, die Aufzeichnung für die Betreuer der Software aufheben",
  ],
  "tool outside workspace": [
    "Werkzeug außerhalb des Arbeitsraums",
    "Spitze, Flansch oder Ellbogen war außerhalb des Arbeitsraums, in einer seiner Zonen oder hinter der Tiefengrenze",
    "Stopp 1",
    "das Werkzeug zurückführen, einen neuen Lauf beginnen",
  ],
  "joint limit": [
    "Gelenkgrenze",
    "Lage, Geschwindigkeit oder Schritt eines Gelenks wäre über seiner Grenze gewesen, oder eine Nachricht später sein Moment",
    "Stopp 1 entlang der letzten Gelenkbewegung",
    "das Gelenk von der Grenze wegführen, entlasten, einen neuen Lauf beginnen",
  ],
  "no joint solution": [
    "keine Gelenklösung",
    "für den Weg des Werkzeugs fanden sich keine Gelenkwinkel",
    "Stopp 1 entlang der letzten Gelenkbewegung",
    "den Arm in eine erreichbare Stellung führen, einen neuen Lauf beginnen",
  ],
  "arm left COMMANDING_ACTIVE": [
    "Arm hat COMMANDING_ACTIVE verlassen",
    "der Arm verließ COMMANDING_ACTIVE oder meldete einen Sicherheitshalt",
    "folgt der Stellung des Arms, befiehlt nichts",
    "den Halt des Arms aufheben; dann neu anlaufen oder einen neuen Lauf beginnen",
  ],
  "simulation device lost": [
    "Grafikkarte verloren",
    "die Grafikkarte der Simulation antwortet nicht mehr",
    "Stopp 1",
    "prüfen, ob die Grafikkarte arbeitet (osteon doctor), einen neuen Lauf beginnen",
  ],
  "value not finite or not credible": [
    "Wert nicht endlich oder nicht glaubhaft",
    "von Arm, Sensor oder Simulation kam ein Wert, der keine Zahl, unendlich oder unglaubhaft groß ist",
    "verwirft den Wert, Stopp 1",
    "in den letzten Takten der Aufzeichnung die Quelle suchen, einen neuen Lauf beginnen",
  ],
  "arm far from its command": [
    "Arm weit von seinem Befehl",
    "das gemessene Werkzeug war weiter vom befohlenen entfernt als max_tracking_error",
    "Stopp 1",
    "auf Zusammenstoß oder falsche Last prüfen, einen neuen Lauf beginnen",
  ],
  "arm's period is not the cell's": [
    "Takt des Arms ist nicht der der Zelle",
    "der Arm sendet in einem anderen Takt, als die Zelle eingestellt ist",
    "hält, rendert nichts",
    "period_ms der Zelle auf den Sendetakt des Arms setzen, einen neuen Lauf beginnen",
  ],
  "motion not permitted": [
    "Bewegung nicht freigegeben",
    "die SPS zog ihre Freigabe zurück oder schwieg, oder die Zustimmtaste war nicht gehalten",
    "Stopp 1; die SPS schaltet nach ihrer Frist ab",
    "klären, warum die SPS nicht freigibt, oder die Zustimmtaste wieder halten; quittieren, einen neuen Lauf beginnen",
  ],
  "spindle drive fault": [
    "Fehler des Spindelantriebs",
    "der Antrieb meldete einen Fehler, war nicht bereit oder schwieg",
    "hält die Spindel an, Stopp 1",
    "den Fehler am Antrieb lesen, beheben, einen neuen Lauf beginnen",
  ],
  "force sensor overloaded or faulty": [
    "Kraftsensor überlastet oder gestört",
    "der Sensor meldete Überlast oder einen Ausfall",
    "verwirft den Wert, Stopp 1",
    "den Griff loslassen, den Sensor prüfen, einen neuen Lauf beginnen",
  ],
  "arm's command mode is not the law's": [
    "Befehlsart des Arms passt nicht zum Gesetz",
    "der Arm nimmt Positionen an, wo das Gesetz Kräfte gibt, oder umgekehrt",
    "hält, rendert nichts",
    "das Roboterprogramm zum Gesetz der Zelle starten oder das Gesetz ändern, und einen neuen Lauf beginnen",
  ],
  "spindle beyond its limit": [
    "Spindel über ihrer Grenze",
    "Moment oder Drehzahl war länger als die Auslösezeit über der Grenze der Zelle",
    "hält die Spindel an, Stopp 1",
    "das Werkzeug befreien, die Ursache des Klemmens suchen, einen neuen Lauf beginnen",
  ],
  "computation not repeatable": [
    "Rechnung nicht wiederholbar",
    "ein Takt, zweimal aus denselben Eingaben gerechnet, ergab nicht dasselbe",
    "Stopp 1",
    "Speicher und Kühlung des Rechners prüfen, die Aufzeichnung mit osteon replay nachrechnen, einen neuen Lauf beginnen",
  ],
  "recorder stalled": [
    "Aufzeichnung stockt",
    "2048 Takte warteten auf die Aufzeichnung (2 s bei 1 kHz), oder für einen war kein Platz",
    "Stopp 1",
    "Last und Zustand der Platte prüfen, einen neuen Lauf beginnen",
  ],
  "tool too deep in bone": [
    "Werkzeug zu tief im Knochen",
    "das befohlene Werkzeug war weiter vom Stellvertreter am Knochen entfernt, als max_tool_in_bone_mm erlaubt",
    "Stopp 1",
    "von Hand zurückführen, max_force_N mit der Kraft der Hand vergleichen, einen neuen Lauf beginnen",
  ],
  "measured arm speed above limit": [
    "Arm gemessen zu schnell",
    "das gemessene Werkzeug kam 1 mm weiter, als das 1,5-fache der Geschwindigkeitsgrenze erlaubt, was auch befohlen war",
    "Stopp 1",
    "suchen, was den Arm bewegt hat (verlorene Antworten bei HOLDON 0, ein Stoß), einen neuen Lauf beginnen",
  ],
  "coupling at its force limit": [
    "Kopplung an ihrer Kraftgrenze",
    "die Hand drückte länger als 50 ms stärker, als die Kopplung dagegenhalten darf, und die Zelle verlangt on_force_limit: stop",
    "Stopp 1",
    "weniger drücken, oder max_force_N im Rahmen der Zelle erhöhen, und einen neuen Lauf beginnen",
  ],
  "deflection beyond its limit": [
    "Nachgeben über der Grenze",
    "das Werkzeug war um mehr als ein Zehntel seiner freien Länge gebogen oder mit der halben Knicklast gedrückt, oder die Lagerung des Knochens gab mehr als 10 mm oder 0,1 rad nach",
    "Stopp 1",
    "suchen, was sich gebogen oder bewegt hat, weniger drücken oder ein steiferes Werkzeug nehmen, und einen neuen Lauf beginnen",
  ],
};

/** The German text of the fault with this English name; undefined: there is none. */
export function germanFault(english: string): FaultText | undefined {
  const text = Object.prototype.hasOwnProperty.call(german, english) ? german[english] : undefined;
  return text && { name: text[0], cause: text[1], reaction: text[2], clearing: text[3] };
}

/** A fault with its texts in German; without a German text, the fault itself. */
export function inGerman(fault: FaultText): FaultText {
  return germanFault(fault.name) ?? fault;
}
