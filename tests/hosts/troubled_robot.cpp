// SPDX-License-Identifier: Apache-2.0
#include "troubled_robot.hpp"

#include <segue/base/mutex.hpp>
#include <segue/base/shared_mutex.hpp>
#include <segue/base/text.hpp>
#include <segue/runtime/runtime_options.hpp>

#include <support/eventually.hpp>

#include <algorithm>
#include <thread>
#include <utility>

namespace segue::distributed::testing {

namespace {

using namespace std::chrono_literals;
using deploy::testing::FaultKind;

constexpr Duration kLong = 30s;
/// How much longer than a promise lasts.
constexpr Duration kTooLong = 3s;
/// How often endpoints are looked for that a transition has left, which lost a host while it retired.
constexpr Duration kTidying = 20ms;

TimePoint before_long() {
  return RealClock::instance().now() + kLong;
}

Error lost() {
  return fail(ErrorCode::Unavailable, "the line is cut");
}

/// Whether a call of that name is one of kCalls.
bool is_call(const std::string& what, std::string_view call) {
  const bool begins_actions = what.starts_with("begin_") && what != "begin_transition";
  return begins_actions ? call == kCalls.front() : what == call;
}

/// Whether the trouble comes after a call was carried out.
bool comes_after(TroubleKind kind) {
  return kind == TroubleKind::AnswerLost || kind == TroubleKind::AnswerLostOnce ||
         kind == TroubleKind::Unanswered;
}

bool delays(TroubleKind kind) {
  return kind == TroubleKind::LateCommit || kind == TroubleKind::LateCommitAgain;
}

FaultKind fault_of(TroubleKind kind) {
  switch (kind) {
    case TroubleKind::ActionDoubted:
      return FaultKind::LoseAnswer;
    case TroubleKind::ProcessHangs:
      return FaultKind::Hang;
    case TroubleKind::ProcessDies:
      return FaultKind::Die;
    case TroubleKind::ProcessDiesAfterwards:
      return FaultKind::DieAfterwards;
    default:
      return FaultKind::Fail;
  }
}

}  // namespace

TroubledRobot::Command::Command(TroubledRobot& robot)
    : processes(robot.own_),
      service(robot.own_, robot.own_.own()),
      own(service, processes, deploy::testing::connector(robot.own_), request_of("").launch, local,
          {60s, kTidying, {model::kLocalHost}}),
      host(own, robot.places(), catalog,
           [&] {
             DistributedOptions options;
             const bool is_first = robot.runtimes_ == 0;
             options.request = request_of("runtime" + std::to_string(++robot.runtimes_), !is_first);
             options.gateways.robot = "robot";
             options.watch = 2ms;
             return options;
           }()),
      runtime("robot", host, catalog, [] {
        runtime::RuntimeOptions options;
        options.policies.restart.backoff = 1ms;
        options.policies.watch = 20ms;
        return options;
      }()) {}

TroubledRobot::TroubledRobot(int hosts, unsigned optional, Planted planted)
    : optional_(optional), planted_(planted) {
  for (int i = 0; i < hosts; ++i) {
    computers_.push_back(std::make_unique<Computer>("h" + std::to_string(i)));
    watch(computers_.size() - 1);
    plant(computers_.size() - 1);
  }
  command_ = std::make_unique<Command>(*this);
}

TroubledRobot::~TroubledRobot() {
  disarm();
  command_.reset();
  rivals_.clear();
}

void TroubledRobot::watch(std::size_t host) {
  auto& line = computers_[host]->line;
  line.spoil_calls([this, host](const std::string& what) { return meet(host, what, Moment::Before); });
  line.spoil_answers([this, host](const std::string& what) { return meet(host, what, Moment::After); });
  line.delay_commit([this, host](const std::string&) { return delays_commit(host); });
  line.watch([this, host](const std::string& what, bool succeeded) { witness(host, what, succeeded); });
}

void TroubledRobot::plant(std::size_t host) {
  auto& line = computers_[host]->line;
  if (planted_ == Planted::LostCommitCountsAsDone) {
    line.pretend([](const std::string& what) { return what == "commit"; });
  } else if (planted_ == Planted::OldViewCountsAsPresent) {
    line.forge([this, host](HostView& view) {
      const Lock lock(mutex_);
      view = first_views_.try_emplace(host, view).first->second;
    });
  } else if (planted_ == Planted::RefusalCountsAsPromise && host == 0) {
    line.pretend([](const std::string& what) { return what == "vote"; });
  }
}

std::vector<HostPlace> TroubledRobot::places() const {
  std::vector<HostPlace> all;
  for (std::size_t i = 0; i < computers_.size(); ++i) {
    all.push_back(computers_[i]->place(optional(i)));
  }
  return all;
}

model::HostName TroubledRobot::name(std::size_t host) const {
  return model::HostName(computers_.at(host)->name);
}

void TroubledRobot::restart_runtime() {
  command_.reset();
  {
    const Lock lock(mutex_);
    usurped_.clear();
  }
  command_ = std::make_unique<Command>(*this);
  renew_rivals();
}

void TroubledRobot::cut(std::size_t host) {
  computers_.at(host)->line.cut();
}

bool TroubledRobot::can_be_reached(std::size_t host) const {
  if (command_->host.loss()) return false;
  const Lock lock(mutex_);
  return computers_.at(host)->line.up() && !rivals_.contains(host);
}

bool TroubledRobot::must_be_lost() const {
  const Lock lock(mutex_);
  return std::any_of(usurped_.begin(), usurped_.end(),
                     [&](std::size_t host) { return computers_[host]->line.up(); });
}

bool TroubledRobot::has_lost_robot() {
  const bool is_lost = host().loss().has_value();
  const Lock lock(mutex_);
  if (is_lost && usurped_.empty()) {
    violations_.push_back("the runtime counts the robot as lost, which no other one has got");
  }
  return is_lost;
}

/// False as well while a rival has left the host and the runtime has not noticed either.
bool TroubledRobot::is_commanded(std::size_t host) const {
  const std::string holder = "runtime" + std::to_string(runtimes_);
  auto& computer = *computers_[host];
  const ReadLock running(computer.booting);
  const auto leases = computer.local->robots();
  return leases && std::any_of(leases->begin(), leases->end(),
                               [&](const LeaseInfo& lease) { return lease.holder == holder; });
}

std::string TroubledRobot::unnoticed() {
  if (must_be_lost() && !host().loss()) return "the robot is not noticed to be lost";
  std::string missing;
  const auto reports = host().computers();
  for (std::size_t i = 0; i < hosts(); ++i) {
    const auto found = std::find_if(reports.begin(), reports.end(),
                                    [&](const auto& report) { return report.name == name(i); });
    if (found == reports.end() || found->reachable != can_be_reached(i)) {
      missing = name(i).str() +
                (can_be_reached(i) ? " is not found again: " : " is not noticed to be lost: ") +
                (found == reports.end() ? "" : found->state);
    } else if (found->reachable && !is_commanded(i)) {
      missing = name(i).str() + " is not noticed to be commanded by nobody";
    }
  }
  return missing;
}

std::string TroubledRobot::settle() {
  // What cannot come, because of a planted defect, is not waited for long.
  const Duration patience = planted_ == Planted::Nothing ? kLong : Duration(5s);
  std::string missing;
  const auto settled = [&] {
    renew_rivals();
    missing = unnoticed();
    return missing.empty();
  };
  if (!segue::testing::eventually(settled, patience)) return missing;
  // Answered when the runtime has looked after everything else.
  const bool idle = runtime().prepare({}).wait_for(kLong) == std::future_status::ready;
  return idle ? "" : "the runtime is busy without end";
}

void TroubledRobot::arm(const std::vector<Trouble>& troubles) {
  const Lock lock(mutex_);
  traps_.clear();
  for (const auto& trouble : troubles) {
    auto& world = computers_.at(static_cast<std::size_t>(trouble.host))->world;
    traps_.push_back({trouble});
    if (is_of_process(trouble.kind)) {
      world.set_fault({trouble.call, fault_of(trouble.kind)});
    }
  }
  if (planted_ == Planted::LostActionsCountAsDone) {
    computers_.front()->world.pretend_actions(2);
  } else if (planted_ == Planted::EndedProcessLivesOn) {
    computers_.front()->world.next_survives();
  }
  armed_ = true;
  in_transition_ = false;
}

void TroubledRobot::disarm() {
  std::vector<std::future<void>> unfinished;
  {
    const Lock lock(mutex_);
    armed_ = false;
    for (auto& trap : traps_) {
      const auto& world = computers_.at(static_cast<std::size_t>(trap.trouble.host))->world;
      trap.struck = trap.struck || (is_of_process(trap.trouble.kind) && world.fault_happened());
    }
    unfinished.swap(later_);
  }
  for (const auto& computer : computers_) {
    computer->world.clear_fault();
  }
  for (auto& one : unfinished) {
    one.wait();
  }
  renew_rivals();
  for (const auto& computer : computers_) {
    if (planted_ != Planted::PromiseLasts && computer->line.has_late_commit()) {
      computer->clock.advance(kTooLong);
    }
    const auto outcome = computer->line.deliver();
    if (outcome && *outcome) {
      const Lock lock(mutex_);
      violations_.push_back(computer->name + " has committed although it was told to too late");
    }
  }
}

std::vector<Trouble> TroubledRobot::struck() const {
  const Lock lock(mutex_);
  std::vector<Trouble> troubles;
  for (const auto& trap : traps_) {
    if (trap.struck) {
      troubles.push_back(trap.trouble);
    }
  }
  return troubles;
}

void TroubledRobot::heal() {
  std::map<std::size_t, Rival> rivals;
  {
    const Lock lock(mutex_);
    rivals.swap(rivals_);
    traps_.clear();
  }
  for (const auto& [host, rival] : rivals) {
    if (rival.session != nullptr) {
      (void)rival.session->release();
    }
  }
  for (const auto& computer : computers_) {
    computer->line.mend();
  }
}

model::Network TroubledRobot::truth(std::optional<std::size_t> host) const {
  return host ? computers_.at(*host)->world.truth() : own_.truth();
}

std::vector<std::string> TroubledRobot::orphans() const {
  std::vector<std::string> all = own_.orphans();
  for (const auto& computer : computers_) {
    for (const auto& orphan : computer->world.orphans()) {
      all.push_back(computer->name + ": " + orphan);
    }
  }
  return all;
}

model::Network TroubledRobot::part(const model::Network& network, std::optional<std::size_t> host) const {
  const auto here = host ? name(*host) : model::kLocalHost;
  const auto processes = model::task_processes(network);
  const auto lives_here = [&](const model::TaskId& task) {
    const auto process = processes.find(task);
    return (process == processes.end() ? model::kLocalHost : process->second.host) == here;
  };
  model::Network part = network;
  std::erase_if(part.tasks, [&](const model::Task& task) { return !lives_here(task.id); });
  std::erase_if(part.deployments, [&](const model::Deployment& one) { return one.host != here; });
  std::erase_if(part.connections, [&](const model::Connection& one) {
    return !lives_here(one.from.task) || !lives_here(one.to.task);
  });
  return part;
}

void TroubledRobot::renew_rivals() {
  const Lock lock(mutex_);
  std::erase_if(rivals_, [](const auto& entry) {
    const auto& session = entry.second.session;
    return session != nullptr && !session->renew();
  });
}

std::vector<std::string> TroubledRobot::violations() {
  renew_rivals();
  std::map<std::size_t, Rival> rivals;
  {
    const Lock lock(mutex_);
    rivals = rivals_;
  }
  for (const auto& [host, rival] : rivals) {
    const auto changes = changes_between(rival.frozen, truth(host));
    const bool still_commands = rival.session == nullptr || rival.session->renew();
    if (!changes.empty() && still_commands) {
      const Lock lock(mutex_);
      violations_.push_back(name(host).str() +
                            " has obeyed a runtime that does not command it: " + listed(changes));
    }
  }
  const Lock lock(mutex_);
  return violations_;
}

std::optional<Error> TroubledRobot::meet(std::size_t host, const std::string& what, Moment moment) {
  if (moment == Moment::Before && what == "commit") {
    check_promises(host);
  }
  if (moment == Moment::Before && what == "begin_transition") {
    const Lock lock(mutex_);
    in_transition_ = armed_;
    promises_.clear();
  }
  const auto kind = next_trouble(host, what, moment);
  return kind ? strike(host, *kind) : std::nullopt;
}

std::optional<TroubleKind> TroubledRobot::next_trouble(std::size_t host, const std::string& what,
                                                       Moment moment) {
  const Lock lock(mutex_);
  if (!armed_ || !in_transition_) return std::nullopt;
  for (auto& trap : traps_) {
    const auto& trouble = trap.trouble;
    const auto call = static_cast<std::size_t>(trouble.call) % kCalls.size();
    if (is_of_process(trouble.kind) || delays(trouble.kind) || trap.struck ||
        static_cast<std::size_t>(trouble.host) != host ||
        comes_after(trouble.kind) != (moment == Moment::After) || !is_call(what, kCalls.at(call)) ||
        ++trap.met < trouble.nth) {
      continue;
    }
    trap.struck = true;
    return trouble.kind;
  }
  return std::nullopt;
}

std::optional<Error> TroubledRobot::strike(std::size_t host, TroubleKind kind) {
  auto& computer = *computers_[host];
  switch (kind) {
    case TroubleKind::MessageLost:
    case TroubleKind::AnswerLost:
      computer.line.cut();
      return lost();
    case TroubleKind::MessageLostOnce:
    case TroubleKind::AnswerLostOnce:
      computer.line.cut();
      computer.line.mend();
      return lost();
    case TroubleKind::Unanswered:
      return fail(ErrorCode::DeadlineExceeded, "no answer in time");
    case TroubleKind::Refused:
      return fail(ErrorCode::InvalidState, "the host refuses");
    case TroubleKind::Slow:
      std::this_thread::sleep_for(5ms);  // the trouble is this time: the runtime's waits are in real time
      return std::nullopt;
    case TroubleKind::ClockJumps:
      computer.clock.advance(kTooLong);
      return std::nullopt;
    case TroubleKind::DaemonRestarts:
    case TroubleKind::HostRestarts:
      computer.line.cut();
      later([this, host, kind] { restart(host, kind == TroubleKind::HostRestarts); });
      return lost();
    default:
      later([this, host, kind] { enter_rival(host, kind == TroubleKind::RivalEndsAll); });
      return std::nullopt;
  }
}

bool TroubledRobot::delays_commit(std::size_t host) {
  {
    const Lock lock(mutex_);
    const auto trap = std::find_if(traps_.begin(), traps_.end(), [&](const Trap& one) {
      return delays(one.trouble.kind) && static_cast<std::size_t>(one.trouble.host) == host && !one.struck;
    });
    if (!armed_ || trap == traps_.end()) return false;
    trap->struck = true;
    if (trap->trouble.kind == TroubleKind::LateCommitAgain) return true;
  }
  computers_[host]->line.cut();
  return true;
}

void TroubledRobot::restart(std::size_t host, bool with_processes) {
  auto& computer = *computers_[host];
  if (with_processes) {
    for (const auto& process : computer.world.running()) {
      computer.world.kill(process);
    }
  }
  computer.boot();
  computer.line.mend();
}

void TroubledRobot::enter_rival(std::size_t host, bool ends_all) {
  // The last that gets the robot is the one that is remembered.
  const Lock one(entering_);
  auto& computer = *computers_[host];
  Rival rival;
  if (planted_ != Planted::LeaseIsNotChecked) {
    const ReadLock running(computer.booting);
    auto session = computer.local->acquire(request_of("rival", true), before_long());
    if (!session) {
      return;  // the runtime gets it again and again, which it may
    }
    rival.session = std::move(*session);
    if (ends_all) {
      (void)rival.session->end_processes(before_long());
    }
  }
  rival.frozen = computer.world.truth();
  const Lock lock(mutex_);
  if (rival.session != nullptr) {
    usurped_.insert(host);
  }
  rivals_.insert_or_assign(host, std::move(rival));
}

/// What would wait for a call in progress if it were done by its thread.
void TroubledRobot::later(std::function<void()> what) {
  auto started = std::async(std::launch::async, std::move(what));
  const Lock lock(mutex_);
  later_.push_back(std::move(started));
}

void TroubledRobot::witness(std::size_t host, const std::string& what, bool succeeded) {
  const Lock lock(mutex_);
  if (!succeeded) return;
  if (what == "arm_commit") {
    promises_[host] = Promise::Asked;
  } else if (what == "vote") {
    promises_[host] = Promise::Given;
  } else if (what == "withdraw" || what == "commit") {
    promises_.erase(host);
  }
}

void TroubledRobot::check_promises(std::size_t host) {
  const Lock lock(mutex_);
  for (const auto& [other, promise] : promises_) {
    if (promise == Promise::Asked) {
      violations_.push_back(name(host).str() + " is told to commit although " + name(other).str() +
                            " has not promised to");
    }
  }
}

}  // namespace segue::distributed::testing
