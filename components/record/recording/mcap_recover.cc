#include "components/record/recording/mcap_recover.h"

#include <map>
#include <stdexcept>
#include <string>

#include "components/record/recording/compression.h"
#include "components/record/recording/mcap_writer.h"

namespace sinew::recording {

namespace {

// The compression of the file's chunks, so that a recovered file is about as large.
Compression CompressionOf(const McapReader& reader) {
  if (reader.chunks().empty()) return Compression::kZstd;
  for (const Compression compression : {Compression::kNone, Compression::kLz4}) {
    if (reader.chunks().front().compression == CompressionName(compression)) return compression;
  }
  return Compression::kZstd;
}

McapMetadata DescribeRecovery(const Recovery& recovery) {
  return {"sinew.recovered",
          {{"good_bytes", std::to_string(recovery.good_bytes)},
           {"lost_bytes", std::to_string(recovery.lost_bytes)},
           {"messages", std::to_string(recovery.messages)},
           {"reason", recovery.reason}}};
}

}  // namespace

IoStatus RecoverMcap(const McapReader& reader, ByteSink& sink) {
  if (!reader.recovery()) throw std::logic_error("the file was not cut off");
  McapWriterOptions options;
  options.library = reader.library();
  options.compression = CompressionOf(reader);
  McapWriter writer(sink, options);
  IoStatus status = writer.Open();
  for (const McapMetadata& metadata : reader.ReadMetadata()) {
    if (status.ok()) status = writer.WriteMetadata(metadata);
  }
  if (status.ok()) status = writer.WriteMetadata(DescribeRecovery(*reader.recovery()));
  for (const McapAttachment& attachment : reader.ReadAttachments()) {
    if (status.ok()) status = writer.WriteAttachment(attachment);
  }
  std::map<SchemaId, SchemaId> schemas;  // 0 stays 0: no schema
  for (const auto& [id, schema] : reader.schemas()) {
    if (!status.ok()) return status;
    status = writer.AddSchema(schema.name, schema.encoding, schema.data, &schemas[id]);
  }
  std::map<ChannelId, ChannelId> channels;
  for (const auto& [id, channel] : reader.channels()) {
    if (!status.ok()) return status;
    status = writer.AddChannel(schemas[channel.schema_id], channel.topic, channel.message_encoding,
                               channel.metadata, &channels[id]);
  }
  McapMessages messages = reader.Messages();
  McapMessage message;
  while (status.ok() && messages.Next(&message)) {
    status = writer.WriteMessage(channels.at(message.channel_id), message.log_time_ns,
                                 message.publish_time_ns, message.data, message.sequence);
  }
  return status.ok() ? writer.Close() : status;
}

}  // namespace sinew::recording
