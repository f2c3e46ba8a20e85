// SPDX-License-Identifier: Apache-2.0
import { applyChange, type Change, type Json } from './change';
import { keptKey, protocolsOf } from './key';

/** The last known value of a document that the robot shows. */
export interface Shown {
  value: Json;
  error?: string;
  version: number;
  /** When the robot said so last, by the browser's clock (ms since 1970); it may have fallen silent since. */
  heard?: number;
  /** How many versions this browser was too slow for, so far. */
  skipped: number;
}

export type Link = 'connecting' | 'open' | 'lost' | 'refused';

export class RobotError extends Error {
  constructor(
    readonly code: string,
    message: string,
  ) {
    super(message);
  }
}

interface Message {
  role?: string;
  robot?: string;
  ros2?: boolean;
  document?: string;
  version?: number;
  skipped?: number;
  value?: Json;
  change?: Change;
  error?: string | { code: string; message: string };
  id?: number | null;
  result?: Json;
}

type Pending = { resolve: (value: Json) => void; reject: (error: Error) => void };

const longestPause = 4000;

/** The socket of the studio: documents that views look at, and calls. Connects again when it was lost. */
export class Connection {
  link: Link = 'connecting';
  role = '';
  robot = '';
  /** ROS 2 is used on the computer of the studio. */
  hasRos2 = false;
  private socket: WebSocket | null = null;
  private pause = 250;
  private nextId = 1;
  private readonly pending = new Map<number, Pending>();
  private readonly documents = new Map<string, Shown>();
  private readonly subscribed = new Map<string, number>();
  private readonly listeners = new Set<() => void>();

  constructor(private readonly address: string) {}

  /** Roles include those before them: observe, operate, administer. */
  get mayOperate(): boolean {
    return this.role === 'operate' || this.role === 'administer';
  }
  get mayAdminister(): boolean {
    return this.role === 'administer';
  }

  start(): void {
    const socket = new WebSocket(this.address, protocolsOf(keptKey()));
    this.socket = socket;
    let opened = false;
    socket.onopen = () => {
      opened = true;
      this.pause = 250;
      for (const document of this.subscribed.keys()) this.send('subscribe', { document });
    };
    socket.onmessage = (message) => this.receive(JSON.parse(String(message.data)) as Message);
    socket.onclose = () => void this.lost(opened);
  }

  onChange = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };

  shown(document: string): Shown | undefined {
    return this.documents.get(document);
  }

  /** Is told of changes of a document until the function that is returned is called. */
  subscribe(document: string): () => void {
    const count = this.subscribed.get(document) ?? 0;
    this.subscribed.set(document, count + 1);
    if (count === 0) this.send('subscribe', { document });
    return () => {
      const left = (this.subscribed.get(document) ?? 1) - 1;
      if (left > 0) {
        this.subscribed.set(document, left);
        return;
      }
      this.subscribed.delete(document);
      this.documents.delete(document);
      this.send('unsubscribe', { document });
    };
  }

  /** Rejected with a RobotError. */
  call(verb: string, args: { [key: string]: Json } = {}): Promise<Json> {
    return new Promise((resolve, reject) => {
      const id = this.send(verb, args);
      if (id === null) reject(new RobotError('unavailable', 'the studio is not connected'));
      else this.pending.set(id, { resolve, reject });
    });
  }

  private send(verb: string, args: { [key: string]: Json }): number | null {
    if (this.socket?.readyState !== WebSocket.OPEN) return null;
    const id = this.nextId++;
    this.socket.send(JSON.stringify({ id, verb, arguments: args }));
    return id;
  }

  private receive(message: Message): void {
    if (message.role !== undefined) {
      this.role = message.role;
      this.robot = message.robot ?? '';
      this.hasRos2 = message.ros2 ?? false;
      this.link = 'open';
    } else if (message.document !== undefined) {
      this.take(message.document, message);
    } else {
      const pending = this.pending.get(message.id ?? -1);
      this.pending.delete(message.id ?? -1);
      if (typeof message.error === 'object') pending?.reject(new RobotError(message.error.code, message.error.message));
      else pending?.resolve(message.result ?? null);
    }
    this.tell();
  }

  private take(name: string, message: Message): void {
    if (!this.subscribed.has(name)) return;
    const before = this.documents.get(name);
    const value = message.change ? applyChange(before?.value ?? {}, message.change) : (message.value ?? null);
    this.documents.set(name, {
      value,
      error: typeof message.error === 'string' ? message.error : undefined,
      version: message.version ?? 0,
      heard: message.error === undefined ? Date.now() : before?.heard,
      skipped: (before?.skipped ?? 0) + (message.skipped ?? 0),
    });
  }

  private async lost(opened: boolean): Promise<void> {
    for (const { reject } of this.pending.values()) reject(new RobotError('unavailable', 'the studio was lost'));
    this.pending.clear();
    this.link = 'lost';
    this.tell();
    const answer = await fetch('/', { method: 'HEAD' }).catch(() => null);
    // The page's files are there, but its socket is not: the key is another studio's.
    if (answer?.status === 403 || (answer?.ok && !opened)) {
      this.link = 'refused';
      this.tell();
    }
    setTimeout(() => this.start(), this.pause);
    this.pause = Math.min(2 * this.pause, longestPause);
  }

  private tell(): void {
    for (const listener of this.listeners) listener();
  }
}
