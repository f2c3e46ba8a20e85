// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/distributed/distributed_task_host.hpp>

#include <segue/base/text.hpp>
#include <segue/concurrent/notifier.hpp>
#include <segue/concurrent/thread.hpp>
#include <segue/distributed/action_router.hpp>
#include <segue/distributed/distributed_check.hpp>
#include <segue/distributed/distributed_commit.hpp>
#include <segue/distributed/link_counts.hpp>
#include <segue/distributed/link_matching.hpp>
#include <segue/distributed/robot_claim.hpp>
#include <segue/distributed/sites.hpp>
#include <segue/task_host/full_id.hpp>

#include <algorithm>
#include <thread>
#include <utility>

namespace segue::distributed {

namespace {

using detail::Site;
using fleet::detail::Which;

TimePoint in(Duration duration) {
  return RealClock::instance().now() + duration;
}

}  // namespace

struct DistributedTaskHost::Implementation {
  Implementation(fleet::DeployedTaskHost& tasks, std::vector<HostPlace> places,
                 const model::ComponentCatalog& components, DistributedOptions chosen)
      : own(tasks),
        catalog(components),
        options(std::move(chosen)),
        part(own, *options.clock),
        sites(part, options.gateways.own, std::move(places), [this](const Error& why) { lose(why); }),
        claim(sites, options.request) {}

  void begin();
  void close();
  /// Listens to a host, and tells it what it has to expect, after it was connected.
  void greet(const Site& site);
  void watch();
  /// Another runtime has got the robot: all leases are given up, and no host is asked for one any more.
  void lose(const Error& why);
  void give_up();
  void look_after(const Site& site);
  void report(const Site& site, bool reachable, const std::string& message);
  [[nodiscard]] SampleType type_of(const model::Task& writer, const std::string& port) const;
  /// The views of all hosts that can be reached, in one, with the counts of connections condensed. Blocks;
  /// one caller at a time.
  HostView look_and_note();

  fleet::DeployedTaskHost& own;
  const model::ComponentCatalog& catalog;
  const DistributedOptions options;
  CommitParticipant part;
  detail::Sites sites;
  detail::RobotClaim claim;
  detail::ActionRouter router{sites};
  detail::DistributedCommit commits{sites, router, options.promise, *options.clock};
  detail::LinkMatching matching{sites, router};
  concurrent::Notifier<task_host::HostEvent> events{500};

