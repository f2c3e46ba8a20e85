// SPDX-License-Identifier: Apache-2.0
#include "node_task.hpp"

#include <segue/base/text.hpp>
#include <segue/ros2/dds_names.hpp>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string_view>
#include <utility>

namespace ros2 {
namespace {

using segue::ErrorCode;
using segue::fail;
using segue::quote;

std::string_view environment(const char* variable) {
  const char* text = std::getenv(variable);
  return text == nullptr ? std::string_view() : std::string_view(text);
}

segue::Result<std::uint32_t> domain_of_environment() {
  const std::string_view text = environment("ROS_DOMAIN_ID");
  std::uint32_t domain = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), domain);
  if (text.empty() || (error == std::errc() && end == text.data() + text.size())) return domain;
  return fail(ErrorCode::InvalidArgument,
              "$ROS_DOMAIN_ID is " + quote(text) + ", which is not a valid number");
}

/// From Iron on there is a range, before it a switch.
segue::Result<bool> is_localhost_only(std::string_view wanted) {
  if (wanted == "localhost") return true;
  if (wanted == "subnet") return false;
  if (!wanted.empty()) {
    return fail(ErrorCode::InvalidArgument,
                "discovery " + quote(wanted) + " is not known: expected localhost or subnet");
  }
  const std::string_view range = environment("ROS_AUTOMATIC_DISCOVERY_RANGE");
  return range == "LOCALHOST" || (range.empty() && environment("ROS_LOCALHOST_ONLY") == "1");
}

/// The id of a task, such as "front.camera", as the name of a node.
std::string node_name_of(std::string_view task) {
  std::string name(task);
  std::ranges::replace_if(
      name,
      [](char c) {
        return !((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_');
      },
      '_');
  return name;
}

}  // namespace

segue::Result<Settings> NodeTask::wanted_settings() const {
  Settings settings;
  auto localhost = is_localhost_only(*discovery_);
  if (!localhost) return localhost.error();
  settings.localhost_only = *localhost;
  settings.domain = static_cast<std::uint32_t>(std::max(*domain_, 0));
  if (*domain_ >= 0) return settings;
  auto domain = domain_of_environment();
  if (!domain) return domain.error();
  settings.domain = *domain;
  return settings;
}

segue::Result<void> NodeTask::name_node(std::string_view prefix) {
  const std::string text = node_text_->empty() ? std::string(prefix) + node_name_of(id()) : *node_text_;
  if (auto valid = segue::ros2::dds_topic_name(text); !valid) {
    return fail(ErrorCode::InvalidArgument,
                quote(text) +
                    " is not a valid name of a node: expected letters, digits and '_', with '/' between "
                    "namespaces; set the property 'node'");
  }
  const std::size_t slash = text.rfind('/');
  const bool in_root = slash == std::string::npos || slash == 0;
  node_ = {
      in_root ? "/" : text.substr(0, slash), text.substr(slash == std::string::npos ? 0 : slash + 1), {}, {}};
  if (!node_.name_space.starts_with('/')) node_.name_space.insert(0, "/");
  return {};
}

segue::Result<void> NodeTask::join(std::string_view prefix) {
  if (auto named = name_node(prefix); !named) return named;
  auto settings = wanted_settings();
  if (!settings) return settings.error();
  auto joined = Participant::join(*settings);
  if (!joined) {
    if (joined.error().code == ErrorCode::Unavailable) exception(segue::to_string(joined.error()));
    return joined.error();
  }
  participant_ = *joined;
  const segue::Lock lock(shared_mutex_);
  shared_participant_ = participant_;
  return {};
}

void NodeTask::announce(std::vector<segue::ros2::Gid> publishers,
                        std::vector<segue::ros2::Gid> subscriptions) {
  node_.publishers = std::move(publishers);
  node_.subscriptions = std::move(subscriptions);
  participant_->announce(node_);
}

void NodeTask::withdraw() {
  participant_->withdraw(node_);
}

void NodeTask::leave() {
  {
    const segue::Lock lock(shared_mutex_);
    shared_participant_.reset();
  }
  participant_.reset();
}

segue::ros2::InterfaceLibrary NodeTask::library() const {
  return segue::ros2::InterfaceLibrary({interfaces_->begin(), interfaces_->end()});
}

std::shared_ptr<Participant> NodeTask::shared_participant() const {
  const segue::Lock lock(shared_mutex_);
  return shared_participant_;
}

}  // namespace ros2
