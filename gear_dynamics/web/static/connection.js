// The socket to the server: messages in, view and commands out, and again after a loss.

const AGAIN = 1000; // ms between two tries to connect

/** Read a binary frame: a JSON header, then float32 arrays by name. */
export function readFrame(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  let place = 4 + length;
  const arrays = {};
  for (const [name, count] of Object.entries(header.arrays)) {
    arrays[name] = new Float32Array(buffer, place, count);
    place += 4 * count;
  }
  return {...header, arrays};
}

export class Connection {
  /** `take` is called with each message, `lost` when the server is gone. */
  constructor(take, lost) {
    this.take = take;
    this.lost = lost;
    this.view = null;
    this.waiting = []; // commands that were given while the server was gone
    this.open();
  }

  open() {
    const token = document.querySelector('meta[name=token]').content;
    const socket = new WebSocket(`ws://${location.host}/socket?token=${token}`);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      if (this.view) this.show(this.view);
      for (const command of this.waiting.splice(0)) this.send(command);
    };
    socket.onmessage = ({data}) =>
      this.take(typeof data === 'string' ? JSON.parse(data) : readFrame(data));
    socket.onclose = () => {
      this.lost();
      // A server that was started anew has another token, which only a new page has.
      setTimeout(() => this.reopen(), AGAIN);
    };
    this.socket = socket;
  }

  async reopen() {
    try {
      const page = await fetch('/', {cache: 'no-store'});
      const text = await page.text();
      const token = text.match(/name="token" content="([^"]+)"/);
      if (token) document.querySelector('meta[name=token]').content = token[1];
      this.open();
    } catch {
      setTimeout(() => this.reopen(), AGAIN);
    }
  }

  get isOpen() {
    return this.socket.readyState === WebSocket.OPEN;
  }

  send(message) {
    if (this.isOpen) this.socket.send(JSON.stringify(message));
  }

  show(view) {
    this.view = view;
    this.send({type: 'view', ...view});
  }

  command(command) {
    const message = {type: 'command', ...command};
    if (this.isOpen) this.send(message);
    else this.waiting.push(message);
  }
}