  Mutex observing;      ///< one snapshot at a time; taken before `mutex`
  mutable Mutex mutex;  ///< protects everything below except the thread
  ConditionVariable changed;
  std::map<model::NetworkName, model::Network> expected SEGUE_GUARDED_BY(mutex);
  detail::LinkCounts counts SEGUE_GUARDED_BY(mutex);
  std::map<const Site*, bool> is_up SEGUE_GUARDED_BY(mutex);  ///< as it was reported last
  bool lost SEGUE_GUARDED_BY(mutex) = false;
  bool closed SEGUE_GUARDED_BY(mutex) = false;
  std::thread watcher;
};

void DistributedTaskHost::Implementation::begin() {
  own.set_listener([this](const task_host::HostEvent& event) { events.post(event); });
  const TimePoint deadline = in(options.patience);
  claim.choose_term(in(options.patience / 2));  // a host that does not answer leaves time for the others
  std::vector<concurrent::ThreadPool::Job> jobs;
  for (const auto& site : sites.all()) {
    jobs.emplace_back([this, deadline, &site = *site] {
      if (site.link() != nullptr && site.link()->connect(claim.first(site), deadline)) {
        greet(site);
      }
    });
  }
  sites.pool().run_all(std::move(jobs));
  {
    const Lock lock(mutex);
    for (const auto& site : sites.all()) {
      is_up[site.get()] = site->reachable();
    }
  }
  (void)sites.snapshot();
  watcher = concurrent::start_thread("segue-hosts", [this] { watch(); });
}

void DistributedTaskHost::Implementation::close() {
  {
    const Lock lock(mutex);
    closed = true;
  }
  changed.notify_all();
  watcher.join();
  own.set_listener({});
  for (const auto& site : sites.all()) {
    if (site->link() != nullptr) site->link()->release("the runtime has ended");
  }
  router.close();
  sites.pool().close();
  events.set_listener({});
}

void DistributedTaskHost::Implementation::greet(const Site& site) {
  const auto reached = site.reach();
  if (!reached) return;
  reached->robot->set_listener([this](const task_host::HostEvent& event) { events.post(event); });
  std::map<model::NetworkName, model::Network> networks;
  {
    const Lock lock(mutex);
    networks = expected;
  }
  for (const auto& [name, network] : networks) {
    (void)reached->robot->expect(sites.part(network, site));
  }
}

void DistributedTaskHost::Implementation::watch() {
  Lock lock(mutex);
  while (!changed.wait_for(mutex, options.watch, [this]() SEGUE_REQUIRES(mutex) { return closed || lost; })) {
    lock.unlock();
    std::vector<concurrent::ThreadPool::Job> jobs;
    for (const auto& site : sites.all()) {
      if (site->link() != nullptr) jobs.emplace_back([this, &site = *site] { look_after(site); });
    }
    sites.pool().run_all(std::move(jobs));
    lock.lock();
  }
  const bool gives_up = lost;
  lock.unlock();
  if (gives_up) give_up();
}

void DistributedTaskHost::Implementation::lose(const Error& why) {
  // Posted first: the hosts that are given up for it are told after their reason.
  events.post(task_host::LossEvent{to_string(why)});
  {
    const Lock lock(mutex);
    lost = true;
  }
  changed.notify_all();
}

void DistributedTaskHost::Implementation::give_up() {
  const auto why = sites.loss().why();
  std::vector<concurrent::ThreadPool::Job> jobs;
  for (const auto& site : sites.all()) {
    if (site->link() != nullptr) {
      jobs.emplace_back([this, &site = *site, text = to_string(*why)] {
        site.link()->release(text);
        report(site, false, text);
      });
    }
  }
  sites.pool().run_all(std::move(jobs));
}

void DistributedTaskHost::Implementation::look_after(const Site& site) {
  if (site.reachable()) {
    (void)site.link()->keep_alive();
  }
  if (!site.reachable()) {
    report(site, false, site.link()->report().state);
    if (site.link()->connect(claim.later(), in(options.patience))) {
      greet(site);
    }
  }
  if (site.reachable()) {
    report(site, true, "is reachable again");
  }
}

/// Each change once.
void DistributedTaskHost::Implementation::report(const Site& site, bool reachable,
                                                 const std::string& message) {
  {
    const Lock lock(mutex);
    if (std::exchange(is_up[&site], reachable) == reachable) {
      return;
    }
  }
  events.post(task_host::ComputerEvent{site.name(), reachable, message});
}

SampleType DistributedTaskHost::Implementation::type_of(const model::Task& writer,
                                                        const std::string& port) const {
  const auto* component = catalog.find(writer.component);
  if (component == nullptr || component->library.empty() || options.only_stand_ins) {
    return {};
  }
  const auto* output = component->find_port(port, model::Direction::Output);
  return output == nullptr ? SampleType{} : SampleType{output->type, component->library};
}

HostView DistributedTaskHost::Implementation::look_and_note() {
  // In turn, since counts that are less than before are those of a half that was made anew.
  const Lock turn(observing);
  auto [view, complete] = sites.snapshot();
  const Lock lock(mutex);
  counts.note(view.connections, complete);
  view.connections = counts.condense(std::move(view.connections));
  return std::move(view);
}

DistributedTaskHost::DistributedTaskHost(fleet::DeployedTaskHost& own, std::vector<HostPlace> hosts,
                                         const model::ComponentCatalog& catalog, DistributedOptions options)
    : implementation_(std::make_unique<Implementation>(own, std::move(hosts), catalog, std::move(options))) {
  implementation_->begin();
}

DistributedTaskHost::~DistributedTaskHost() {
  implementation_->close();
}

std::optional<Error> DistributedTaskHost::loss() const {
  return implementation_->sites.loss().why();
}

Result<void> DistributedTaskHost::commands_all() const {
  if (auto lost = loss()) {
    return std::move(*lost);
  }
  for (const auto& site : implementation_->sites.all()) {
    const auto refusal = site->link() == nullptr ? std::nullopt : site->link()->refusal();
    if (refusal) {
      return fail(refusal->why.code, "host " + quote(site->name().str()) + " refuses")
          .because_of(refusal->why);
    }
  }
  return {};
}

std::optional<TimePoint> DistributedTaskHost::refused_at() const {
  std::optional<TimePoint> first;
  for (const auto& site : implementation_->sites.all()) {
    const auto refusal = site->link() == nullptr ? std::nullopt : site->link()->refusal();
    if (refusal) {
      first = std::min(refusal->when, first.value_or(TimePoint::max()));
    }
  }
  return first;
}

void DistributedTaskHost::end_processes(TimePoint deadline) {
  implementation_->sites.for_all(
      [deadline](const Site&, HostedRobot& robot) { return robot.end_processes(deadline); });
}

bool DistributedTaskHost::stands_in(const model::ComponentName& component) const {
  return implementation_->own.stands_in(component);
}

Result<void> DistributedTaskHost::can_make(const model::ComponentName& component) const {
  auto here = implementation_->own.can_make(component);
  const bool elsewhere =
      !here && std::any_of(implementation_->sites.all().begin(), implementation_->sites.all().end(),
                           [&](const auto& site) { return detail::offers(*site, component); });
  return elsewhere ? Result<void>() : std::move(here);
}

Diagnostics DistributedTaskHost::check(const model::Network& network) const {
  const auto& self = *implementation_;
  Diagnostics findings = detail::check_hosts(network, self.sites, self.catalog, self.options);
  findings.append(self.own.check(self.sites.part(network, *self.sites.all().front())));
  return findings;
}

void DistributedTaskHost::expect(const model::Network& target) {
  const model::Network whole = expanded(target);
  {
    const Lock lock(implementation_->mutex);
    implementation_->expected[target.name] = whole;
  }
  implementation_->sites.for_all([&](const Site& site, HostedRobot& robot) {
    return robot.expect(implementation_->sites.part(whole, site));
  });
}

void DistributedTaskHost::begin_transition(const model::Network& before, const model::Network& target) {
  auto& self = *implementation_;
  self.sites.placements().begin_transition(before, target);
  self.router.begin_transition(before, target);
  self.matching.begin_transition(before);
  self.sites.for_all([&](const Site& site, HostedRobot& robot) {
    return robot.begin_transition(self.sites.part(before, site), self.sites.part(target, site));
  });
}

void DistributedTaskHost::get_ready(const model::Network& target) {
  implementation_->matching.get_ready(target);
}

Result<void> DistributedTaskHost::arm_commit(const model::Transition& transition, TimePoint deadline) {
  auto& self = *implementation_;
  if (auto matched = self.matching.outcome(); !matched) {
    const ErrorCode code = matched.error().code;
    return fail(code, "hosts do not receive each other's samples").because_of(std::move(matched.error()));
  }
  return self.commits.arm(transition, deadline);
}

Result<void> DistributedTaskHost::commit() {
  return implementation_->commits.commit();
}

void DistributedTaskHost::conclude(const model::Transition& transition) {
  auto& self = *implementation_;
  auto& placements = self.sites.placements();
  std::map<const Site*, model::Transition> parts;
  const auto replaced = placements.conclude();
  for (const auto& [task, process] : replaced) {
    const auto was = self.sites.find(process.host);
    const auto is = self.sites.locate(task, Which::Current);
    if (was && (!is || *is != *was)) {
      parts[*was].removes.push_back(task);  // the host itself knows of moves among its processes
    }
  }
  for (const auto& id : transition.removes) {
    if (const auto site = self.sites.locate(id, Which::Current)) {
      parts[*site].removes.push_back(id);
    }
  }
  for (const auto& task : transition.redefines) {
    if (const auto site = self.sites.locate(task.id, Which::Current)) {
      parts[*site].redefines.push_back(task);
    }
  }
  self.sites.for_all([&](const Site& site, HostedRobot& robot) -> Result<void> {
    const auto part = parts.find(&site);
    if (!self.router.reach(site)) {
      return {};  // it has given up the transition; the next snapshot says what it holds
    }
    return robot.conclude(part == parts.end() ? model::Transition{} : part->second);
  });
  self.router.end_transition();
}

void DistributedTaskHost::withdraw() {
  auto& self = *implementation_;
  self.commits.give_up();
  self.router.end_transition();
  self.sites.for_all([](const Site&, HostedRobot& robot) { return robot.withdraw(); });
  self.sites.placements().withdraw();
}

std::vector<task_host::ComputerReport> DistributedTaskHost::computers() const {
  std::vector<task_host::ComputerReport> reports;
  for (const auto& site : implementation_->sites.all()) {
    if (site->link() != nullptr) {
      reports.push_back(site->link()->report());
    } else {
      task_host::ComputerReport own;
      own.name = site->name();
      own.address = "local";
      own.state = "the runtime's own";
      own.software = SEGUE_VERSION;
      reports.push_back(std::move(own));
    }
  }
  return reports;
}

model::Network DistributedTaskHost::expanded(model::Network network) const {
  const auto& self = *implementation_;
  return with_gateways(
      std::move(network), self.options.gateways,
      [&](const model::Task& writer, const std::string& port) { return self.type_of(writer, port); });
}

model::Network DistributedTaskHost::condensed(model::Network network) const {
  return without_gateways(std::move(network));
}

void DistributedTaskHost::perform_in_order(std::vector<model::Action> actions, Duration action_deadline,
                                           const task_host::EarlyEnd& early_end,
                                           task_host::Completion completed) {
  implementation_->router.perform(std::move(actions), action_deadline, early_end, std::move(completed));
}

void DistributedTaskHost::begin_all(std::vector<model::Action> actions, TimePoint deadline,
                                    task_host::Completion completed) {
  for (auto& action : actions) {
    action.after.clear();
  }
  const Duration left = std::max(Duration(0), deadline - RealClock::instance().now());
  implementation_->router.begin(std::move(actions), left, std::move(completed));
}

model::Network DistributedTaskHost::observe() const {
  return implementation_->look_and_note().network;
}

std::vector<task_host::TaskReport> DistributedTaskHost::tasks() const {
  return implementation_->sites.with_lost(implementation_->sites.snapshot().view.tasks);
}

task_host::TaskHost::View DistributedTaskHost::snapshot() const {
  HostView view = implementation_->look_and_note();
  view.tasks = implementation_->sites.with_lost(std::move(view.tasks));
  return view;
}

std::vector<task_host::ConnectionReport> DistributedTaskHost::connections() const {
  return implementation_->look_and_note().connections;
}

Result<task_host::TaskPlace> DistributedTaskHost::find_place(const model::TaskId& task,
                                                             task_host::Purpose purpose) const {
  const bool restores = purpose == task_host::Purpose::Restore;
  const auto site = implementation_->sites.locate(task, restores ? Which::Next : Which::Current);
  if (!site) {
    return site.error();
  }
  auto reached = (*site)->reach();
  if (!reached) {
    return std::move(reached.error());
  }
  return task_host::TaskPlace{std::move(reached->robot), task};
}

void DistributedTaskHost::set_listener(Listener listener) {
  implementation_->events.set_listener(std::move(listener));
}

}  // namespace segue::distributed
