// Sound, off until the operator asks for it: the spindle's pitch by its load, a click at a limit, an alarm at a fault.

import type { Status } from "./messages";

const FREE_HZ = 140; // pitch of the spindle without load
const HZ_PER_NM = 60; // rise of the pitch with the spindle's torque
const SPINDLE_GAIN = 0.03; // loudness of a turning spindle

export class Sound {
  private context: AudioContext | null = null;
  private spindle: OscillatorNode | null = null;
  private gain: GainNode | null = null;
  private limits: string[] = [];
  private faults: string[] = [];

  get on(): boolean {
    return this.context !== null;
  }

  toggle(): boolean {
    if (this.context) {
      void this.context.close();
      this.context = this.spindle = this.gain = null;
      return false;
    }
    this.context = new AudioContext();
    this.spindle = this.context.createOscillator();
    this.spindle.type = "sawtooth";
    this.gain = this.context.createGain();
    this.gain.gain.value = 0;
    this.spindle.connect(this.gain).connect(this.context.destination);
    this.spindle.start();
    return true;
  }

  show(status: Status): void {
    const limits = status.limits, faults = status.faults.map((fault) => fault.name);
    if (this.context && this.spindle && this.gain) {
      const turns = Math.abs(status.spindle_rpm) > 5;
      this.gain.gain.setTargetAtTime(turns ? SPINDLE_GAIN : 0, this.context.currentTime, 0.05);
      this.spindle.frequency.setTargetAtTime(FREE_HZ + HZ_PER_NM * status.spindle_torque_Nm, this.context.currentTime, 0.05);
      // a new limit or fault is heard even if another one ends in the same message
      if (limits.some((name) => !this.limits.includes(name))) this.beep(900, 0.04, 0.08);
      if (faults.some((name) => !this.faults.includes(name))) this.beep(520, 0.9, 0.2);
    }
    this.limits = limits;
    this.faults = faults;
  }

  /** @param volume 0 … 1 */
  private beep(hz: number, seconds: number, volume: number): void {
    const tone = this.context!.createOscillator(), gain = this.context!.createGain();
    tone.frequency.value = hz;
    gain.gain.value = volume;
    tone.connect(gain).connect(this.context!.destination);
    tone.start();
    tone.stop(this.context!.currentTime + seconds);
  }
}
