// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc_codecs/robot.capnp.h>
#include <segue/base/clock.hpp>
#include <segue/control/detail/lease_owners.hpp>
#include <segue/control/detail/request_codec.hpp>
#include <segue/control/detail/services.hpp>
#include <segue/control/detail/stream_server.hpp>
#include <segue/control/detail/watch_server.hpp>
#include <segue/control/robot_service.hpp>
#include <segue/control/verbs.hpp>
#include <segue/rpc/detail/decoding_server.hpp>

#include <algorithm>
#include <atomic>
#include <stop_token>
#include <utility>

namespace segue::control::detail {

namespace {

using type::Value;

constexpr Duration kEventSlice = std::chrono::milliseconds(100);
constexpr std::uint64_t kMaxNodes = kServerMessageWords;

/// Turns a call without a result into one whose result is null.
Result<Value> as_value(const Result<void>& outcome) {
  if (!outcome) return outcome.error();
  return Value();
}

/// The stop token of a request: only one with a lease ends when its caller drops it; somebody without a
/// lease may ask, and go.
std::stop_token stop_of(const RequestOptions& options, const std::stop_token& dropped) {
  return options.lease == 0 ? std::stop_token() : dropped;
}

/// A lease is a stream of news; the name of its type is its number. It is its owner's until it ends.
class LeaseStream final : public SampleStream {
 public:
  LeaseStream(std::unique_ptr<RobotLease> lease, LeaseOwners& owners, const Peer& owner)
      : lease_(std::move(lease)), owners_(owners) {
    owners_.add(lease_->number(), owner);
  }
  ~LeaseStream() override { owners_.remove(lease_->number()); }
  LeaseStream(const LeaseStream&) = delete;
  LeaseStream& operator=(const LeaseStream&) = delete;

  Result<std::vector<Value>> read(std::size_t /*limit*/, const Wait& wait) override {
    std::vector<Value> news;
    const auto standing = lease_->standing(wait);
    if (!standing) return standing.error();
    if (standing->lost_to) news.push_back(Value::map({{"lost_to", *standing->lost_to}}));
    if (standing->is_stopped) news.push_back(Value::map({{"stopped", true}}));
    const auto asked = lease_->asked();
    if (!asked) return asked.error();
    for (const HolderRequest& one : *asked)
      news.push_back(Value::map({{"asked", one.what}, {"number", one.number}, {"arguments", one.arguments}}));
    return news;
  }
  void next(std::size_t /*limit*/, const Wait& /*wait*/, task_host::SamplesAnswer answered) override {
    answered(fail(ErrorCode::Unsupported, "a lease is not waited for; read its news"));
  }
  [[nodiscard]] std::string type_name() const override { return std::to_string(lease_->number()); }

 private:
  const std::unique_ptr<RobotLease> lease_;
  LeaseOwners& owners_;
};

std::vector<std::string> names_in(capnp::List<capnp::Text>::Reader list) {
  std::vector<std::string> names;
  for (const auto name : list)
    names.push_back(as_string(name));
  return names;
}

/// Waits in slices, so that a server that stops does not wait for the longest timeout of its clients.
Result<Value> wait_for_events(RobotService& service, const std::atomic<bool>& stopping, std::uint64_t after,
                              const Wait& wait) {
  for (;;) {
    const Duration left = wait.deadline - RealClock::instance().now();
    auto events = service.events(after, Wait(std::clamp(left, Duration(0), kEventSlice), wait.stop));
    const bool some = events && events->is_list() && !events->as_list().empty();
    if (!events || some || left <= kEventSlice || stopping || wait.is_stopped()) return events;
  }
}

class RobotServer final : public DecodingServer<wire::Robot> {
 public:
  RobotServer(Caller caller, RobotService& service, LeaseOwners& owners)
      : caller_(std::move(caller)), service_(service), lease_owners_(owners) {}

  kj::Promise<void> status(StatusContext context) override {
    return caller_.answer_value(role_for(Verb::Status), context,
                                [&service = service_] { return service.status(); });
  }

  kj::Promise<void> task(TaskContext context) override {
    return caller_.answer_value(
        role_for(Verb::Task), context,
        [&service = service_, id = as_string(context.getParams().getId())] { return service.task(id); });
  }

  kj::Promise<void> watch(WatchContext context) override {
    return answer_watch<RobotLevel>(
        role_for(Verb::Watch), caller_, context,
        [&service = service_](const task_host::LevelQuestion& question, const Wait& wait,
                              RobotLevelAnswer answered) {
          service.watch(question, wait, std::move(answered));
        },
        [](const RobotLevel& seen, auto results) {
          encode(seen.level, results.initLevel());
          results.setChanges(seen.changes);
        });
  }

