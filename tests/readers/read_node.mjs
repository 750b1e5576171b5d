// Reads a log with the JavaScript reader and compares every sample with a CSV export of the same recording.
// Usage: node read_node.mjs LOG.mcap EXPECTED.csv. The packages are found from the working directory.

import assert from "node:assert/strict";
import { open, readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { join } from "node:path";

const require = createRequire(join(process.cwd(), "package.json"));
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { loadDecompressHandlers } = require("@mcap/support");
const protobuf = require("protobufjs");
const { FileDescriptorSet } = require("protobufjs/ext/descriptor");

const [path, expectedPath] = process.argv.slice(2);
const decompressHandlers = await loadDecompressHandlers();

function decoder(schema) {
  const root = protobuf.Root.fromDescriptor(FileDescriptorSet.decode(schema.data));
  root.resolveAll();
  return root.lookupType(schema.name);
}

const lines = (await readFile(expectedPath, "utf8")).trimEnd().split("\n");
const header = lines[0].split(",");
let sampleType;
let fieldOf;

function compare(schema, data, row) {
  sampleType ??= decoder(schema);
  // Fields of the type are camelCase in this library: find them by their column.
  fieldOf ??= Object.fromEntries(
    Object.values(sampleType.fields).map((field) => [field.name.replaceAll("_", "").toLowerCase(), field.name]),
  );
  const sample = sampleType.decode(data);
  const cells = lines[1 + row].split(",");
  header.forEach((column, index) => {
    const field = fieldOf[column.replaceAll("_", "").toLowerCase()];
    assert(field, `no field for ${column}`);
    let value = Object.hasOwn(sample, field) ? sample[field] : undefined;
    if (column === "t_s" && value === undefined) {
      value = Number(sample[fieldOf.devicetimens]) / 1e9;
    }
    const expected = cells[index] === "" ? undefined : Number(cells[index]);
    assert.equal(value, expected, `row ${row}, ${column}`);
  });
}

// Through the index, as a player does.
const file = await open(path);
const size = BigInt((await file.stat()).size);
const reader = await McapIndexedReader.Initialize({
  readable: {
    size: async () => size,
    read: async (offset, length) => {
      const bytes = new Uint8Array(Number(length));
      const { bytesRead } = await file.read(bytes, 0, bytes.length, Number(offset));
      assert.equal(bytesRead, bytes.length);
      return bytes;
    },
  },
  decompressHandlers,
});
assert.equal(reader.header.profile, "socam");
let samples = 0;
let messages = 0n;
for await (const message of reader.readMessages({ validateCrcs: true })) {
  messages += 1n;
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  if (channel.topic === "/socam/sample") {
    compare(schema, message.data, samples);
    samples += 1;
  } else {
    decoder(schema).decode(message.data);
  }
}
assert.equal(messages, reader.statistics.messageCount);
assert.equal(samples, lines.length - 1);
await file.close();

// And from start to end, checksums verified.
const stream = new McapStreamReader({ validateCrcs: true, decompressHandlers });
stream.append(await readFile(path));
let streamed = 0n;
for (let record; (record = stream.nextRecord()); ) {
  if (record.type === "Message") {
    streamed += 1n;
  }
}
assert(stream.done());
assert.equal(streamed, messages);
console.log(`${samples} samples equal`);
