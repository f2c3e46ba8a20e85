// SPDX-License-Identifier: Apache-2.0
#include "action_peer.hpp"

#include <support/eventually.hpp>

#include <gtest/gtest.h>

#include <fstream>
#include <vector>

namespace ros2::testing {

using segue::testing::eventually;
using segue::type::Value;

namespace {

const Bytes kOneByte = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}, std::byte{1}};
constexpr const char* kCount =
    "int32 target\n---\nint64 reached\nstring words\n---\nint32 now\nstring words\n";

/// As servers of both middlewares wait for it, since a response that is sent before would be lost.
void respond_when_matched(Peer& peer, const Request& request, const Bytes& response) {
  EXPECT_TRUE(eventually([&] { return peer.clients() > 0; }));
  peer.respond(request, response);
}

ActionPeer::Asked asked_by(const Request& request, const segue::ros2::MessageCodec& codec) {
  ActionPeer::Asked asked{request, codec.decode(request.message).value(), {}};
  const Value* goal = asked.value.find("goal_info");
  asked.id = *(goal == nullptr ? asked.value : *goal).find("goal_id");
  return asked;
}

}  // namespace

void ActionPeer::define(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder / "test_msgs/action");
  std::ofstream(folder / "test_msgs/action/Count.action") << kCount;
}

ActionPeer::ActionPeer(const std::function<std::unique_ptr<Peer>()>& make_peer,
                       const std::filesystem::path& folder)
    : library_({folder}), send_goal_(make_peer()), cancel_(make_peer()), get_result_(make_peer()) {
  serve();
}

segue::ros2::MessageCodec ActionPeer::codec(const std::string& message) {
  return segue::ros2::MessageCodec::of(library_, message).value();
}

void ActionPeer::serve() {
  send_goal_->serve("/count/_action/send_goal", "test_msgs/action/Count_SendGoal");
  cancel_->serve("/count/_action/cancel_goal", "action_msgs/srv/CancelGoal");
  get_result_->serve("/count/_action/get_result", "test_msgs/action/Count_GetResult");
  send_goal_->advertise({"/count/_action/feedback", "test_msgs/action/Count_FeedbackMessage", "", {}});
  segue::ros2::Quality latched;
  latched.durability = segue::ros2::Durability::TransientLocal;
  latched.depth = 1;
  cancel_->advertise({"/count/_action/status", "action_msgs/msg/GoalStatusArray", "", latched});
}

void ActionPeer::leave() {
  for (Peer* peer : {send_goal_.get(), cancel_.get(), get_result_.get()})
    peer->stop_serving();
}

ActionPeer::Asked ActionPeer::next(Peer& peer, const segue::ros2::MessageCodec& codec) {
  std::vector<Request> all;
  EXPECT_TRUE(eventually([&] { return !(all = peer.requests()).empty(); }));
  return all.empty() ? Asked{} : asked_by(all.front(), codec);
}

ActionPeer::Asked ActionPeer::next_goal() {
  return next(*send_goal_, goal_request_);
}

ActionPeer::Asked ActionPeer::next_cancel() {
  return next(*cancel_, cancel_request_);
}

ActionPeer::Asked ActionPeer::next_result_request() {
  return next(*get_result_, result_request_);
}

void ActionPeer::answer_goal(const Asked& goal, bool accepts) {
  respond_when_matched(*send_goal_, goal.request,
                       goal_response_.encode(Value::map({{"accepted", accepts}}), "").value());
}

void ActionPeer::answer_goal_malformed(const Asked& goal) {
  respond_when_matched(*send_goal_, goal.request, kOneByte);
}

void ActionPeer::answer_cancel(const Asked& cancel, int code) {
  respond_when_matched(*cancel_, cancel.request,
                       cancel_response_.encode(Value::map({{"return_code", code}}), "").value());
}

void ActionPeer::answer_result(const Asked& result, int status, int reached) {
  const Value value =
      Value::map({{"status", status}, {"result", Value::map({{"reached", reached}, {"words", "done"}})}});
  respond_when_matched(*get_result_, result.request, result_response_.encode(value, "").value());
}

void ActionPeer::answer_result_malformed(const Asked& result) {
  respond_when_matched(*get_result_, result.request, kOneByte);
}

void ActionPeer::tell_feedback(const Value& id, int now) {
  const Value value =
      Value::map({{"goal_id", id}, {"feedback", Value::map({{"now", now}, {"words", "on"}})}});
  send_goal_->publish(feedback_message_.encode(value, "").value());
}

void ActionPeer::tell_malformed_feedback(const Value& id) {
  Bytes message = feedback_message_.encode(Value::map({{"goal_id", id}}), "").value();
  message.resize(4 + 16 + 2);
  send_goal_->publish(message);
  message.resize(7);
  send_goal_->publish(message);
}

void ActionPeer::tell_status(const Value& id, int status) {
  const Value one = Value::map({{"goal_info", Value::map({{"goal_id", id}})}, {"status", status}});
  cancel_->publish(status_message_.encode(Value::map({{"status_list", Value::list({one})}}), "").value());
}

}  // namespace ros2::testing
