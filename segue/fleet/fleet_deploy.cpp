// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/fleet/fleet.hpp>

#include <algorithm>

namespace segue::fleet::detail {

namespace {

constexpr Duration kAdoption = std::chrono::seconds(3);
/// How long a process gets to stop and clean up its tasks, if it answers, and if it does not.
constexpr Duration kOrderly = std::chrono::seconds(5);
constexpr Duration kDisorderly = std::chrono::milliseconds(300);
constexpr Duration kFirstTry = std::chrono::milliseconds(200);
constexpr Duration kLongestTry = std::chrono::seconds(2);
constexpr Duration kBetweenTries = std::chrono::milliseconds(20);

/// Three quarters of the time that is left until `deadline`, but at most `longest`: the rest is for later
/// steps.
TimePoint part_until(TimePoint deadline, Duration longest) {
  const TimePoint begin = monotonic_now();
  return begin + std::min(longest, (deadline - begin) * 3 / 4);
}

/// The last lines of its log and where to find the others, for an error message.
std::string log_text(const process_server::ProcessInfo& process) {
  if (process.log.empty()) {
    return {};
  }
  const std::string lines = last_log_lines(process);
  return "; its log " + process.log.string() + (lines.empty() ? " is empty" : " ends with:" + lines);
}

Error ended_while_starting(const ProcessRecord& record, const process_server::ProcessInfo& process) {
  const std::string reason = process.exit ? to_string(*process.exit) : "ended";
  return fail(ErrorCode::Unavailable,
              "the process " + reason + " while it was being started" + log_text(record.process()),
              to_string(record.key()));
}

bool may_still_come(const Error& error) {
  return error.code == ErrorCode::Unavailable || error.code == ErrorCode::DeadlineExceeded;
}

}  // namespace

Result<void> Fleet::deploy(const model::Deployment& deployment, TimePoint deadline) {
  const model::DeploymentKey key = deployment.key();
  if (key.is_runtime()) {
    return fail(ErrorCode::InvalidArgument, "a process needs a name; the runtime's own is always there");
  }
  {
    const Lock lock(mutex_);
    if (records_.contains(key) || !starting_.try_emplace(key).second) {
      const std::string name = to_string(key);
      return fail(ErrorCode::AlreadyExists, "process " + quote(name) + " is already deployed", name);
    }
  }
  events_.drain();  // events of the former process of that name are delivered before there is a new one
  auto record = start(deployment, deadline);
  std::optional<process_server::ProcessInfo> exit;
  {
    const Lock lock(mutex_);
    exit = record ? starting_[key].exit_of((*record)->process().pid) : std::nullopt;
    starting_.erase(key);
    if (record && !exit) {
      records_.insert_or_assign(key, *record);
      return {};
    }
  }
  return record ? ended_while_starting(**record, *exit) : std::move(record.error());
}

Result<RecordPtr> Fleet::start(const model::Deployment& deployment, TimePoint deadline) {
  process_server::Launch launch = launch_;
  launch.deployment = deployment;
  launch.deployment.tasks.clear();
  auto process = processes_.start(launch, deadline);
  if (!process && process.error().code == ErrorCode::AlreadyExists) {
    // The existing process is in no table, so it is a leftover (of another version, for example) and is
    // replaced.
    (void)processes_.stop(launch.robot, deployment.key(), part_until(deadline, kOrderly));
    process = processes_.start(launch, deadline);
  }
  if (!process) {
    (void)processes_.stop(launch.robot, deployment.key(), monotonic_now() + kDisorderly);
    return std::move(process.error());
  }
  const auto record = std::make_shared<ProcessRecord>(launch.deployment, std::move(*process));
  const Duration all = deadline - monotonic_now();
  auto connected = connect_when_ready(record, monotonic_now() + all * 7 / 8);
  if (!connected) {
    record->expect_end(true);
    (void)processes_.stop(launch.robot, deployment.key(), monotonic_now() + std::min(kDisorderly, all / 16));
    record->set_service(nullptr, std::nullopt);
    return std::move(connected.error());
  }
  return record;
}

Result<void> Fleet::connect_when_ready(const RecordPtr& record, TimePoint deadline) {
  Duration patience = kFirstTry;
  while (true) {
    auto opened = open(record, std::min(deadline, monotonic_now() + patience));
    if (opened || !may_still_come(opened.error())) {
      return opened;
    }
    if (const auto exit = wait_for_exit_of_starting(*record, kBetweenTries)) {
      return ended_while_starting(*record, *exit);
    }
    if (monotonic_now() >= deadline) {
      return fail(ErrorCode::DeadlineExceeded,
                  "the process was started (pid " + std::to_string(record->process().pid) +
                      ") but did not become ready in time" + log_text(record->process()),
                  to_string(record->key()))
          .because_of(std::move(opened.error()));
    }
    patience = std::min(kLongestTry, patience * 2);
  }
}

std::optional<process_server::ProcessInfo> Fleet::wait_for_exit_of_starting(const ProcessRecord& record,
                                                                            Duration patience) {
  std::optional<process_server::ProcessInfo> exit;
  Lock lock(mutex_);
  changed_.wait_for(mutex_, patience, [&]() SEGUE_REQUIRES(mutex_) {
    const auto found = starting_.find(record.key());
    exit = found == starting_.end() ? std::nullopt : found->second.exit_of(record.process().pid);
    return exit.has_value();
  });
  return exit;
}

std::shared_ptr<deploy::DeploymentService> Fleet::shared(std::unique_ptr<deploy::DeploymentService> service) {
  return {service.release(), [weak = weak_from_this()](deploy::DeploymentService* last) {
            const auto self = weak.lock();
            if (self == nullptr || !self->pool_.submit([last] { delete last; })) {
              delete last;
            }
          }};
}

Result<void> Fleet::open(const RecordPtr& record, TimePoint deadline) {
  auto connected = connector_(record->process().socket, deadline,
                              [weak = weak_from_this(), which = std::weak_ptr<ProcessRecord>(record)] {
                                if (const auto self = weak.lock()) {
                                  self->on_disconnected(which);
                                }
                              });
  if (!connected) {
    return std::move(connected.error());
  }
  const auto service = shared(std::move(connected->service));
  deploy::DeploymentInfo& info = connected->info;
  const bool same_life = record->incarnation() == 0 || record->incarnation() == info.incarnation;
  if (info.robot != launch_.robot || info.deployment.key() != record->key() || !same_life) {
    return fail(ErrorCode::InvalidState,
                "another process (" + quote(to_string(info.deployment.key())) + " of robot " +
                    quote(info.robot) + ") answers at " + record->process().socket.string(),
                to_string(record->key()));
  }
  if (const auto own = own_->service()->info(); own && own->software != info.software) {
    return fail(ErrorCode::InvalidState,
                "it is of version " + quote(info.software) + " of Segue, and this is " +
                    quote(own->software) + ": what they share may differ",
                to_string(record->key()));
  }
  listen_to(record, *service);
  send_expectations(*service, record->key());
  record->set_service(service, std::move(info));
  return {};
}

void Fleet::listen_to(const RecordPtr& record, deploy::DeploymentService& service) {
  service.set_listener([weak = weak_from_this(),
                        which = std::weak_ptr<ProcessRecord>(record)](const task_host::TaskEvent& event) {
    const auto self = weak.lock();
    const auto from = which.lock();
    if (self && from && !from->end_expected() && !from->ended()) {
      task_host::TaskEvent named = event;
      named.task = self->placements_.name(event.task, from->key());
      self->events_.post(std::move(named));
    }
  });
}

Result<RecordPtr> Fleet::deployed(const model::DeploymentKey& key) const {
  RecordPtr record = key.is_runtime() ? nullptr : find(key);
  if (record == nullptr) {
    return fail(ErrorCode::NotFound, "process " + quote(to_string(key)) + " is not deployed", to_string(key));
  }
  return record;
}

Result<void> Fleet::undeploy(const model::DeploymentKey& key, TimePoint deadline) {
  const auto record = deployed(key);
  if (!record) {
    return record.error();
  }
  poll_processes({*record});
  const ProcessView view = (*record)->view();
  if (auto empty = check_empty(view); !empty) {
    return empty;
  }
  const bool orderly =
      !view.is_to_be_replaced() && view.snapshot != nullptr && view.snapshot->hanging.empty();
  return end_by(*record, [&] {
    auto reason = processes_.stop(launch_.robot, key, part_until(deadline, orderly ? kOrderly : kDisorderly));
    if (reason) {
      report_defect(**record, *reason);
    }
    return reason;
  });
}

Result<void> Fleet::kill(const model::DeploymentKey& key, TimePoint deadline) {
  const auto record = deployed(key);
  if (!record) {
    return record.error();
  }
  return end_by(*record, [&] { return processes_.kill(launch_.robot, key, deadline); });
}

Result<void> Fleet::end_by(const RecordPtr& record,
                           const std::function<Result<process_server::ExitReason>()>& how) {
  record->expect_end(true);
  auto reason = how();
  if (!reason && reason.error().code != ErrorCode::NotFound) {
    record->expect_end(false);
    return std::move(reason.error());
  }
  remove(record);
  release(record);
  return {};
}

void Fleet::end_all(TimePoint deadline) {
  std::vector<concurrent::ThreadPool::Job> jobs;
  for (const auto& record : all()) {
    if (record == own_) {
      continue;
    }
    jobs.emplace_back([this, record, deadline] {
      record->expect_end(true);
      (void)processes_.stop(launch_.robot, record->key(), part_until(deadline, kOrderly));
      remove(record);
      release(record);
    });
  }
  pool_.run_all(std::move(jobs));
}

Result<void> Fleet::check_empty(const ProcessView& view) {
  if (view.is_to_be_replaced() || view.snapshot == nullptr) {
    return {};
  }
  const auto& hanging = view.snapshot->hanging;
  for (const auto& task : view.snapshot->network.tasks) {
    const bool hangs = std::find(hanging.begin(), hanging.end(), task.id) != hanging.end();
    if (is_configured(task.state) && !hangs) {
      return fail(ErrorCode::InvalidState,
                  "task " + quote(task.id.str()) + " in process " + quote(to_string(view.deployment.key())) +
                      " is still " + quote(to_string(task.state)) + "; stop it and clean it up first");
    }
  }
  return {};
}

void Fleet::adopt() {
  auto running = processes_.processes(launch_.robot);
  if (!running) {
    events_.post(task_host::ProcessEvent{
        {}, "cannot find out which processes run already: " + to_string(running.error()), false});
    return;
  }
  std::sort(running->begin(), running->end(), [](const auto& a, const auto& b) { return a.key < b.key; });
  std::vector<std::string> findings(running->size());
  std::vector<concurrent::ThreadPool::Job> jobs;
  for (std::size_t i = 0; i < running->size(); ++i) {
    jobs.emplace_back([&, i] { findings[i] = adopt((*running)[i]); });
  }
  pool_.run_all(std::move(jobs));
  for (std::size_t i = 0; i < findings.size(); ++i) {
    events_.post(task_host::ProcessEvent{(*running)[i].key, findings[i], false});
  }
  poll();
}

std::string Fleet::adopt(const process_server::ProcessInfo& process) {
  model::Deployment deployment;
  deployment.host = process.key.host;
  deployment.process = process.key.process;
  const auto record = std::make_shared<ProcessRecord>(std::move(deployment), process);
  const auto opened = open(record, monotonic_now() + kAdoption);
  if (opened) {
    // Connections in it may have waited for a transition of the runtime before, which was in the middle of
    // it.
    if (const auto service = record->service()) {
      static_cast<void>(service->settle(monotonic_now() + kAdoption));
    }
  }
  const std::string who = "was running (pid " + std::to_string(process.pid) + ") and ";
  if (!opened && !may_still_come(opened.error())) {
    return who + "cannot be taken over; it is ended when its name is needed: " + to_string(opened.error());
  }
  const Lock lock(mutex_);
  records_.insert_or_assign(process.key, record);
  return opened ? who + "has been taken over" : who + "does not answer; a transition replaces it";
}

}  // namespace segue::fleet::detail
