// SPDX-License-Identifier: Apache-2.0
#include <segue/remote_robot/served_robot.hpp>

#include <segue/base/life_cycle.hpp>
#include <segue/base/text.hpp>
#include <segue/model/controller_names.hpp>
#include <segue/type/value_at.hpp>

#include <algorithm>
#include <optional>
#include <utility>

namespace segue::remote_robot {

using type::Value;

namespace {

/// Samples that a reader may be behind; older ones are dropped.
constexpr std::size_t kBuffer = 64;
/// Actions that a request names.
constexpr std::size_t kNamedActions = 3;

Value::List list_at(const Value& value, std::string_view key) {
  const Value* found = value.find(key);
  return found == nullptr || !found->is_list() ? Value::List() : found->as_list();
}

bool is_true(const Value& value, std::string_view key) {
  const Value* found = value.find(key);
  return found != nullptr && found->is_bool() && found->as_bool();
}

std::string name_of(std::string_view controller) {
  return controller.empty() ? "the empty network" : "controller " + quote(controller);
}

/// The empty name is the empty network, a part of every other one.
bool is_part(std::string_view controller, std::string_view running) {
  const auto parts = model::controllers_in(running);
  return controller.empty() || std::ranges::find(parts, model::NetworkName(controller)) != parts.end();
}

bool concerns(const Value& fault, std::string_view controller) {
  const Value::List controllers = list_at(fault, "controllers");
  return std::ranges::find(controllers, Value(controller)) != controllers.end();
}

/// The faults of the controller, and whether they are being repaired.
mission::ControllerTrouble faults_of(std::string_view controller, const Value& status) {
  mission::ControllerTrouble trouble;
  for (const Value& fault : list_at(status, "in_repair")) {
    if (concerns(fault, controller)) trouble.repair = text_at(fault, "fault");
  }
  for (const Value& fault : list_at(status, "unresolved")) {
    if (!concerns(fault, controller)) continue;
    const std::string task = text_at(fault, "task");
    if (!task.empty()) {
      trouble.tasks.push_back({task, text_at(fault, "fault")});
    } else if (trouble.why.empty()) {
      trouble.why = text_at(fault, "fault");
    }
  }
  return trouble;
}

control::LeaseStanding standing_in(const Value& status) {
  const Value* to = status.find("lost_to");
  return {to != nullptr && to->is_string() ? std::optional(to->as_string()) : std::nullopt,
          is_true(status, "stopped")};
}

class StreamSamples final : public mission::PortSamples {
 public:
  explicit StreamSamples(std::unique_ptr<control::SampleStream> stream) : stream_(std::move(stream)) {}
  Result<std::vector<Value>> take(const Wait& wait) override { return stream_->read(kBuffer, wait); }
  void next(const Wait& wait, mission::SamplesAnswer answered) override {
    stream_->next(kBuffer, wait, std::move(answered));
  }

 private:
  const std::unique_ptr<control::SampleStream> stream_;
};

Error given_back() {
  return fail(ErrorCode::InvalidState, "the robot was given back");
}

/// Is stopped when any of two is.
class EitherStop {
 public:
  EitherStop(const std::stop_token& one, const std::stop_token& other)
      : one_(one, Stopping{source_}), other_(other, Stopping{source_}) {}
  [[nodiscard]] std::stop_token token() const { return source_.get_token(); }

