// SPDX-License-Identifier: Apache-2.0
#include "message_writer.hpp"

#include <segue/ros2/dds_names.hpp>

namespace ros2 {

using segue::type::Value;

segue::Result<std::unique_ptr<MessageWriter>> MessageWriter::make(
    const std::shared_ptr<Participant>& participant, segue::ros2::InterfaceLibrary& library,
    const std::string& topic, const std::string& interface, const segue::ros2::Quality& quality) {
  auto name = segue::ros2::dds_topic_name(topic);
  if (!name) return name.error();
  auto codec = segue::ros2::MessageCodec::of(library, interface);
  if (!codec) return codec.error();
  std::unique_ptr<MessageWriter> made(new MessageWriter(participant, std::move(*codec)));
  auto writer = participant->make_writer({*name, made->codec_.dds_type()}, quality,
                                         "typehash=" + made->codec_.type_hash() + ";", made.get(),
                                         Participant::Memory::AsNeeded);
  if (!writer) return writer.error();
  made->writer_ = std::move(*writer);
  return made;
}

void MessageWriter::publish(const Value& message) {
  const auto bytes = codec_.encode(message, "message");
  if (!bytes) return;
  BytesSource source(*bytes);
  writer_->write(static_cast<MessageSource*>(&source));
}

void MessageWriter::watch(std::function<void()> changed) {
  const segue::Lock lock(mutex_);
  changed_ = std::move(changed);
}

void MessageWriter::on_publication_matched(dds::DataWriter*, const dds::PublicationMatchedStatus& status) {
  readers_ = status.current_count;
  const segue::Lock lock(mutex_);
  if (changed_) changed_();
}

Value time_message(std::chrono::system_clock::time_point time) {
  const auto since = time.time_since_epoch();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(since);
  const auto rest = std::chrono::duration_cast<std::chrono::nanoseconds>(since - seconds);
  return Value::map({{"sec", std::int64_t{seconds.count()}}, {"nanosec", std::int64_t{rest.count()}}});
}

}  // namespace ros2
