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
  segue::ros2::Quality quality;
  quality.durability = segue::ros2::Durability::TransientLocal;
  quality.depth = 1000;
  quality.lifespan = std::chrono::seconds(10);
  auto writer = MessageWriter::make(participant, library, "/rosout", "rcl_interfaces/msg/Log", quality);
  if (!writer) return writer.error();
  return std::unique_ptr<Rosout>(new Rosout(std::move(*writer)));
}

void Rosout::publish(const Line& line) {
  writer_->publish(Value::map({{"stamp", time_message(line.time)},
                               {"level", number_of(line.level)},
                               {"name", line.name},
                               {"msg", line.message}}));
}

std::string logger_of(const std::string& node) {
  std::string name = node.substr(node.starts_with('/') ? 1 : 0);
  std::ranges::replace(name, '/', '.');
  return name;
}

}  // namespace ros2
