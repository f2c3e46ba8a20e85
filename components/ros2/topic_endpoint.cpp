// SPDX-License-Identifier: Apache-2.0
#include "topic_endpoint.hpp"

#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/ros2/dds_names.hpp>
#include <segue/ros2/interface_library.hpp>
#include <segue/ros2/message_type.hpp>
#include <segue/ros2/type_hash.hpp>
#include <segue/type/made_type.hpp>
#include <segue/type/type.hpp>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string_view>

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

TopicEndpoint::TopicEndpoint(segue::task::Direction direction, const std::string& port,
                             const segue::task::ComponentOptions& options)
    : Component(options) {
  own_.publishes = direction == segue::task::Direction::Input;
  dynamic_ports(direction, port, "its type is the property type");
}

segue::Result<segue::ros2::Quality> TopicEndpoint::wanted_quality() const {
  auto reliability = segue::ros2::parse_reliability(*reliability_);
  if (!reliability) return reliability.error();
  auto durability = segue::ros2::parse_durability(*durability_);
  if (!durability) return durability.error();
  auto liveliness = segue::ros2::parse_liveliness(*liveliness_);
  if (!liveliness) return liveliness.error();
  if (deadline_->count() < 0 || lease_->count() < 0)
    return fail(ErrorCode::InvalidArgument, "deadline and lease must not be negative");
  return segue::ros2::Quality{*reliability, *durability, *depth_, *deadline_, {}, *liveliness, *lease_};
}

segue::Result<void> TopicEndpoint::find_type() {
  segue::ros2::InterfaceLibrary library({interfaces_->begin(), interfaces_->end()});
  auto hash = segue::ros2::type_hash(library, *type_text_);
  if (!hash) return hash.error();
  segue::type::TypeRegistry registry;
  auto type = segue::ros2::message_type(library, *type_text_, registry);
  if (!type) return type.error();
  auto defaults = segue::ros2::message_defaults(library, *type_text_);
  if (!defaults) return defaults.error();
  auto info = segue::type::make_type_info(**type, *defaults);
  if (!info) return info.error();
  auto bounds = segue::ros2::MessageBounds::of(library, *type_text_);
  if (!bounds) return bounds.error();
  type_ = *info;
  bounds_ = std::move(*bounds);
  own_.type_hash = *hash;
  own_.type = segue::ros2::dds_type_name(to_string(*segue::ros2::parse_interface_name(*type_text_)));
  return {};
}

segue::Result<Settings> TopicEndpoint::wanted_settings() const {
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

segue::Result<void> TopicEndpoint::name_node() {
  const std::string text = node_text_->empty() ? node_name_of(id()) : *node_text_;
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

segue::Result<void> TopicEndpoint::open() {
  auto quality = wanted_quality();
  if (!quality) return quality.error();
  auto topic = segue::ros2::dds_topic_name(*topic_text_);
  if (!topic) return topic.error();
  if (auto found = find_type(); !found) return found;
  if (auto named = name_node(); !named) return named;
  auto settings = wanted_settings();
  if (!settings) return settings.error();
  auto joined = Participant::join(*settings);
  if (!joined) {
    if (joined.error().code == ErrorCode::Unavailable) exception(segue::to_string(joined.error()));
    return joined.error();
  }
  own_.topic = *topic;
  own_.quality = *quality;
  participant_ = *joined;
  matched_ = 0;
  missed_ = 0;
  const segue::Lock lock(shared_mutex_);
  shared_participant_ = participant_;
  return {};
}

void TopicEndpoint::announce(const segue::ros2::Gid& endpoint) {
  (own_.publishes ? node_.publishers : node_.subscriptions) = {endpoint};
  participant_->announce(node_);
  participant_->watch(this, [this] { check_others(); });
  check_others();
}

void TopicEndpoint::withdraw() {
  participant_->stop_watching(this);
  participant_->withdraw(node_);
}

void TopicEndpoint::close() {
  {
    const segue::Lock lock(shared_mutex_);
    shared_participant_.reset();
    said_.clear();
  }
  participant_.reset();
}

void TopicEndpoint::missed(const std::string& what, std::uint32_t times) {
  if (times == 0) return;
  missed_ += times;
  segue::log(segue::LogLevel::Warning, id(), what + " on " + segue::ros2::topic_of_dds_name(own_.topic));
}

std::vector<segue::ros2::Mismatch> TopicEndpoint::mismatches() const {
  const segue::Lock lock(shared_mutex_);
  if (shared_participant_ == nullptr) return {};
  return shared_participant_->graph().mismatches_of(own_);
}

std::vector<std::string> TopicEndpoint::mismatch_texts() const {
  std::vector<std::string> texts;
  for (segue::ros2::Mismatch& one : mismatches())
    texts.push_back(std::move(one.text));
  return texts;
}

std::uint32_t TopicEndpoint::mismatched() const {
  return static_cast<std::uint32_t>(mismatches().size());
}

void TopicEndpoint::check_others() {
  std::vector<std::string> found;
  for (segue::ros2::Mismatch& one : mismatches()) {
    if (one.is_named) found.push_back(std::move(one.text));
  }
  const segue::Lock lock(shared_mutex_);
  for (const std::string& one : found) {
    if (std::ranges::find(said_, one) == said_.end()) segue::log(segue::LogLevel::Warning, id(), one);
  }
  said_ = std::move(found);
}

}  // namespace ros2
