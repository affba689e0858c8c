// Reads an MCAP file with @mcap/core, by its index and as a stream, and says what is in it.
const fs = require("fs");
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");

async function main(file) {
  const bytes = fs.readFileSync(file);
  const reader = await McapIndexedReader.Initialize({
    readable: {
      size: async () => BigInt(bytes.length),
      read: async (offset, size) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + size))),
    },
  });
  const found = { messages: 0, streamed: 0, topics: {}, schemas: {}, last: {}, chunks: reader.chunkIndexes.length };
  found.statistics = Number(reader.statistics.messageCount);
  found.begin_ns = String(reader.statistics.messageStartTime);
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId);
    const schema = reader.schemasById.get(channel.schemaId);
    ++found.messages;
    found.topics[channel.topic] = (found.topics[channel.topic] ?? 0) + 1;
    found.schemas[channel.topic] = schema ? schema.name : null;
    if (channel.messageEncoding === "json") {
      found.last[channel.topic] = JSON.parse(new TextDecoder().decode(message.data));
      JSON.parse(new TextDecoder().decode(schema.data));
    }
  }
  const stream = new McapStreamReader();
  stream.append(new Uint8Array(bytes));
  for (let record; (record = stream.nextRecord()); ) {
    found.streamed += record.type === "Message" ? 1 : 0;
  }
  if (!stream.done()) {
    throw new Error("the file does not end where it should");
  }
  console.log(JSON.stringify(found));
}

main(process.argv[2]).catch((error) => {
  console.error(error);
  process.exit(1);
});
