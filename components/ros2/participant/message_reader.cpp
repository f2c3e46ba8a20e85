// SPDX-License-Identifier: Apache-2.0
#include "message_reader.hpp"

#include <segue/ros2/dds_names.hpp>

namespace ros2 {

segue::Result<void> MessageReader::open(Participant& participant, const std::string& topic,
                                        const segue::ros2::MessageCodec& message,
                                        const segue::ros2::Quality& quality) {
  auto name = segue::ros2::dds_topic_name(topic);
  if (!name) return name.error();
  auto reader = participant.make_reader({*name, message.dds_type()}, quality,
                                        "typehash=" + message.type_hash() + ";", this);
  if (!reader) return reader.error();
  reader_ = std::move(*reader);
  return {};
}

void MessageReader::on_data_available(dds::DataReader* reader) {
  dds::SampleInfo info;
  while (reader->take_next_sample(static_cast<MessageSink*>(this), &info) == ReturnCode_t::RETCODE_OK) {
  }
}

bool MessageReader::take(std::span<const std::byte> message) noexcept {
  try {
    take_(message);
    return true;
  } catch (const std::bad_alloc&) {
    return false;
  }
}

}  // namespace ros2
