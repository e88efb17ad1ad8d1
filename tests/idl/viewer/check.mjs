// Reads our recording as the MCAP viewers do: @mcap/core for the container, omgidl-parser for the schemas,
// omgidl-serialization for the messages. Usage: node check.mjs SAMPLE.mcap EXPECTED.jsonl FILE.idl...
import { readFileSync } from "node:fs";
import { open } from "node:fs/promises";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import * as parser from "@foxglove/omgidl-parser";
import * as serialization from "@foxglove/omgidl-serialization";
import { decompress } from "fzstd";

const [sample, expectedPath, ...idlFiles] = process.argv.slice(2);
const { parseIDL } = parser.default ?? parser;
const { MessageReader } = serialization.default ?? serialization;
let failures = 0;

function fail(message) {
  console.error(message);
  ++failures;
}

for (const path of idlFiles) {
  try {
    if (parseIDL(readFileSync(path, "utf8")).length === 0) fail(`${path}: no definition found`);
  } catch (error) {
    fail(`${path}: ${error.message}`);
  }
}

// Typed arrays become arrays; 64-bit integers become texts, as in the expected file.
function plain(value) {
  if (typeof value === "bigint") return value.toString();
  if (ArrayBuffer.isView(value) || Array.isArray(value)) return Array.from(value, plain);
  if (value !== null && typeof value === "object") {
    return Object.fromEntries(Object.entries(value).map(([key, inner]) => [key, plain(inner)]));
  }
  return value;
}

const expected = readFileSync(expectedPath, "utf8").trim().split("\n").map((line) => JSON.parse(line));
const decompressHandlers = {
  zstd: (buffer, size) => decompress(buffer, new Uint8Array(Number(size))),
};

class FileReadable {
  constructor(file) { this.file = file; }
  async size() { return BigInt((await this.file.stat()).size); }
  async read(offset, length) {
    const bytes = new Uint8Array(Number(length));
    await this.file.read(bytes, 0, Number(length), Number(offset));
    return bytes;
  }
}

const file = await open(sample);
const reader = await McapIndexedReader.Initialize({ readable: new FileReadable(file), decompressHandlers });
if (reader.header.profile !== "") fail(`profile '${reader.header.profile}', expected none`);
const readers = new Map();
for (const channel of reader.channelsById.values()) {
  const schema = reader.schemasById.get(channel.schemaId);
  if (channel.messageEncoding !== "cdr" || schema.encoding !== "omgidl") fail(`${channel.topic}: wrong encodings`);
  const definitions = parseIDL(new TextDecoder().decode(schema.data));
  readers.set(channel.id, new MessageReader(schema.name, definitions));
}
let index = 0;
for await (const message of reader.readMessages()) {
  const topic = reader.channelsById.get(message.channelId).topic;
  const want = expected[index++];
  const got = plain(readers.get(message.channelId).readMessage(message.data));
  if (topic !== want.topic) fail(`message ${index}: topic ${topic}, expected ${want.topic}`);
  if (message.logTime.toString() !== want.log_time) fail(`${topic}: log time ${message.logTime}`);
  if (message.publishTime.toString() !== want.publish_time) fail(`${topic}: publish time ${message.publishTime}`);
  if (JSON.stringify(got) !== JSON.stringify(want.value)) {
    fail(`${topic}: got ${JSON.stringify(got)}\nexpected ${JSON.stringify(want.value)}`);
  }
}
if (index !== expected.length) fail(`${index} messages, expected ${expected.length}`);
let metadata = 0;
for await (const record of reader.readMetadata()) metadata += record.metadata.get("seed") === "7" ? 1 : 0;
if (metadata !== 1) fail("the metadata record is missing");
await file.close();

// The same from beginning to end, all checksums checked.
const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
stream.append(new Uint8Array(readFileSync(sample)));
let streamed = 0;
for (let record = stream.nextRecord(); record; record = stream.nextRecord()) {
  streamed += record.type === "Message" ? 1 : 0;
}
if (streamed !== expected.length || !stream.done()) fail(`streamed ${streamed} messages, expected ${expected.length}`);

if (failures > 0) process.exit(1);
console.log(`the viewers' parsers accept ${idlFiles.length} files and read ${index} messages of ${readers.size} topics`);
