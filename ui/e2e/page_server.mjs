// SPDX-License-Identifier: Apache-2.0
// Serves the page for a made-up robot: tests and programs that measure decide what the page is told.
import { createHash } from 'node:crypto';
import { existsSync, readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, normalize } from 'node:path';

const types = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml' };

/** A text frame of a WebSocket (RFC 6455, 5.2). */
function frame(text) {
  const body = Buffer.from(text);
  const head = Buffer.alloc(body.length < 126 ? 2 : body.length < 65536 ? 4 : 10);
  head[0] = 0x81;
  head[1] = body.length < 126 ? body.length : body.length < 65536 ? 126 : 127;
  if (head.length === 4) head.writeUInt16BE(body.length, 2);
  if (head.length === 10) head.writeBigUInt64BE(BigInt(body.length), 2);
  return Buffer.concat([head, body]);
}

/** The texts of the whole frames at the beginning of what a browser has sent, which are short and masked; `rest` is what follows. */
function textsIn(bytes) {
  const texts = [];
  let at = 0;
  while (bytes.length >= at + 2) {
    const short = bytes[at + 1] & 0x7f;
    const head = short === 126 ? 4 : 2;
    if (bytes.length < at + head) break;
    const length = short === 126 ? bytes.readUInt16BE(at + 2) : short;
    const end = at + head + 4 + length;
    if (bytes.length < end) break;
    const mask = bytes.subarray(at + head, at + head + 4);
    const body = Buffer.from(bytes.subarray(at + head + 4, end)).map((byte, index) => byte ^ mask[index % 4]);
    if ((bytes[at] & 0x0f) === 1) texts.push(body.toString());
    at = end;
  }
  return { texts, rest: bytes.subarray(at) };
}

/**
 * Serves the page in `folder`, of a robot with that name. Where the page subscribes to a document, `tell(document, send)` answers,
 * and may return how to end that; other requests of the page are not answered.
 */
export async function servePage(folder, robot, tell) {
  const server = createServer((request, response) => {
    const path = join(folder, normalize(request.url === '/' ? 'index.html' : request.url.split('?')[0]));
    if (!existsSync(path)) return response.writeHead(404).end();
    response.writeHead(200, { 'Content-Type': types[extname(path)] ?? 'application/octet-stream' }).end(readFileSync(path));
  });
  server.on('upgrade', (request, socket) => {
    const accept = createHash('sha1').update(request.headers['sec-websocket-key'] + '258EAFA5-E914-47DA-95CA-C5AB0DC85B11').digest('base64');
    socket.write('HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: ' + accept + '\r\n\r\n');
    const send = (message) => socket.writable && socket.write(frame(JSON.stringify(message)));
    send({ role: 'observe', robot });
    const ends = [];
    let left = Buffer.alloc(0);
    socket.on('data', (data) => {
      const { texts, rest } = textsIn(Buffer.concat([left, data]));
      left = rest;
      for (const { verb, arguments: given } of texts.map((text) => JSON.parse(text))) if (verb === 'subscribe') ends.push(tell(given.document, send));
    });
    socket.on('error', () => {});
    socket.on('close', () => ends.forEach((end) => end?.()));
  });
  // A test that fails does not close it, and ends all the same.
  server.on('connection', (socket) => socket.unref());
  server.unref();
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  const close = () => [server.closeAllConnections(), server.close()];
  return { address: 'http://127.0.0.1:' + server.address().port + '/', close };
}
