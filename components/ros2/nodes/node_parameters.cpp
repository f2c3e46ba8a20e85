// SPDX-License-Identifier: Apache-2.0
#include "node_parameters.hpp"

#include <segue/ros2/parameter_value.hpp>
#include <segue/type/json.hpp>

#include <utility>

namespace ros2 {

using segue::Result;
using segue::type::Value;

Result<void> NodeParameters::want(const Value& parameters) {
  auto request = segue::ros2::parameters_request(parameters, "parameters");
  if (!request) return request.error();
  request_ = std::move(*request);
  return {};
}

bool NodeParameters::empty() const {
  const Value* parameters = request_.find("parameters");
  return parameters == nullptr || parameters->as_list().empty();
}

Result<void> NodeParameters::watch(const std::shared_ptr<Participant>& participant, const std::string& node) {
  if (watch_ || empty()) return {};
  auto watch = ParameterWatch::make(participant, node);
  if (!watch) return watch.error();
  watch_ = std::move(*watch);
  return {};
}

Result<void> NodeParameters::open(const std::shared_ptr<Participant>& participant, const std::string& node) {
  if (client_) return {};
  auto client = ParameterClient::make(participant, node);
  if (!client) return client.error();
  client_ = std::move(*client);
  return {};
}

void NodeParameters::close() {
  client_.reset();
  watch_.reset();
  changed_before_.clear();
  said_.clear();
}

Result<void> NodeParameters::set(segue::TimePoint deadline) {
  auto done = client_->set(request_, deadline);
  if (done) expect();
  return done;
}

void NodeParameters::expect() {
  if (watch_) watch_->expect(request_);
}

std::vector<std::string> NodeParameters::changed() const {
  std::vector<std::string> texts;
  if (!watch_) return texts;
  for (const auto& [name, expected, now] : watch_->differences()) {
    texts.push_back(name + (now.is_null() ? " is not set" : " is " + segue::type::to_json(now, -1)) +
                    ", not " + segue::type::to_json(expected, -1));
  }
  return texts;
}

std::vector<std::string> NodeParameters::newly_changed() {
  std::vector<std::string> found;
  std::set<std::string> now;
  for (std::string& text : changed()) {
    if (changed_before_.contains(text) && said_.insert(text).second) found.push_back(text);
    now.insert(std::move(text));
  }
  std::erase_if(said_, [&now](const std::string& text) { return !now.contains(text); });
  changed_before_ = std::move(now);
  return found;
}

void NodeParameters::add_gids(std::vector<segue::ros2::Gid>& publishers,
                              std::vector<segue::ros2::Gid>& subscriptions) const {
  if (watch_) subscriptions.push_back(watch_->gid());
  if (!client_) return;
  publishers.push_back(client_->requester().publisher());
  subscriptions.push_back(client_->requester().subscription());
}

}  // namespace ros2