 private:
  struct Stopping {
    std::stop_source source;
    void operator()() { source.request_stop(); }
  };
  std::stop_source source_;
  std::stop_callback<Stopping> one_;
  std::stop_callback<Stopping> other_;
};

}  // namespace

std::optional<Error> ServedRobot::loss() const {
  const Lock lock(mutex_);
  return why_lost_;
}

std::optional<Error> ServedRobot::refusal() const {
  const Lock lock(mutex_);
  if (given_back_) return given_back();
  return why_lost_;
}

template <class T>
Result<T> ServedRobot::heard(Result<T> answer) {
  if (answer || answer.error().code != ErrorCode::DeadlineExceeded) return answer;
  {
    const Lock lock(mutex_);
    if (!why_lost_) why_lost_ = fail(ErrorCode::Unavailable, answer.error().message + ", and counts as lost");
  }
  lost_.request_stop();
  return *loss();
}

template <class Ask>
auto ServedRobot::query(const Wait& wait, Ask ask) const -> decltype(ask(wait)) {
  if (auto lost = loss()) return std::move(*lost);
  const EitherStop either(wait.stop, lost_.get_token());
  auto answer = ask(Wait(wait.deadline, either.token()));
  if (answer) return answer;
  if (auto lost = loss()) return std::move(*lost);
  return answer;
}

template <class T, class Ask>
void ServedRobot::query_later(const Wait& wait, std::function<void(Result<T>)> answered, Ask ask) const {
  if (auto lost = loss()) return answered(std::move(*lost));
  const auto either = std::make_shared<EitherStop>(wait.stop, lost_.get_token());
  ask(Wait(wait.deadline, either->token()),
      [either, answered = std::move(answered)](Result<T> answer) { answered(std::move(answer)); });
}

template <class Ask>
auto ServedRobot::command(const Wait& wait, Ask ask) -> decltype(ask(wait)) {
  if (auto refused = refusal()) return std::move(*refused);
  auto answer = query(wait, ask);
  if (!answer && !wait.is_stopped()) (void)lost_command(wait.stop);  // so that who is stopped knows it first
  return answer;
}

Result<std::uint64_t> ServedRobot::lease() {
  const Lock lock(mutex_);
  if (why_lost_) return *why_lost_;
  if (given_back_) return given_back();
  if (!lease_) {
    auto lease = service_.lease(who_);
    if (!lease) return lease.error();
    lease_ = std::move(*lease);
  }
  return lease_->number();
}

Result<std::shared_ptr<control::RobotLease>> ServedRobot::present_lease() const {
  const Lock lock(mutex_);
  if (why_lost_) return *why_lost_;
  return lease_;
}

/// One at a time has the lease to look at, and no other waits for it longer than it wants to.
class ServedRobot::LeaseCheck {
 public:
  LeaseCheck(ServedRobot& robot, const std::stop_token& stop) : robot_(robot) {
    Lock lock(robot_.looking_mutex_);
    has_lease_ =
        robot_.looked_.wait(robot_.looking_mutex_, stop,
                            [this]() SEGUE_REQUIRES(robot_.looking_mutex_) { return !robot_.is_looked_at_; });
    if (has_lease_) robot_.is_looked_at_ = true;
  }
  ~LeaseCheck() {
    if (!has_lease_) return;
    const Lock lock(robot_.looking_mutex_);
    robot_.is_looked_at_ = false;
    robot_.looked_.notify_one();
  }
  LeaseCheck(const LeaseCheck&) = delete;
  LeaseCheck& operator=(const LeaseCheck&) = delete;
  /// False: a stop came first.
  [[nodiscard]] bool has_lease() const { return has_lease_; }

