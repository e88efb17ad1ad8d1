// A client of sinew-view that reads every topic (Foxglove's own client, tests/tools/view/vendor), until its input ends.
// Usage: node client.mjs PORT: prints, at the end, {"messages", "bytes", "warnings"}.
import { createRequire } from 'node:module';

const { FoxgloveClient, WebSocket } = createRequire(import.meta.url)('../../tests/tools/view/vendor/foxglove_client.cjs');
const client = new FoxgloveClient({
  ws: new WebSocket(`ws://127.0.0.1:${process.argv[2]}`, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]),
});
let messages = 0;
let bytes = 0;
let warnings = 0;
client.on('advertise', (channels) => channels.forEach((channel) => client.subscribe(channel.id)));
client.on('message', ({ data }) => {
  ++messages;
  bytes += data.byteLength;
});
client.on('status', () => { ++warnings; });  // such as: messages were lost, the client is too slow
client.on('error', (error) => {
  console.error(error.message ?? error);
  process.exit(1);
});
process.stdin.resume();
process.stdin.on('end', () => {
  console.log(JSON.stringify({ messages, bytes, warnings }));
  process.exit(0);
});