  kj::Promise<void> running(RunningContext context) override {
    const std::uint64_t lease = context.getParams().getLease();
    return answer_holder(role_for(Verb::Running), lease, context, [&service = service_, lease] {
      return service.running(lease, Wait(TimePoint::max()));
    });
  }

  kj::Promise<void> changes(ChangesContext context) override {
    const auto params = context.getParams();
    return answer_later<std::uint64_t>(
        role_for(Verb::Changes), caller_, context,
        [&service = service_, seen = params.getSeen(), deadline = deadline_after(params.getTimeout())](
            const std::stop_token& dropped, ChangesAnswer answered) {
          service.changes(seen, Wait(deadline, dropped), std::move(answered));
        },
        [](std::uint64_t count, auto results) { results.setCount(count); });
  }

  kj::Promise<void> switchTo(SwitchToContext context) override {
    const auto params = context.getParams();
    return answer_request(Verb::Switch, context,
                          [&service = service_, controller = as_string(params.getController()),
                           dry_run = params.getDryRun()](const RequestOptions& options, const Wait& wait) {
                            return dry_run ? service.diff(controller, options, wait)
                                           : service.switch_to(controller, options, wait);
                          });
  }

  kj::Promise<void> switchToNetwork(SwitchToNetworkContext context) override {
    const auto params = context.getParams();
    return answer_request(
        Verb::Switch, context,
        [&service = service_, text = as_string(params.getText()), file = as_string(params.getFile()),
         dry_run = params.getDryRun()](const RequestOptions& options, const Wait& wait) {
          return dry_run ? service.diff_to_network(text, file, options, wait.deadline)
                         : service.switch_to_network(text, file, options, wait.deadline);
        });
  }

  kj::Promise<void> plan(PlanContext context) override {
    const auto params = context.getParams();
    return caller_.answer_value(role_for(Verb::Plan), context,
                                [&service = service_, controller = as_string(params.getController()),
                                 options = decode(params.getOptions(), peer()),
                                 deadline = deadline_after(params.getTimeout())]() -> Result<Value> {
                                  if (!options) return options.error();
                                  return service.plan(controller, *options, deadline);
                                });
  }

  kj::Promise<void> applyFiles(ApplyFilesContext context) override {
    return answer_request(Verb::Apply, context,
                          [&service = service_](const RequestOptions& options, const Wait& wait) {
                            return service.apply(options, wait.deadline);
                          });
  }

  kj::Promise<void> repair(RepairContext context) override {
    return answer_request(Verb::Repair, context,
                          [&service = service_](const RequestOptions& options, const Wait& wait) {
                            return service.repair(options, wait);
                          });
  }

  kj::Promise<void> prepare(PrepareContext context) override {
    const auto params = context.getParams();
    return answer_holder(
        role_for(Verb::Prepare), params.getLease(), context,
        [&service = service_, controllers = names_in(params.getControllers()), lease = params.getLease(),
         deadline = deadline_after(params.getTimeout())](const std::stop_token& dropped) {
          return service.prepare(controllers, lease, {deadline, dropped});
        });
  }

  kj::Promise<void> conflicts(ConflictsContext context) override {
    return caller_.answer_value(
        role_for(Verb::Conflicts), context,
        [&service = service_, controllers = names_in(context.getParams().getControllers())] {
          return service.conflicts(controllers);
        });
  }

  kj::Promise<void> lease(LeaseContext context) override {
    const std::string said = as_string(context.getParams().getHolder());
    const std::string holder = peer().local ? said : to_string(peer()) + ": " + said;
    return answer_stream(caller_, role_for(Verb::Lease), context,
                         [&service = service_, holder, &owners = lease_owners_,
                          owner = peer()]() -> Result<std::unique_ptr<SampleStream>> {
                           auto lease = service.lease(holder);
                           if (!lease) return lease.error();
                           return std::make_unique<LeaseStream>(std::move(*lease), owners, owner);
                         });
  }

  kj::Promise<void> report(ReportContext context) override {
    const auto params = context.getParams();
    return answer_holder(role_for(Verb::Report), params.getLease(), context,
                         [&service = service_, lease = params.getLease(),
                          doing = decode(params.getDoing(), kMaxNodes)]() -> Result<Value> {
                           if (!doing) return doing.error();
                           return as_value(service.report(lease, *doing));
                         });
  }

  kj::Promise<void> mission(MissionContext context) override {
    const auto params = context.getParams();
    return caller_.answer_value(
        role_for(Verb::Mission), context,
        [&service = service_, after = params.getAfter(), with_plan = params.getWithPlan()] {
          return service.mission(after, with_plan);
        });
  }

