// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/halts.hpp>

#include <segue/base/rounded_text.hpp>
#include <segue/base/text.hpp>
#include <segue/concurrent/thread.hpp>

#include <algorithm>
#include <utility>

namespace segue::runtime::detail {

namespace {

/// For a robot that does not say what rest is: its devices are stopped.
constexpr Duration kStopDevices = std::chrono::seconds(2);

std::string who_of(const HaltRequest& request) {
  return request.who.empty() ? "somebody" : request.who;
}

/// "by ann: the button was pressed"
std::string cause_of(const HaltRequest& request) {
  return "by " + who_of(request) + (request.why.empty() ? "" : ": " + request.why);
}

/// Why a transition has not brought about what was requested; nothing: it has. What it stops is stopped last,
/// and what could not be is a leftover.
std::optional<std::string> trouble_of(std::future<SwitchResult>& switched, TimePoint deadline, bool stops) {
  if (switched.wait_until(deadline) != std::future_status::ready) {
    return "the transition has not ended in time";
  }
  const SwitchResult result = switched.get();
  if (!result.ok()) {
    return result.why();
  }
  return stops && result.leftover ? std::optional(to_string(*result.leftover)) : std::nullopt;
}

}  // namespace

Halts::Halts(task_host::TaskHost& host, EventLog& log, Ways ways)
    : host_(host),
      log_(log),
      ways_(std::move(ways)),
      thread_(concurrent::start_thread("segue-halt", [this] { work(stop_.get_token()); })) {}

void Halts::end() {
  {
    const Lock lock(mutex_);
    ended_ = true;
  }
  stop_.request_stop();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void Halts::use(std::shared_ptr<const model::Halt> halt) {
  const Lock lock(mutex_);
  halt_ = std::move(halt);
  changed_.notify_all();
}

void Halts::look_at(const std::set<model::TaskId>& tasks) {
  const Lock lock(mutex_);
  std::erase_if(watched_, [&](const auto& one) { return !tasks.contains(one.first); });
  for (const auto& task : tasks) {
    if (watched_.emplace(task, looks_ + 1).second) {
      ++looks_;
    }
  }
  changed_.notify_all();
}

void Halts::look_away_from(const std::set<model::TaskId>& tasks) {
  const Lock lock(mutex_);
  std::erase_if(watched_, [&](const auto& one) { return tasks.contains(one.first); });
  changed_.notify_all();
}

std::shared_future<HaltResult> Halts::begin(HaltRequest request, const std::function<void()>& first) {
  const std::string by =
      who_of(request) + ", who halted it" + (request.why.empty() ? "" : ": " + request.why);
  std::shared_ptr<const model::Halt> how;
  std::shared_future<HaltResult> result;
  bool is_on_its_way = true;
  {
    const Lock lock(mutex_);
    if (request.latch) {
      latch_ = request;
    }
    log_.add(EventKind::Halt, "", "the robot is halted " + cause_of(request));
    is_on_its_way = under_way_ || ended_;
    if (!is_on_its_way) {
      under_way_.emplace(UnderWay{{std::move(request), std::chrono::system_clock::now(), std::nullopt, {}},
                                  RealClock::instance().now(),
                                  halt_});
      under_way_->result = under_way_->promise.get_future().share();
      how = halt_;
    }
    result = under_way_ ? under_way_->result : std::shared_future<HaltResult>();
  }
  first ? first() : ways_.take_robot(by);
  if (is_on_its_way) {
    return result;
  }
  DevicesStopped otherwise = how ? DevicesStopped{} : ways_.devices_stopped();
  auto switched = how ? ways_.request(by, how->controller, how->within)
                      : ways_.request(by, std::move(otherwise.network), kStopDevices);
  const Lock lock(mutex_);
  under_way_->stopped = std::move(otherwise.tasks);
  under_way_->switched = std::move(switched);
  changed_.notify_all();
  return result;
}

std::shared_future<HaltResult> Halts::on_its_way() const {
  const Lock lock(mutex_);
  return under_way_ ? under_way_->result : std::shared_future<HaltResult>();
}

std::shared_future<HaltResult> Halts::latest() const {
  const Lock lock(mutex_);
  if (under_way_ || !last_) {
    return under_way_ ? under_way_->result : std::shared_future<HaltResult>();
  }
  std::promise<HaltResult> ended;
  ended.set_value(last_->result.value());
  return ended.get_future().share();
}

Result<void> Halts::release(const std::string& who) {
  const Lock lock(mutex_);
  if (!latch_) {
    return fail(ErrorCode::InvalidState, "the robot is not stopped");
  }
  latch_.reset();
  log_.add(EventKind::Halt, "", "released by " + (who.empty() ? "somebody" : who));
  return {};
}

std::optional<Halted> Halts::halted() const {
  const Lock lock(mutex_);
  auto halted = under_way_ ? std::optional(under_way_->halted) : last_;
  if (halted && latch_) {
    halted->stopped_by = who_of(*latch_);
  }
  return halted;
}

void Halts::forget() {
  const Lock lock(mutex_);
  last_.reset();
}

std::optional<Error> Halts::refusal() const {
  const Lock lock(mutex_);
  if (latch_) {
    return fail(ErrorCode::InvalidState, "the robot was stopped " + cause_of(*latch_) +
                                             "; 'segue stop --release' lets it be commanded again");
  }
  if (under_way_) {
    return fail(ErrorCode::InvalidState, "the robot is being halted " + cause_of(under_way_->halted.request));
  }
  if (!held_by_.empty()) {
    return fail(ErrorCode::InvalidState, "the robot is halted while " + held_by_);
  }
  return std::nullopt;
}

void Halts::work(const std::stop_token& stop) {
  std::shared_ptr<const model::Halt> halt;
  Watched tasks;
  std::vector<WhenWatch> watches;
  Lock lock(mutex_);
  while (!stop.stop_requested()) {
    if (halt_ != halt || watched_ != tasks) {
      auto kept = halt_ == halt ? std::move(watches) : std::vector<WhenWatch>();
      halt = halt_;
      tasks = watched_;
      lock.unlock();
      watches = halt ? watch_when(*halt, tasks, std::move(kept)) : std::vector<WhenWatch>();
      lock.lock();
    }
    if (note_conditions(watches) && !under_way_) {
      HaltRequest request{"its halt condition", held_by_};
      lock.unlock();
      begin(std::move(request));
      lock.lock();
    }
    if (under_way_ && under_way_->switched.valid()) {
      bring_to_rest(stop);
      continue;
    }
    changed_.wait(mutex_, stop, [&]() SEGUE_REQUIRES(mutex_) {
      const bool is_asked = under_way_ && under_way_->switched.valid();
      return is_asked || halt_ != halt || watched_ != tasks || sentence_of_first(watches) != held_by_;
    });
  }
}

std::vector<Halts::WhenWatch> Halts::watch_when(const model::Halt& halt, const Watched& tasks,
                                                std::vector<WhenWatch> watches) {
  std::vector<WhenWatch> all;
  for (const model::HaltCondition& wanted : halt.when) {
    const auto task = tasks.find(model::TaskId(model::task_of(wanted.condition)));
    if (task == tasks.end()) {
      continue;
    }
    const auto kept = std::ranges::find_if(watches, [&, look = task->second](const WhenWatch& one) {
      return one.watch && one.look == look && one.watch->condition() == wanted.condition;
    });
    if (kept != watches.end()) {
      all.push_back(std::move(*kept));
      continue;
    }
    WhenWatch& begun = all.emplace_back();
    begun.look = task->second;
    begun.watch = watch(wanted.condition, ConditionWatch::From::Now);
  }
  return all;
}

bool Halts::note_conditions(const std::vector<WhenWatch>& watches) {
  const std::string before = std::exchange(held_by_, sentence_of_first(watches));
  return before.empty() && !held_by_.empty();
}

std::string Halts::sentence_of_first(const std::vector<WhenWatch>& watches) const {
  const auto found = std::ranges::find_if(watches, [this](const WhenWatch& one) SEGUE_REQUIRES(mutex_) {
    const auto task = watched_.find(model::TaskId(model::task_of(one.watch->condition())));
    return task != watched_.end() && task->second == one.look && one.watch->holds();
  });
  return found == watches.end() ? std::string() : model::sentence(found->watch->condition());
}

std::unique_ptr<ConditionWatch> Halts::watch(const model::RobotCondition& condition,
                                             ConditionWatch::From from) {
  return std::make_unique<ConditionWatch>(host_, condition, from, [this] {
    const Lock lock(mutex_);  // so that whoever waits has looked before, or looks again
    changed_.notify_all();
  });
}

void Halts::bring_to_rest(const std::stop_token& stop) {
  UnderWay& halt = *under_way_;  // nobody else replaces it while the thread brings the robot to rest
  auto switched = std::move(halt.switched);
  HaltResult result;
  result.stopped = std::move(halt.stopped);
  std::optional<std::string> trouble;
  {
    const auto how = halt.how;
    const TimePoint deadline = halt.begin + (how ? how->within : kStopDevices);
    const Unlocked unlocked(mutex_);
    trouble = trouble_of(switched, deadline, how == nullptr);
    if (!trouble && how) trouble = wait_for_rest(*how, deadline, stop);
    if (trouble) result.stopped.clear();
    if (trouble && how && !stop.stop_requested()) stop_devices(*trouble, result);
  }
  result.at_rest = !trouble;
  result.trouble = trouble.value_or("");
  result.duration = RealClock::instance().now() - halt.begin;
  log_.add(EventKind::Halt, "",
           result.at_rest ? "the robot is at rest after " + format_seconds(result.duration)
                          : "the robot was not at rest in time: " + result.trouble);
  last_ = halt.halted;
  last_->result = result;
  halt.promise.set_value(std::move(result));
  under_way_.reset();
}

void Halts::stop_devices(std::string& trouble, HaltResult& result) {
  auto otherwise = ways_.devices_stopped();
  auto again = ways_.request("the halt", std::move(otherwise.network), kStopDevices);
  if (const auto more = trouble_of(again, RealClock::instance().now() + 2 * kStopDevices, true)) {
    trouble += "; and its devices could not be stopped: " + *more;
  } else {
    result.stopped = std::move(otherwise.tasks);
  }
}

std::optional<std::string> Halts::wait_for_rest(const model::Halt& halt, TimePoint deadline,
                                                const std::stop_token& stop) {
  std::vector<std::unique_ptr<ConditionWatch>> watches;
  for (const auto& one : halt.at_rest) {
    watches.push_back(watch(one.condition, ConditionWatch::From::Update));
  }
  const auto holds = [](const auto& one) { return one->holds(); };
  {
    Lock lock(mutex_);
    if (changed_.wait_until(mutex_, stop, deadline,
                            [&]() SEGUE_REQUIRES(mutex_) { return std::ranges::all_of(watches, holds); })) {
      return std::nullopt;
    }
  }
  std::vector<std::string> missing;
  for (const auto& one : watches) {
    if (!one->holds()) {
      missing.push_back(model::sentence(one->condition()));
    }
  }
  return "it does not hold that " + listed(missing);
}

}  // namespace segue::runtime::detail
