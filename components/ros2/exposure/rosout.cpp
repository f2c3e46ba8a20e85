// SPDX-License-Identifier: Apache-2.0
#include "rosout.hpp"

#include <algorithm>
#include <utility>

namespace ros2 {

using segue::type::Value;

namespace {

/// The constants of rcl_interfaces/msg/Log.
int number_of(segue::LogLevel level) {
  switch (level) {
    case segue::LogLevel::Debug:
      return 10;
    case segue::LogLevel::Info:
      return 20;
    case segue::LogLevel::Warning:
      return 30;
    case segue::LogLevel::Error:
      return 40;
  }
  return 20;
}

}  // namespace

segue::Result<std::unique_ptr<Rosout>> Rosout::make(const std::shared_ptr<Participant>& participant) {
  segue::ros2::InterfaceLibrary library;
  auto codec = segue::ros2::MessageCodec::of(library, "rcl_interfaces/msg/Log");
  if (!codec) return codec.error();
  segue::ros2::Quality quality;
  quality.durability = segue::ros2::Durability::TransientLocal;
  quality.depth = 1000;
  quality.lifespan = std::chrono::seconds(10);
  auto writer = participant->make_writer({"rt/rosout", codec->dds_type()}, quality,
                                         "typehash=" + codec->type_hash() + ";", nullptr,
                                         Participant::Memory::AsNeeded);
  if (!writer) return writer.error();
  return std::unique_ptr<Rosout>(new Rosout(std::move(*codec), std::move(*writer)));
}

void Rosout::publish(const Line& line) {
  const auto time = line.time.time_since_epoch();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  const Value stamp = Value::map(
      {{"sec", std::int64_t{seconds.count()}},
       {"nanosec",
        std::int64_t{std::chrono::duration_cast<std::chrono::nanoseconds>(time - seconds).count()}}});
  const auto message = codec_.encode(
      Value::map(
          {{"stamp", stamp}, {"level", number_of(line.level)}, {"name", line.name}, {"msg", line.message}}),
      "line");
  if (!message) return;
  BytesSource source(*message);
  writer_->write(static_cast<MessageSource*>(&source));
}

bool Rosout::is_read() const {
  dds::PublicationMatchedStatus status;
  writer_->get_publication_matched_status(status);
  return status.current_count > 0;
}

std::string logger_of(const std::string& node) {
  std::string name = node.substr(node.starts_with('/') ? 1 : 0);
  std::ranges::replace(name, '/', '.');
  return name;
}

}  // namespace ros2
