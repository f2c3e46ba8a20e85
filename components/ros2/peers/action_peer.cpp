// SPDX-License-Identifier: Apache-2.0
#include "action_peer.hpp"

#include <support/eventually.hpp>

#include <gtest/gtest.h>

#include <vector>

namespace ros2::testing {

using segue::testing::eventually;
using segue::type::Value;

namespace {

const Bytes kOneByte = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}, std::byte{1}};

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

ActionPeer::ActionPeer(const std::function<std::unique_ptr<Peer>()>& make_peer,
                       const std::filesystem::path& folder)
    : codecs_(folder, kCount), send_goal_(make_peer()), cancel_(make_peer()), get_result_(make_peer()) {
  serve();
}

void ActionPeer::serve() {
  serve_count(*send_goal_, *cancel_, *get_result_, kCount);
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
  return next(*send_goal_, codecs_.goal_request);
}

ActionPeer::Asked ActionPeer::next_cancel() {
  return next(*cancel_, codecs_.cancel_request);
}

ActionPeer::Asked ActionPeer::next_result_request() {
  return next(*get_result_, codecs_.result_request);
}

void ActionPeer::answer_goal(const Asked& goal, bool accepts) {
  respond_when_matched(*send_goal_, goal.request,
                       codecs_.goal_response.encode(Value::map({{"accepted", accepts}}), "").value());
}

void ActionPeer::answer_goal_malformed(const Asked& goal) {
  respond_when_matched(*send_goal_, goal.request, kOneByte);
}

void ActionPeer::answer_cancel(const Asked& cancel, int code) {
  respond_when_matched(*cancel_, cancel.request,
                       codecs_.cancel_response.encode(Value::map({{"return_code", code}}), "").value());
}

void ActionPeer::answer_result(const Asked& result, int status, int reached) {
  const Value value =
      Value::map({{"status", status}, {"result", Value::map({{"reached", reached}, {"words", "done"}})}});
  respond_when_matched(*get_result_, result.request, codecs_.result_response.encode(value, "").value());
}

void ActionPeer::answer_result_malformed(const Asked& result) {
  respond_when_matched(*get_result_, result.request, kOneByte);
}

void ActionPeer::tell_feedback(const Value& id, int now) {
  const Value value =
      Value::map({{"goal_id", id}, {"feedback", Value::map({{"now", now}, {"words", "on"}})}});
  send_goal_->publish(codecs_.feedback.encode(value, "").value());
}

void ActionPeer::tell_malformed_feedback(const Value& id) {
  Bytes message = codecs_.feedback.encode(Value::map({{"goal_id", id}}), "").value();
  message.resize(4 + 16 + 2);
  send_goal_->publish(message);
  message.resize(7);
  send_goal_->publish(message);
}

void ActionPeer::tell_status(const Value& id, int status) {
  const Value one = Value::map({{"goal_info", Value::map({{"goal_id", id}})}, {"status", status}});
  cancel_->publish(codecs_.status.encode(Value::map({{"status_list", Value::list({one})}}), "").value());
}

}  // namespace ros2::testing
