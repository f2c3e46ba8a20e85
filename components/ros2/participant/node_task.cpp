// SPDX-License-Identifier: Apache-2.0
#include "node_task.hpp"
#include "settings.hpp"

#include <segue/base/text.hpp>
#include <segue/ros2/dds_names.hpp>

#include <algorithm>
#include <string_view>
#include <utility>

namespace ros2 {
namespace {

using segue::ErrorCode;
using segue::fail;
using segue::quote;

}  // namespace

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
  auto settings = settings_from(*domain_, *discovery_, *static_peers_);
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
  // Where Fast DDS could not start, cleanup follows all the same.
  if (participant_ != nullptr) participant_->withdraw(node_);
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
