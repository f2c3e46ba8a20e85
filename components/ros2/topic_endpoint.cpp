// SPDX-License-Identifier: Apache-2.0
#include "topic_endpoint.hpp"

#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/ros2/dds_names.hpp>

#include <algorithm>
#include <utility>

namespace ros2 {
namespace {

using segue::ErrorCode;
using segue::fail;
using segue::quote;

}  // namespace

TopicEndpoint::TopicEndpoint(segue::task::Direction direction, const std::string& port,
                             const segue::task::ComponentOptions& options)
    : NodeTask(options) {
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

segue::Result<void> TopicEndpoint::open() {
  auto quality = wanted_quality();
  if (!quality) return quality.error();
  auto topic = segue::ros2::dds_topic_name(*topic_text_);
  if (!topic) return topic.error();
  segue::ros2::InterfaceLibrary interfaces = library();
  auto message = segue::ros2::MessageCodec::of(interfaces, *type_text_);
  if (!message) return message.error();
  if (auto joined = join(); !joined) return joined;
  own_.topic = *topic;
  own_.type = message->dds_type();
  own_.type_hash = message->type_hash();
  codec_ = std::move(*message);
  own_.quality = *quality;
  matched_ = 0;
  missed_ = 0;
  return {};
}

void TopicEndpoint::watch(const segue::ros2::Gid& endpoint) {
  if (own_.publishes) {
    announce({endpoint}, {});
  } else {
    announce({}, {endpoint});
  }
  {
    const segue::Lock lock(others_mutex_);
    shown_ = own_;
  }
  participant().watch(this, [this] { check_others(); });
  check_others();
}

void TopicEndpoint::stop_watching() {
  participant().stop_watching(this);
  withdraw();
  const segue::Lock lock(others_mutex_);
  shown_.reset();
  said_.clear();
}

void TopicEndpoint::missed(const std::string& what, std::uint32_t times) {
  if (times == 0) return;
  missed_ += times;
  segue::log(segue::LogLevel::Warning, id(), what + " on " + segue::ros2::topic_of_dds_name(own_.topic));
}

std::vector<segue::ros2::Mismatch> TopicEndpoint::mismatches() const {
  const auto joined = shared_participant();
  segue::Lock lock(others_mutex_);
  const std::optional<segue::ros2::Endpoint> shown = shown_;
  lock.unlock();
  if (joined == nullptr || !shown) return {};
  return joined->graph().mismatches_of(*shown);
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
  constexpr std::size_t kMostSaid = 20;  // somebody may bring a thousand
  std::vector<std::string> found;
  for (segue::ros2::Mismatch& one : mismatches()) {
    if (one.is_named) found.push_back(std::move(one.text));
  }
  const segue::Lock lock(others_mutex_);
  if (found.empty()) said_.clear();
  for (const std::string& one : found) {
    if (said_.size() >= kMostSaid || !said_.insert(one).second) continue;
    segue::log(segue::LogLevel::Warning, id(), one);
    if (said_.size() == kMostSaid)
      segue::log(segue::LogLevel::Warning, id(), "others do not fit, too: the operation mismatches has them");
  }
}

}  // namespace ros2
