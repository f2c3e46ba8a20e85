// SPDX-License-Identifier: Apache-2.0
#include "topic_endpoint.hpp"

#include <segue/base/log.hpp>
#include <segue/ros2/dds_names.hpp>

#include <utility>

namespace ros2 {
namespace {

segue::Result<segue::ros2::Quality> quality_of(const TopicSettings& settings) {
  auto reliability = segue::ros2::parse_reliability(settings.reliability);
  if (!reliability) return reliability.error();
  auto durability = segue::ros2::parse_durability(settings.durability);
  if (!durability) return durability.error();
  auto liveliness = segue::ros2::parse_liveliness(settings.liveliness);
  if (!liveliness) return liveliness.error();
  if (settings.deadline.count() < 0 || settings.lease.count() < 0)
    return segue::fail(segue::ErrorCode::InvalidArgument, "deadline and lease must not be negative");
  if (settings.lifespan.count() < 0)
    return segue::fail(segue::ErrorCode::InvalidArgument, "lifespan must not be negative");
  return segue::ros2::Quality{*reliability,      *durability, settings.depth, settings.deadline,
                              settings.lifespan, *liveliness, settings.lease};
}

}  // namespace

segue::Result<TopicEndpoint::Facts> TopicEndpoint::check(const TopicSettings& settings, bool publishes,
                                                         segue::ros2::InterfaceLibrary& library) {
  auto quality = quality_of(settings);
  if (!quality) return quality.error();
  auto topic = segue::ros2::dds_topic_name(settings.topic);
  if (!topic) return topic.error();
  auto codec = segue::ros2::MessageCodec::of(library, settings.type);
  if (!codec) return codec.error();
  segue::ros2::Endpoint own{{}, publishes, *topic, codec->dds_type(), codec->type_hash(), *quality};
  return Facts{std::move(*codec), std::move(own)};
}

TopicEndpoint::TopicEndpoint(std::shared_ptr<Participant> participant, TopicPort port, Facts facts)
    : participant_(std::move(participant)),
      port_(std::move(port)),
      codec_(std::move(facts.codec)),
      own_(std::move(facts.own)) {}

std::string TopicEndpoint::topic() const {
  return segue::ros2::topic_of_dds_name(own_.topic);
}

std::string TopicEndpoint::topic_of_port() const {
  return "topic " + topic() + " of ROS 2 (domain " + std::to_string(participant_->settings().domain) + ")";
}

void TopicEndpoint::watch() {
  participant_->watch(this, [this] { changed(); });
  changed();
}

void TopicEndpoint::missed(const std::string& what, std::uint32_t times) {
  if (times == 0) return;
  missed_ += times;
  segue::log(segue::LogLevel::Warning, port_.task, what + " on " + topic());
}

std::vector<segue::ros2::Mismatch> TopicEndpoint::find_mismatches() const {
  return participant_->graph().mismatches_of(own_);
}

std::vector<std::string> TopicEndpoint::mismatches() const {
  std::vector<std::string> texts;
  for (segue::ros2::Mismatch& one : find_mismatches())
    texts.push_back(std::move(one.text));
  return texts;
}

void TopicEndpoint::changed() {
  constexpr std::size_t kMostSaid = 20;  // somebody may bring a thousand
  std::vector<std::string> found;
  for (segue::ros2::Mismatch& one : find_mismatches()) {
    if (one.is_named) found.push_back(std::move(one.text));
  }
  const segue::Lock lock(said_mutex_);
  if (found.empty()) said_.clear();
  for (const std::string& one : found) {
    if (said_.size() >= kMostSaid || !said_.insert(one).second) continue;
    segue::log(segue::LogLevel::Warning, port_.task, one);
    if (said_.size() == kMostSaid)
      segue::log(segue::LogLevel::Warning, port_.task,
                 "others do not fit, too: the operation mismatches has them");
  }
}

}  // namespace ros2
