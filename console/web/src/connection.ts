// The page's WebSocket: opens it, opens it again when it is lost, and hands over what arrives.

import type { Ask, Message } from "./messages";

export interface Listener {
  message(message: Message): void;
  binary(bytes: ArrayBuffer): void;
  state(connected: boolean): void;
}

const RETRY_MS = 1000;

export class Connection {
  private socket: WebSocket | null = null;

  constructor(private readonly listener: Listener) {
    this.open();
  }

  /** @param value of seek [s], speed, tool [mm], … @param confirmed of a change of tool: true, or nothing */
  ask(ask: Ask, value?: number, confirmed?: true): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ ask, value, confirmed }));
  }

  private open(): void {
    const socket = new WebSocket(`ws://${location.host}/live${location.search}`);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => this.listener.state(true);
    socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => {
      if (typeof event.data === "string") this.listener.message(JSON.parse(event.data) as Message);
      else this.listener.binary(event.data);
    };
    socket.onclose = () => {
      this.listener.state(false);
      setTimeout(() => this.open(), RETRY_MS);
    };
    this.socket = socket;
  }
}