  kj::Promise<void> sendCommand(SendCommandContext context) override {
    const auto params = context.getParams();
    return caller_.answer_value(role_for(Verb::SendCommand), context,
                                [&service = service_, what = as_string(params.getWhat()),
                                 arguments = decode(params.getArguments(), kMaxNodes)]() -> Result<Value> {
                                  if (!arguments) return arguments.error();
                                  const auto number = service.send_command(what, *arguments);
                                  return number ? Result<Value>(*number) : Result<Value>(number.error());
                                });
  }

  kj::Promise<void> cancel(CancelContext context) override {
    const auto params = context.getParams();
    return caller_.answer_value(
        role_for(Verb::Cancel), context,
        [&service = service_, request = params.getRequest(),
         who = who_asks(as_string(params.getWho()), peer()),
         deadline = deadline_after(params.getTimeout())] { return service.cancel(request, who, deadline); });
  }

  kj::Promise<void> giveBack(GiveBackContext context) override {
    const auto params = context.getParams();
    return answer_holder(role_for(Verb::GiveBack), params.getLease(), context,
                         [&service = service_, lease = params.getLease(), keep = params.getKeep(),
                          deadline = deadline_after(params.getTimeout())] {
                           return service.give_back(lease, keep, deadline);
                         });
  }

  kj::Promise<void> stop(StopContext context) override {
    const auto params = context.getParams();
    return caller_.urgent().answer_value(
        role_for(Verb::Stop), context,
        [&service = service_, who = who_asks(as_string(params.getWho()), peer()),
         deadline = deadline_after(params.getTimeout())] { return service.stop(who, deadline); });
  }

  kj::Promise<void> release(ReleaseContext context) override {
    return caller_.answer_value(
        role_for(Verb::ReleaseStop), context,
        [&service = service_, who = who_asks(as_string(context.getParams().getWho()), peer())] {
          return as_value(service.release_stop(who));
        });
  }

  kj::Promise<void> applyTransition(ApplyTransitionContext context) override {
    const auto params = context.getParams();
    return answer_request(Verb::ApplyTransition, context,
                          [&service = service_,
                           given = GivenTransition{as_string(params.getName()), as_string(params.getText()),
                                                   as_string(params.getFile())}](
                              const RequestOptions& options, const Wait& wait) {
                            return service.apply_transition(given, options, wait.deadline);
                          });
  }

  kj::Promise<void> resetBelief(ResetBeliefContext context) override {
    const auto params = context.getParams();
    return caller_.answer_value(
        role_for(Verb::ResetBelief), context,
        [&service = service_, network = as_string(params.getNetwork()), file = as_string(params.getFile())] {
          return as_value(service.reset_belief(network, file));
        });
  }

  kj::Promise<void> units(UnitsContext context) override {
    return caller_.answer_value(role_for(Verb::Units), context,
                                [&service = service_] { return service.units(); });
  }

  kj::Promise<void> setUnits(SetUnitsContext context) override {
    const auto params = context.getParams();
    return caller_.answer_value(
        role_for(Verb::SetUnits), context,
        [&service = service_, name = as_string(params.getName()), count = params.getCount(),
         who = who_asks(as_string(params.getWho()), peer())]() -> Result<Value> {
          const auto before = service.set_units(name, count, who);
          if (!before) return before.error();
          return Value(static_cast<std::uint64_t>(*before));
        });
  }

  kj::Promise<void> setProperty(SetPropertyContext context) override {
    const auto params = context.getParams();
    return answer_holder(
        role_for(Verb::Set), params.getSender().getLease(), context,
        [&service = service_, task = as_string(params.getTask()), property = as_string(params.getProperty()),
         value = decode(params.getValue(), kMaxNodes), sender = decode(params.getSender(), peer()),
         deadline = deadline_after(params.getTimeout())](const std::stop_token& dropped) -> Result<Value> {
          if (!value) return value.error();
          return as_value(service.set_property(task, property, *value, sender, {deadline, dropped}));
        });
  }

  kj::Promise<void> write(WriteContext context) override {
    const auto params = context.getParams();
    return answer_holder(
        role_for(Verb::Write), params.getSender().getLease(), context,
        [&service = service_, task = as_string(params.getTask()), port = as_string(params.getPort()),
         value = decode(params.getValue(), kMaxNodes), sender = decode(params.getSender(), peer()),
         deadline = deadline_after(params.getTimeout())](const std::stop_token& dropped) -> Result<Value> {
          if (!value) return value.error();
          return as_value(service.write(task, port, *value, sender, {deadline, dropped}));
        });
  }

