// SPDX-License-Identifier: Apache-2.0
#include "served_action.hpp"
#include "../topics/sample_source.hpp"

#include <segue/base/clock.hpp>
#include <segue/concurrent/thread.hpp>
#include <segue/ros2/dds_names.hpp>

#include <algorithm>
#include <chrono>
#include <utility>

namespace ros2 {
namespace {

using segue::task::SampleRef;
using segue::task::SampleSlot;
using segue::type::Value;

/// Requests of each kind that wait for the thread, and requests for results that have not come yet.
constexpr std::size_t kMostRequests = 32;
constexpr std::uint32_t kMostResultRequests = 100;
/// How long a client is waited for that does not get responses yet, and how often it is looked for; an idle
/// thread looks around as seldom.
constexpr std::chrono::seconds kWaitsForClients{1};
constexpr std::chrono::milliseconds kLooksForClients{1};

constexpr std::array kEnds = {GoalState::Succeeded, GoalState::Canceled, GoalState::Aborted};

/// Feedback with the identifier of its goal.
class FeedbackSource final : public MessageSource {
 public:
  FeedbackSource(const segue::ros2::MessageCodec& feedback, const SampleSlot& sample, const GoalId& id)
      : feedback_(feedback, sample), id_(id) {}
  [[nodiscard]] std::size_t size() const noexcept override {
    return feedback_.size() == 0 ? 0 : feedback_.size() + id_.size();
  }
  bool write(std::span<std::byte> bytes) const noexcept override {
    if (!feedback_.write(bytes.subspan(id_.size()))) return false;
    put_goal_id(id_, bytes);
    return true;
  }

