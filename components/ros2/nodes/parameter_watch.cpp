// SPDX-License-Identifier: Apache-2.0
#include "parameter_watch.hpp"

#include <segue/ros2/interface_library.hpp>
#include <segue/ros2/parameter_value.hpp>

#include <utility>

namespace ros2 {

using segue::type::Value;

namespace {

constexpr std::uint32_t kEventDepth = 1000;  // as rclcpp's clients have it

}  // namespace

segue::Result<std::unique_ptr<ParameterWatch>> ParameterWatch::make(
    const std::shared_ptr<Participant>& participant, const std::string& node) {
  segue::ros2::InterfaceLibrary library;
  auto event = segue::ros2::MessageCodec::of(library, "rcl_interfaces/msg/ParameterEvent");
  if (!event) return event.error();
  std::unique_ptr<ParameterWatch> made(new ParameterWatch(node, std::move(*event)));
  segue::ros2::Quality quality;
  quality.depth = kEventDepth;
  if (auto opened = made->reader_.open(*participant, "/parameter_events", made->event_, quality); !opened)
    return opened.error();
  return made;
}

ParameterWatch::ParameterWatch(std::string node, segue::ros2::MessageCodec event)
    : node_(std::move(node)), event_(std::move(event)), reader_([this](auto bytes) { take(bytes); }) {}

void ParameterWatch::expect(const Value& request) {
  const segue::Lock lock(mutex_);
  expected_.clear();
  for (const Value& one : request.find("parameters")->as_list())
    expected_.insert_or_assign(one.find("name")->as_string(),
                               segue::ros2::parameter_from(*one.find("value")));
  std::erase_if(said_,
                [this](const auto& one) SEGUE_REQUIRES(mutex_) { return !expected_.contains(one.first); });
}

void ParameterWatch::take(std::span<const std::byte> message) {
  const auto event = event_.decode(message);
  if (!event || event->find("node")->as_string() != node_) return;
  const segue::Lock lock(mutex_);
  for (const char* kind : {"new_parameters", "changed_parameters", "deleted_parameters"}) {
    for (const Value& one : event->find(kind)->as_list()) {
      const std::string& name = one.find("name")->as_string();
      const bool is_deleted = kind == std::string_view("deleted_parameters");
      if (expected_.contains(name))
        said_.insert_or_assign(name, is_deleted ? Value() : segue::ros2::parameter_from(*one.find("value")));
    }
  }
}

std::vector<ParameterWatch::Difference> ParameterWatch::differences() const {
  std::vector<Difference> found;
  const segue::Lock lock(mutex_);
  for (const auto& [name, now] : said_) {
    const auto expected = expected_.find(name);
    if (expected != expected_.end() && expected->second != now)
      found.push_back({name, expected->second, now});
  }
  return found;
}

}  // namespace ros2