  kj::Promise<void> call(CallContext context) override {
    const auto params = context.getParams();
    return answer_holder(
        role_for(Verb::Call), params.getSender().getLease(), context,
        [&service = service_, task = as_string(params.getTask()),
         operation = as_string(params.getOperation()), arguments = decode(params.getArguments(), kMaxNodes),
         sender = decode(params.getSender(), peer()),
         deadline = deadline_after(params.getTimeout())](const std::stop_token& dropped) -> Result<Value> {
          if (!arguments) return arguments.error();
          return service.call(task, operation, *arguments, sender, {deadline, dropped});
        });
  }

  kj::Promise<void> takeInstance(TakeInstanceContext context) override {
    const auto params = context.getParams();
    return answer_later<model::TakenInstance>(
        role_for(Verb::TakeInstance), caller_, context,
        [&service = service_,
         what = model::InstanceQuestion{as_string(params.getPool()),
                                        {as_string(params.getLost()), params.getLostPid()}},
         deadline = deadline_after(params.getTimeout())](const std::stop_token& dropped,
                                                         model::InstanceAnswer answered) {
          service.take_instance(what, Wait(deadline, dropped), std::move(answered));
        },
        [](const model::TakenInstance& taken, auto results) {
          results.setTask(as_text(taken.task));
          results.setPid(taken.pid);
        });
  }

  kj::Promise<void> openPort(OpenPortContext context) override {
    const auto params = context.getParams();
    return answer_stream(
        caller_, role_for(Verb::OpenPort), context,
        [&service = service_, task = as_string(params.getTask()), port = as_string(params.getPort()),
         buffer = std::min<std::size_t>(params.getBuffer(), kMaxBuffer)] {
          return service.open_port(task, port, buffer);
        });
  }

  kj::Promise<void> events(EventsContext context) override {
    const auto params = context.getParams();
    return caller_.answer_value(
        role_for(Verb::Events), context,
        [&service = service_, &stopping = caller_.core().stopping, after = params.getAfter(),
         deadline = deadline_after(params.getWait())](const std::stop_token& dropped) {
          return wait_for_events(service, stopping, after, {deadline, dropped});
        });
  }

  kj::Promise<void> history(HistoryContext context) override {
    return caller_.answer_value(role_for(Verb::History), context,
                                [&service = service_] { return service.history(); });
  }

  kj::Promise<void> past(PastContext context) override {
    return caller_.answer_value(role_for(Verb::Past), context,
                                [&service = service_, question = decode(context.getParams().getQuestion(),
                                                                        kMaxNodes)]() -> Result<Value> {
                                  if (!question) return question.error();
                                  return service.past(*question);
                                });
  }

  kj::Promise<void> shutDown(ShutDownContext context) override {
    return caller_.answer_value(role_for(Verb::ShutDown), context,
                                [&service = service_] { return as_value(service.shut_down()); });
  }

 private:
  /// Answers like Caller::answer_value() a call that names a lease: PermissionDenied where it is of somebody
  /// else.
  template <class Context, class Job>
  kj::Promise<void> answer_holder(Role needed, std::uint64_t lease, Context context, Job job) {
    const auto refusal = lease_owners_.refusal(lease, peer());
    if (!refusal) return caller_.answer_value(needed, context, std::move(job));
    encode(*refusal, context.getResults().initAnswer().initError());
    return kj::READY_NOW;
  }

  /// Answers a request with the result of `job(options, wait)`, on a thread of its own, where the caller's
  /// role allows that verb. Somebody without a lease may ask, and go.
  template <class Context, class Job>
  kj::Promise<void> answer_request(Verb verb, Context context, Job job) {
    const auto params = context.getParams();
    const auto asked = params.getOptions();
    return answer_holder(role_for(verb, asked.getTakeOver()), asked.getLease(), context,
                         [options = decode(asked, peer()), deadline = deadline_after(params.getTimeout()),
                          job = std::move(job)](const std::stop_token& dropped) -> Result<Value> {
                           if (!options) return options.error();
                           return job(*options, Wait(deadline, stop_of(*options, dropped)));
                         });
  }

  [[nodiscard]] const Peer& peer() const { return caller_.client()->peer; }

  Caller caller_;
  RobotService& service_;
  LeaseOwners& lease_owners_;
};

class OfferedRobot final : public OfferedService {
 public:
  explicit OfferedRobot(RobotService& service) : OfferedService(kRobotKind), service_(service) {}
  capnp::Capability::Client make_server(const Caller& caller) override {
    return wire::Robot::Client(kj::heap<RobotServer>(caller, service_, lease_owners_));
  }

 private:
  RobotService& service_;
  LeaseOwners lease_owners_;
};

}  // namespace

std::unique_ptr<OfferedService> offer(RobotService& service) {
  return std::make_unique<OfferedRobot>(service);
}

}  // namespace segue::control::detail