 private:
  ServedRobot& robot_;
  bool has_lease_ = false;
};

Result<std::optional<std::string>> ServedRobot::lost_command(const std::stop_token& stop) {
  const LeaseCheck check(*this, stop);
  if (!check.has_lease()) return no_longer_wanted();
  const auto lease = present_lease();
  if (!lease) return lease.error();
  if (!*lease) return std::optional<std::string>();
  const auto standing = heard((*lease)->standing(Wait(TimePoint::max(), stop)));
  if (!standing) return standing.error();
  return lost_by(*standing);
}

std::optional<std::string> ServedRobot::lost_by(const control::LeaseStanding& standing) const {
  if (const auto& to = standing.lost_to)
    return "the robot was taken over by " + (to->empty() ? "somebody" : *to);
  if (!standing.is_stopped) return std::nullopt;
  when_stopped_();
  return "the mission is stopped";
}

Result<void> ServedRobot::take() {
  const auto number = lease();
  return number ? Result<void>() : number.error();
}

Result<std::vector<control::HolderRequest>> ServedRobot::asked() {
  if (auto taken = take(); !taken) return taken.error();
  const LeaseCheck check(*this, {});
  const auto lease = present_lease();
  if (!lease) return lease.error();
  if (!*lease) return given_back();
  return heard((*lease)->asked());
}

Result<void> ServedRobot::report(Value doing) {
  const auto number = lease();
  if (!number) return number.error();
  auto [happened, last] = record_.waiting();
  if (last > 0) doing.as_map().set("happened", std::move(happened));
  auto done = heard(service_.report(*number, doing));
  if (done) record_.taken(last);
  return done;
}

Result<void> ServedRobot::report_units(Value units) {
  const auto number = lease();
  if (!number) return number.error();
  return heard(service_.report(*number, Value::map({{"units", std::move(units)}})));
}

Result<void> ServedRobot::tell_units() {
  auto [changes, count] = units_.waiting();
  if (count == 0) return {};
  auto told = report_units(std::move(changes));
  if (told) units_.taken(count);
  return told;
}

Result<mission::UnitCounts> ServedRobot::counts() {
  if (auto lost = loss()) return std::move(*lost);
  const auto kept = service_.units();
  if (!kept) return kept.error();
  mission::UnitCounts counts;
  for (const Value& one : kept->is_list() ? kept->as_list() : Value::List()) {
    const Value* count = one.find("count");
    if (count != nullptr && count->is_integer())
      counts.emplace_back(text_at(one, "name"), static_cast<std::uint32_t>(count->as_int()));
  }
  return counts;
}

Result<void> ServedRobot::begin(const std::string& journal, const mission::UnitCounts& counts) {
  type::ValueMap begun;
  for (const auto& [name, count] : counts)
    begun.append(name, std::int64_t{count});
  return report_units(Value::map({{"run", units_.begin(journal)}, {"begun", std::move(begun)}}));
}

Result<Value> ServedRobot::give_back(bool keep, Deadline deadline) {
  std::shared_ptr<control::RobotLease> lease;
  {
    const Lock lock(mutex_);
    given_back_ = true;
    lease = std::move(lease_);
    if (why_lost_) return *why_lost_;
  }
  if (!lease) return Value();
  return service_.give_back(lease->number(), keep, deadline);
}

/// "mission patrol/there"
std::string ServedRobot::requester(const mission::ControllerRequest& what) const {
  const std::string mission = record_.mission();
  if (mission.empty()) return who_;
  std::string who = "mission " + mission;
  for (std::size_t i = 0; i < std::min(what.causes.size(), kNamedActions); ++i) {
    const std::string& action = what.causes[i].action;
    who += (i == 0 ? "" : ", " + mission) + (action.empty() ? "" : "/" + action);
  }
  if (what.causes.size() > kNamedActions)
    who += " and " + std::to_string(what.causes.size() - kNamedActions) + " more";
  return who;
}

void ServedRobot::count_saving(const Value& transition) {
  const Value* ahead = transition.find("ahead");
  const Value* saved = ahead == nullptr ? nullptr : ahead->find("saved_s");
  if (saved == nullptr || !saved->is_number()) return;
  const Lock lock(mutex_);
  ++saved_.transitions;
  saved_.saved += std::chrono::duration_cast<Duration>(std::chrono::duration<double>(saved->as_double()));
}

LookAheadSaving ServedRobot::saved() const {
  const Lock lock(mutex_);
  return saved_;
}

Result<void> ServedRobot::request(const mission::ControllerRequest& what, const Wait& wait) {
  if (wait.is_stopped()) return no_longer_wanted();
  const auto lease = this->lease();
  if (!lease) return lease.error();
  for (const auto& cause : what.causes)
    record_.asked(cause);
  control::RequestOptions options;
  options.who = requester(what);
  options.lease = *lease;
  for (const auto& one : what.properties)
    options.properties.push_back({model::TaskId(one.member.task), one.member.name, one.value});
  const std::string controller = model::joined_name({what.controllers.begin(), what.controllers.end()}).str();
  const auto answer =
      command(wait, [&](const Wait& both) { return service_.switch_to(controller, options, both); });
  if (!answer) return answer.error();
  count_saving(*answer);
  const std::string outcome = text_at(*answer, "outcome");
  if (outcome == "done") return {};
  // The taker's request may have taken the place of this one, which says only that a newer one came.
  if (const auto lost = lost_command(wait.stop); lost && *lost) return fail(ErrorCode::InvalidState, **lost);
  const std::string error = text_at(*answer, "error");
  const ErrorCode code = outcome == "superseded" ? ErrorCode::Superseded : ErrorCode::InvalidState;
  return fail(code, "the request for " + name_of(controller) + " was " + outcome +
                        (error.empty() ? std::string() : ": " + error));
}

/// Before the first request it commands nothing.
control::Sender ServedRobot::sender() const {
  const Lock lock(mutex_);
  return {who_, lease_ ? lease_->number() : 0};
}

Result<mission::ControllerTrouble> ServedRobot::trouble(std::string_view controller, const Wait& wait) {
  const std::uint64_t lease = sender().lease;
  auto status = query(wait, [&](const Wait& both) { return service_.running(lease, both); });
  if (wait.deadline == TimePoint::max()) status = heard(std::move(status));  // which it answers at once
  if (!status) return status.error();
  // Once the robot was taken over, or comes to rest, its network is of no interest to this mission.
  if (auto lost = lease == 0 ? std::nullopt : lost_by(standing_in(*status)))
    return mission::ControllerTrouble{*std::move(lost)};
  const std::string running = text_at(*status, "controller");
  if (!is_part(controller, running)) return mission::ControllerTrouble{"the robot runs " + name_of(running)};
  return faults_of(controller, *status);
}

Result<mission::ControllerConflicts> ServedRobot::conflicts(const Wait& wait) {
  const auto status = query(wait, [&](const Wait& both) { return service_.status(both); });
  if (!status) return status.error();
  const auto pairs = query(wait, [&](const Wait& both) { return service_.conflicts({}, both); });
  if (!pairs) return pairs.error();
  const Value* names = status->find("controllers");
  if (names == nullptr || !names->is_list() || !pairs->is_list())
    return fail(ErrorCode::Internal, "the robot does not say which controllers it has");
  mission::ControllerConflicts conflicts;
  for (const Value& name : names->as_list())
    conflicts.controllers.push_back(name.is_string() ? name.as_string() : std::string());
  for (const Value& pair : pairs->as_list()) {
    (is_true(pair, "influence") ? conflicts.influences : conflicts.pairs)
        .push_back({text_at(pair, "a"), text_at(pair, "b"), text_at(pair, "what")});
  }
  return conflicts;
}

Result<std::vector<mission::PoolView>> ServedRobot::pools(const Wait& wait) {
  const auto status = query(wait, [&](const Wait& both) { return service_.status(both); });
  if (!status) return status.error();
  std::vector<mission::PoolView> pools;
  for (const Value& pool : list_at(*status, "pools")) {
    mission::PoolView& view = pools.emplace_back(mission::PoolView{text_at(pool, "pool"), {}});
    const Value* most = pool.find("most");
    if (most != nullptr && most->is_integer()) view.most = static_cast<std::uint32_t>(most->as_int());
    for (const Value& one : list_at(pool, "instances")) {
      const Value* pid = one.find("pid");
      view.instances.push_back(
          {text_at(one, "task"), pid != nullptr && pid->is_integer() ? static_cast<int>(pid->as_int()) : 0,
           is_true(one, "ready"), is_true(one, "given_up"), text_at(one, "reason"), is_true(one, "busy")});
    }
  }
  return pools;
}

void ServedRobot::take_instance(const model::InstanceQuestion& what, const Wait& wait,
                                model::InstanceAnswer answered) {
  query_later<model::TakenInstance>(wait, std::move(answered),
                                    [&](const Wait& both, model::InstanceAnswer answer) {
                                      service_.take_instance(what, both, std::move(answer));
                                    });
}

Result<void> ServedRobot::prepare(const std::vector<std::string>& controllers, const Wait& wait) {
  const auto prepared =
      command(wait, [&](const Wait& both) { return service_.prepare(controllers, sender().lease, both); });
  return prepared ? Result<void>() : prepared.error();
}

Result<Value> ServedRobot::call(const mission::Member& operation, const Value& arguments, const Wait& wait) {
  return command(wait, [&](const Wait& both) {
    return service_.call(operation.task, operation.name, arguments, sender(), both);
  });
}

Result<void> ServedRobot::set(const mission::Member& property, const Value& value, const Wait& wait) {
  return command(wait, [&](const Wait& both) {
    return service_.set_property(property.task, property.name, value, sender(), both);
  });
}

Result<void> ServedRobot::write(const mission::Member& port, const Value& value, const Wait& wait) {
  return command(
      wait, [&](const Wait& both) { return service_.write(port.task, port.name, value, sender(), both); });
}

void ServedRobot::watch(const mission::TaskQuestion& question, const Wait& wait,
                        mission::TaskAnswer answered) {
  task_host::LevelQuestion asked{model::TaskId(question.task), std::nullopt, question.each_update};
  if (question.seen) {
    asked.seen = task_host::TaskLevel{task_state_from(question.seen->state).value_or(TaskState::Fatal),
                                      question.seen->state_name, question.seen->updates};
  }
  query_later<mission::TaskView>(
      wait, std::move(answered), [&](const Wait& both, mission::TaskAnswer answer) {
        service_.watch(asked, both, [answer = std::move(answer)](Result<control::RobotLevel> seen) {
          if (!seen) return answer(std::move(seen.error()));
          auto& [level, changes] = *seen;
          answer(mission::TaskView{std::string(to_string(level.state)), std::move(level.state_name),
                                   level.updates, changes});
        });
      });
}

void ServedRobot::changes(std::uint64_t seen, const Wait& wait, mission::ChangesAnswer answered) {
  query_later<std::uint64_t>(wait, std::move(answered), [&](const Wait& both, mission::ChangesAnswer answer) {
    service_.changes(seen, both, std::move(answer));
  });
}

Result<std::unique_ptr<mission::PortSamples>> ServedRobot::open(const mission::Member& port,
                                                                const Wait& wait) {
  auto stream =
      query(wait, [&](const Wait& both) { return service_.open_port(port.task, port.name, kBuffer, both); });
  if (!stream) return stream.error();
  return std::make_unique<StreamSamples>(std::move(*stream));
}

}  // namespace segue::remote_robot
