// SPDX-License-Identifier: Apache-2.0
#include "node_parameters.hpp"

#include <segue/ros2/parameter_value.hpp>
#include <segue/type/json.hpp>

#include <cstddef>
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
  node_ = node;
  auto client = ParameterClient::make(participant, node);
  if (!client) return client.error();
  client_ = std::move(*client);
  return {};
}

void NodeParameters::close() {
  client_.reset();
  watch_.reset();
  for (const auto& [name, value] : set_)
    let_go(name);
  set_.clear();
  kept_.clear();
  changed_before_.clear();
  said_.clear();
}

void NodeParameters::let_go(const std::string& parameter) {
  FoundParameters::of_this_process().let_go(this, named(parameter));
}

NodeParameters::Values NodeParameters::wanted() const {
  Values values;
  const Value* list = request_.find("parameters");
  for (const Value& one : list == nullptr ? Value::List() : list->as_list())
    values.insert_or_assign(one.find("name")->as_string(), *one.find("value"));
  return values;
}

Result<void> NodeParameters::note_found(const Values& wanted, segue::TimePoint deadline) {
  FoundParameters& found = FoundParameters::of_this_process();
  std::vector<std::string> names;
  for (const auto& [name, value] : wanted) {
    if (!set_.contains(name) && !found.knows(named(name))) names.push_back(name);
  }
  auto told = client_->get(names, deadline);
  if (!told) return told.error();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool is_set = !told->at(i).is_null() && !segue::ros2::parameter_from(told->at(i)).is_null();
    found.note(this, named(names[i]), is_set ? std::move(told->at(i)) : Value());
  }
  for (const auto& [name, value] : wanted) {
    if (found.knows(named(name))) found.note(this, named(name), Value());
  }
  return {};
}

Result<NodeParameters::Values> NodeParameters::former(const Values& wanted, segue::TimePoint deadline) {
  kept_.clear();
  Values values;
  std::vector<std::string> names;
  for (const auto& [name, value] : set_) {
    if (wanted.contains(name)) continue;
    if (!FoundParameters::of_this_process().knows(named(name))) kept_.push_back(name);
    auto found = FoundParameters::of_this_process().find(this, named(name));
    if (!found) continue;
    values.emplace(name, std::move(*found));
    names.push_back(name);
  }
  auto now = client_->get(names, deadline);
  if (!now) return now.error();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Value& one = now->at(i);
    const bool is_as_set =
        !one.is_null() && segue::ros2::parameter_from(one) == segue::ros2::parameter_from(set_.at(names[i]));
    if (!is_as_set) values.erase(names[i]);
  }
  return values;
}

Result<void> NodeParameters::set(segue::TimePoint deadline) {
  const Values values = wanted();
  auto done = set(values, deadline);
  if (done) {
    have_set(values);
    return done;
  }
  for (const auto& [name, value] : values) {
    if (!set_.contains(name)) let_go(name);
  }
  return done;
}

Result<void> NodeParameters::set(const Values& wanted, segue::TimePoint deadline) {
  if (auto noted = note_found(wanted, deadline); !noted) return noted;
  auto others = former(wanted, deadline);
  if (!others) return others.error();
  Value::List parameters;
  if (!wanted.empty()) parameters = request_.find("parameters")->as_list();
  for (const auto& [name, value] : *others)
    parameters.push_back(Value::map({{"name", name}, {"value", value}}));
  if (parameters.empty()) return {};
  return client_->set(Value::map({{"parameters", Value(std::move(parameters))}}), deadline);
}

void NodeParameters::have_set(Values wanted) {
  for (const auto& [name, value] : set_) {
    if (!wanted.contains(name)) let_go(name);
  }
  set_ = std::move(wanted);
  if (watch_) watch_->expect(request_);
}

Result<void> NodeParameters::give_back(segue::TimePoint deadline) {
  if (!client_ || set_.empty()) return {};
  request_ = Value::map({{"parameters", Value(Value::List())}});
  return set(deadline);
}

void NodeParameters::were_given() {
  have_set(wanted());
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
  for (const Requester* requester : client_->requesters()) {
    publishers.push_back(requester->publisher());
    subscriptions.push_back(requester->subscription());
  }
}

}  // namespace ros2
