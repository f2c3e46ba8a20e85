// SPDX-License-Identifier: Apache-2.0
#include "action_client_peer.hpp"

#include <support/eventually.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

namespace ros2::testing {

using segue::testing::eventually;
using segue::type::Value;

ActionClientPeer::ActionClientPeer(const std::function<std::unique_ptr<Peer>()>& make_peer,
                                   const std::filesystem::path& folder)
    : codecs_(folder, kCount), goals_{make_peer()}, cancels_{make_peer()}, results_{make_peer()} {
  use_count(*goals_.peer, *cancels_.peer, *results_.peer);
}

bool ActionClientPeer::is_served() {
  return goals_.peer->servers() == 1 && cancels_.peer->servers() == 1 && results_.peer->servers() == 1 &&
         goals_.peer->publishers() == 1 && cancels_.peer->publishers() == 1;
}

const std::map<std::int64_t, Bytes>& ActionClientPeer::Service::take() {
  for (Response& one : peer->responses())
    responses[one.number] = std::move(one.message);
  return responses;
}

Bytes ActionClientPeer::Service::response_to(std::int64_t request) {
  EXPECT_TRUE(eventually([&] { return take().contains(request); })) << "no response";
  return std::exchange(responses[request], {});
}

Bytes ActionClientPeer::goal_request(const Id& id, int target) const {
  return codecs_.goal_request
      .encode(Value::map({{"goal_id", id}, {"goal", Value::map({{"target", target}})}}), "")
      .value();
}

bool ActionClientPeer::send(const Id& id, int target) {
  const auto response = goals_.response_to(goals_.peer->ask(goal_request(id, target)));
  return codecs_.goal_response.decode(response).value().find("accepted")->as_bool();
}

ActionClientPeer::Canceled ActionClientPeer::cancel(const Id& id, int seconds) {
  const Value info = Value::map({{"goal_id", id}, {"stamp", Value::map({{"sec", seconds}})}});
  const auto request = codecs_.cancel_request.encode(Value::map({{"goal_info", info}}), "").value();
  const auto response = codecs_.cancel_response.decode(cancels_.response_to(cancels_.peer->ask(request)));
  Canceled canceled{static_cast<int>(response.value().find("return_code")->as_int()), {}};
  for (const Value& goal : response.value().find("goals_canceling")->as_list())
    canceled.goals.push_back(*goal.find("goal_id"));
  return canceled;
}

std::int64_t ActionClientPeer::ask_for_result(const Id& id) {
  return results_.peer->ask(codecs_.result_request.encode(Value::map({{"goal_id", id}}), "").value());
}

ActionClientPeer::Result ActionClientPeer::result(std::int64_t request) {
  const auto response = codecs_.result_response.decode(results_.response_to(request)).value();
  return {static_cast<int>(response.find("status")->as_int()),
          response.find("result")->find("reached")->as_int()};
}

std::vector<int> ActionClientPeer::feedback(const Id& id) {
  for (const Bytes& message : goals_.peer->take())
    feedback_.push_back(codecs_.feedback.decode(message).value());
  std::vector<int> all;
  for (const Value& one : feedback_) {
    if (*one.find("goal_id") == id)
      all.push_back(static_cast<int>(one.find("feedback")->find("now")->as_int()));
  }
  return all;
}

int ActionClientPeer::status(const Id& id) {
  for (const Bytes& message : cancels_.peer->take())
    status_ = codecs_.status.decode(message).value();
  if (!status_) return 0;
  for (const Value& one : status_->find("status_list")->as_list()) {
    if (*one.find("goal_info")->find("goal_id") == id) return static_cast<int>(one.find("status")->as_int());
  }
  return 0;
}

void ActionClientPeer::send_to_all(const Bytes& request) {
  for (const Service* service : {&goals_, &cancels_, &results_})
    service->peer->ask(request);
}

}  // namespace ros2::testing
