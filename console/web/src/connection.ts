// The page's WebSocket: opens it, opens it again when it is lost, and hands over what arrives.

import type { Ask, Message } from "./messages";

export interface Listener {
  message(message: Message): void;
  binary(bytes: ArrayBuffer): void;
  state(connected: boolean): void;
}

const RETRY_MS = 1000; // time from the loss of a connection to the next attempt

export class Connection {
  private socket: WebSocket | null = null;
  private key = ""; // names this page when it connects again, so that the server can say why it closed the page

  constructor(private readonly listener: Listener) {
    this.open();
  }

  /** Sends a request; dropped while not connected. @param value for seek [s], speed, tool [mm], … @param confirmed true: a
   *  person has confirmed the change of tool, or the end of the session */
  ask(ask: Ask, value?: number, confirmed?: true): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ ask, value, confirmed }));
  }

  private take(message: Message): void {
    if (message.type === "key") this.key = message.key;
    else this.listener.message(message);
  }

  private open(): void {
    const query = new URLSearchParams(location.search);
    if (this.key) query.set("was", this.key);
    const socket = new WebSocket(`ws://${location.host}/live?${query}`);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => this.listener.state(true);
    socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => {
      if (typeof event.data === "string") this.take(JSON.parse(event.data) as Message);
      else this.listener.binary(event.data);
    };
    socket.onclose = () => {
      this.listener.state(false);
      setTimeout(() => this.open(), RETRY_MS);
    };
    this.socket = socket;
  }
}