 private:
  const SampleSource feedback_;
  const GoalId id_;
};

std::int64_t wall_clock() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

Value result_response(GoalState state, const Value& result) {
  Value response = Value::map({{"status", static_cast<int>(state)}});
  if (!result.is_null()) response.as_map().append("result", result);
  return response;
}

}  // namespace

segue::Result<std::unique_ptr<ServedAction>> ServedAction::make(
    std::shared_ptr<Participant> participant, segue::ros2::InterfaceLibrary& library,
    const std::string& action, const std::string& interface, const ServingRules& rules, GoalWorker& worker) {
  auto messages = ActionMessages::of(library, action, interface);
  if (!messages) return messages.error();
  std::unique_ptr<ServedAction> made(
      new ServedAction(std::move(participant), std::move(*messages), rules, worker));
  if (auto opened = made->open(library); !opened) return opened.error();
  return made;
}

ServedAction::ServedAction(std::shared_ptr<Participant> participant, ActionMessages messages,
                           const ServingRules& rules, GoalWorker& worker)
    : participant_(std::move(participant)), messages_(std::move(messages)), rules_(rules), worker_(worker) {}

segue::Result<void> ServedAction::open(segue::ros2::InterfaceLibrary& library) {
  if (auto opened = waker_.open(); !opened) return opened;
  auto feedback = make_writer(messages_.feedback_topic(), messages_.feedback_message, {});
  if (!feedback) return feedback.error();
  feedback_out_ = std::move(*feedback);
  auto status = make_writer(messages_.status_topic(), messages_.status, ActionMessages::status_quality());
  if (!status) return status.error();
  status_out_ = std::move(*status);
  const std::array services = {messages_.send_goal(), messages_.cancel_goal(), messages_.get_result()};
  for (std::size_t i = 0; i < services.size(); ++i) {
    auto made = Responder::make(
        participant_, library, services.at(i).name, services.at(i).interface,
        [this, i](const Caller& caller, std::vector<std::byte> message) {
          receive(static_cast<Service>(i), caller, std::move(message));
        },
        kMostResultRequests);
    if (!made) return made.error();
    responders_.at(i) = std::move(*made);
  }
  thread_ = segue::concurrent::start_thread("segue-goals", [this] { serve(); });
  return {};
}

segue::Result<Participant::Owned<dds::DataWriter>> ServedAction::make_writer(
    const std::string& topic, const segue::ros2::MessageCodec& message, const segue::ros2::Quality& quality) {
  auto name = segue::ros2::dds_topic_name(topic);
  if (!name) return name.error();
  return participant_->make_writer({*name, message.dds_type()}, quality,
                                   "typehash=" + message.type_hash() + ";", nullptr);
}

ServedAction::~ServedAction() {
  {
    const segue::Lock lock(mutex_);
    leaves_ = true;
  }
  waker_.wake();
  if (thread_.joinable()) thread_.join();
}

std::vector<segue::ros2::Gid> ServedAction::publishers() const {
  std::vector<segue::ros2::Gid> all = {gid_of(feedback_out_->guid()), gid_of(status_out_->guid())};
  for (const auto& one : responders_)
    all.push_back(one->publisher());
  return all;
}

std::vector<segue::ros2::Gid> ServedAction::subscriptions() const {
  std::vector<segue::ros2::Gid> all;
  for (const auto& one : responders_)
    all.push_back(one->subscription());
  return all;
}

void ServedAction::start() {
  const segue::Lock lock(mutex_);
  accepts_ = true;
}

void ServedAction::stop(segue::TimePoint deadline) {
  const segue::Lock lock(mutex_);
  accepts_ = false;
  is_quiet_ = false;
  waker_.wake();
  changed_.wait_until(mutex_, deadline, [&]() SEGUE_REQUIRES(mutex_) { return is_quiet_; });
}

void ServedAction::tell(const SampleSlot& feedback) {
  const auto id = current();
  if (!id) return count_unasked(1);
  FeedbackSource source(messages_.feedback, feedback, *id);
  const bool sent = feedback.value != nullptr && source.size() > 0 &&
                    feedback_out_->write(static_cast<MessageSource*>(&source));
  count(sent ? &ActionServerStatistics::feedback : &ActionServerStatistics::unsent);
}

bool ServedAction::end(GoalState how, SampleRef result) {
  if (!current()) {
    count_unasked(1);
    return false;
  }
  const auto* const which = std::ranges::find(kEnds, how);
  ends_.at(static_cast<std::size_t>(which - kEnds.begin())).give(std::move(result));
  waker_.wake();
  return true;
}

void ServedAction::receive(Service service, const Caller& caller, std::vector<std::byte> message) {
  const segue::Lock lock(mutex_);
  const auto waiting = std::ranges::count(requests_, service, &Request::service);
  if (waiting >= static_cast<std::ptrdiff_t>(kMostRequests)) {
    ++counts_.refused;
    return;
  }
  requests_.push_back({service, caller, std::move(message)});
  waker_.wake();
}

segue::TimePoint ServedAction::next_look() const {
  const auto now = segue::monotonic_now();
  if (!responses_.empty()) return now + kLooksForClients;
  return std::min(now + segue::Duration(kWaitsForClients), goals_.next_to_forget(rules_.keep_result));
}

void ServedAction::serve() {
  for (;;) {
    waker_.wait(next_look());
    std::deque<Request> requests;
    bool accepts = false;
    {
      const segue::Lock lock(mutex_);
      if (leaves_) return;
      requests.swap(requests_);
      accepts = accepts_;
    }
    take_ends();
    if (!accepts) end_all();
    for (const Request& request : requests)
      answer(request, accepts);
    send_responses();
    goals_.forget_results(segue::monotonic_now(), rules_.keep_result);
    const segue::Lock lock(mutex_);
    counts_.waiting = static_cast<std::uint32_t>(result_requests_.size());
    if (accepts || !responses_.empty()) continue;
    is_quiet_ = true;
    changed_.notify_all();
  }
}

void ServedAction::take_ends() {
  for (std::size_t i = 0; i < kEnds.size(); ++i) {
    const SampleRef sample = ends_.at(i).take();
    if (!sample) continue;
    ServedGoal* goal = goals_.out();
    if (goal == nullptr) {
      count_unasked(1);
      continue;
    }
    auto how = kEnds.at(i);
    if (how == GoalState::Canceled && goal->state != GoalState::Canceling) {
      worker_.goal_trouble("a goal that nobody has canceled ended as canceled; its client is told: aborted");
      how = GoalState::Aborted;
    }
    auto result = value_of(*sample.get());
    if (!result) {
      worker_.goal_trouble("the result cannot be sent, so the goal is aborted: " +
                           segue::to_string(result.error()));
      count(&ActionServerStatistics::unsent);
    }
    end(*goal, result ? how : GoalState::Aborted, result ? *result : Value());
  }
  begin_waiting();
}

segue::Result<Value> ServedAction::value_of(const SampleSlot& result) const {
  const auto message = cdr_of(messages_.result, result);
  if (!message.empty()) return messages_.result.decode(message);
  return segue::fail(segue::ErrorCode::InvalidArgument, "it is too large, or exceeds a bound of its message");
}

void ServedAction::answer(const Request& request, bool accepts) {
  switch (request.service) {
    case Service::SendGoal:
      return answer_goal(request, accepts);
    case Service::CancelGoal:
      return answer_cancel(request);
    case Service::GetResult:
      return answer_result(request);
  }
}

void ServedAction::answer_goal(const Request& request, bool accepts) {
  std::vector<std::byte> message;
  const auto id = split_goal_id(request.message, message);
  if (!id) return count(&ActionServerStatistics::corrupt);
  const bool is_busy = goals_.out() != nullptr;
  const bool is_possible = accepts && goals_.find(*id) == nullptr && (!is_busy || rules_.preempts);
  is_announcing_ = is_possible && !is_busy;
  auto take = GoalWorker::Take::Refused;
  if (is_possible) take = is_busy ? look_at(message) : worker_.take_goal(message);
  if (take == GoalWorker::Take::Taken) {
    if (is_busy) make_way();
    ServedGoal& goal = goals_.add(*id, wall_clock());
    count(&ActionServerStatistics::goals);
    respond(request, Value::map({{"accepted", true}, {"stamp", *ServedGoals::info_of(goal).find("stamp")}}));
    if (is_busy) {
      goal.message = std::move(message);
      publish_status();
    } else {
      set_out(goal);
    }
  } else if (take == GoalWorker::Take::Refused) {
    count(&ActionServerStatistics::rejected);
    respond(request, Value::map({{"accepted", false}}));
  } else {
    count(&ActionServerStatistics::corrupt);
  }
  is_announcing_ = false;
}

GoalWorker::Take ServedAction::look_at(std::span<const std::byte> goal) const {
  return messages_.goal.decode(goal) ? GoalWorker::Take::Taken : GoalWorker::Take::Corrupt;
}

void ServedAction::make_way() {
  if (ServedGoal* earlier = goals_.waiting(); earlier != nullptr) end(*earlier, GoalState::Canceled, Value());
  if (ServedGoal* out = goals_.out(); out->state == GoalState::Executing) cancel(*out);
}

void ServedAction::begin_waiting() {
  ServedGoal* next = goals_.waiting();
  if (next == nullptr || goals_.out() != nullptr) return;
  is_announcing_ = true;
  const auto message = std::exchange(next->message, {});
  if (worker_.take_goal(message) == GoalWorker::Take::Taken) {
    set_out(*next);
  } else {
    worker_.goal_trouble("a goal that waited finds no room in a connection, so it is aborted");
    end(*next, GoalState::Aborted, Value());
  }
  is_announcing_ = false;
}

void ServedAction::set_out(ServedGoal& goal) {
  goal.state = GoalState::Executing;
  set_current(goal.id);
  is_announcing_ = false;
  worker_.goal_changed(goal.state);
  publish_status();
}

void ServedAction::answer_cancel(const Request& request) {
  const auto asked = responder(Service::CancelGoal).request().decode(request.message);
  if (!asked) return count(&ActionServerStatistics::corrupt);
  const auto meant = goals_.meant_by(*asked);
  Value::List canceling;
  for (ServedGoal* goal : meant.goals) {
    if (cancel(*goal)) canceling.push_back(ServedGoals::info_of(*goal));
  }
  const bool refuses = !meant.goals.empty() && canceling.empty();
  const auto code = refuses ? CancelCode::Refuses : meant.code;
  if (!canceling.empty()) publish_status();
  respond(request, Value::map({{"return_code", static_cast<int>(code)},
                               {"goals_canceling", Value(std::move(canceling))}}));
}

bool ServedAction::cancel(ServedGoal& goal) {
  if (!rules_.cancelable) return false;
  if (goal.state == GoalState::Accepted) {
    end(goal, GoalState::Canceled, Value());
    return true;
  }
  if (!worker_.take_cancel()) return false;
  goal.state = GoalState::Canceling;
  worker_.goal_changed(goal.state);
  return true;
}

void ServedAction::answer_result(const Request& request) {
  std::vector<std::byte> rest;
  const auto id = split_goal_id(request.message, rest);
  if (!id) return count(&ActionServerStatistics::corrupt);
  const ServedGoal* goal = goals_.find(*id);
  if (goal != nullptr && !goal->response.empty())
    return respond(request.service, request.caller, goal->response);
  if (goal != nullptr && has_room_for_result_request()) {
    result_requests_.push_back({*id, request.caller, segue::monotonic_now()});
    return;
  }
  if (goal != nullptr) count(&ActionServerStatistics::refused);
  respond(request, result_response(GoalState::None, Value()));
}

bool ServedAction::has_room_for_result_request() {
  if (result_requests_.size() < kMostResultRequests) return true;
  const auto recent = segue::monotonic_now() - kWaitsForClients;
  std::erase_if(result_requests_, [&](const ResultRequest& one) {
    return one.came < recent && !responder(Service::GetResult).sees(one.caller);
  });
  return result_requests_.size() < kMostResultRequests;
}

void ServedAction::end(ServedGoal& goal, GoalState how, const Value& result) {
  const bool was_out = goal.state != GoalState::Accepted;
  const auto& codec = responder(Service::GetResult).response();
  auto response = codec.encode(result_response(how, result), "result");
  if (!response) {
    worker_.goal_trouble("the result cannot be sent: " + segue::to_string(response.error()));
    response = codec.encode(result_response(how, Value()), "result");
  }
  goal.state = how;
  goal.response = std::move(*response);
  goal.ended_at = segue::monotonic_now();
  if (was_out) {
    set_current({});
    worker_.goal_changed(how);
  }
  publish_status();
  for (const ResultRequest& one : result_requests_) {
    if (one.goal == goal.id) respond(Service::GetResult, one.caller, goal.response);
  }
  std::erase_if(result_requests_, [&](const ResultRequest& one) { return one.goal == goal.id; });
}

void ServedAction::end_all() {
  if (ServedGoal* waiting = goals_.waiting(); waiting != nullptr) end(*waiting, GoalState::Aborted, Value());
  ServedGoal* out = goals_.out();
  if (out == nullptr) return;
  worker_.take_cancel();
  end(*out, GoalState::Aborted, Value());
}

void ServedAction::respond(const Request& request, const Value& response) {
  auto message = responder(request.service).response().encode(response, "response");
  if (message) respond(request.service, request.caller, std::move(*message));
}

void ServedAction::respond(Service service, const Caller& caller, std::vector<std::byte> message) {
  responses_.push_back({service, caller, std::move(message), segue::monotonic_now() + kWaitsForClients});
  send_responses();
}

void ServedAction::send_responses() {
  const auto now = segue::monotonic_now();
  std::erase_if(responses_, [&](const Response& one) {
    Responder& to = responder(one.service);
    if (!to.reaches(one.caller) && now < one.give_up) return false;
    if (!to.send(one.caller, one.message)) count(&ActionServerStatistics::unsent);
    return true;
  });
}

void ServedAction::publish_status() {
  const auto message = messages_.status.encode(goals_.status(), "status");
  if (!message) return;
  BytesSource source(*message);
  status_out_->write(static_cast<MessageSource*>(&source));
}

std::optional<GoalId> ServedAction::current() {
  const segue::Lock lock(current_mutex_);
  return current_;
}

void ServedAction::set_current(const std::optional<GoalId>& id) {
  const segue::Lock lock(current_mutex_);
  current_ = id;
}

void ServedAction::count(std::uint64_t ActionServerStatistics::*counter) {
  const segue::Lock lock(mutex_);
  ++(counts_.*counter);
}

void ServedAction::count_unasked(std::size_t samples) {
  const segue::Lock lock(mutex_);
  counts_.unasked += samples;
}

ActionServerStatistics ServedAction::statistics() {
  segue::Lock lock(mutex_);
  ActionServerStatistics now = counts_;
  lock.unlock();
  // One that has just come is not known to all services yet.
  now.clients = responder(Service::SendGoal).clients();
  for (const auto& one : responders_)
    now.clients = std::min(now.clients, one->clients());
  return now;
}

}  // namespace ros2
