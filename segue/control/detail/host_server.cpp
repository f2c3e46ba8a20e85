// SPDX-License-Identifier: Apache-2.0
#include <segue/control/detail/services.hpp>
#include <segue/control/detail/task_access_server.hpp>
#include <segue/rpc/detail/broadcast.hpp>
#include <segue/rpc/detail/decoding_server.hpp>
#include <segue/rpc_codecs/host_wire.hpp>

#include <memory>
#include <utility>
#include <vector>

namespace segue::control::detail {

namespace {

using distributed::HostedRobot;
using distributed::HostService;

/// One runtime's hold on a robot. The lease outlives the connection, so this does not release it.
class HostedRobotServer final : public DecodingServer<wire::HostedRobot>, public TaskAccessServer {
 public:
  HostedRobotServer(const Caller& caller, std::shared_ptr<HostedRobot> robot)
      : TaskAccessServer(caller, robot), caller_(caller), robot_(std::move(robot)) {}
  /// The client is gone: its requests that have not begun are not wanted any more.
  ~HostedRobotServer() noexcept {
    robot_->begin_no_more();
    robot_->set_listener({});
    // Events are destroyed after all work on them that the loop has been given already.
    caller_.core().loop.post([events = events_](kj::AsyncIoContext&) {});
    caller_.client()->listeners -= listeners_.size();
  }

  kj::Promise<void> renew(RenewContext context) override {
    return caller_.answer_here(
        context, [&] { return robot_->renew(); }, [](auto) {});
  }
  kj::Promise<void> release(ReleaseContext context) override {
    return caller_.answer_here(
        context, [&] { return robot_->release(); }, [](auto) {});
  }
  kj::Promise<void> snapshot(SnapshotContext context) override {
    return caller_.answer(
        context, [robot = robot_] { return robot->snapshot(); },
        [](distributed::HostView& view, auto results) { encode(view, results.initView()); });
  }
  kj::Promise<void> expect(ExpectContext context) override {
    return caller_.answer(context, [robot = robot_, target = decode(context.getParams().getTarget())] {
      return robot->expect(target);
    });
  }
  kj::Promise<void> beginTransition(BeginTransitionContext context) override {
    const auto params = context.getParams();
    auto job = [robot = robot_, before = decode(params.getBefore()), target = decode(params.getTarget())] {
      return robot->begin_transition(before, target);
    };
    // A job may go on although the caller is gone, so it must not touch its call.
    const auto outcome = std::make_shared<Result<void>>();
    auto run = [job = std::move(job), outcome, noun = caller_.core().noun()] {
      *outcome = guarded(job, noun);
    };
    begun_ = caller_.run(Role::Observe, std::move(run))
                 .then([outcome](Result<void>&& begun) {
                   if (!begun) *outcome = std::move(begun);
                 })
                 .fork();
    context.releaseParams();
    return begun_.addBranch().then([context, outcome]() mutable {
      if (!*outcome) encode(outcome->error(), context.getResults().initError());
    });
  }
  kj::Promise<void> performInOrder(PerformInOrderContext context) override {
    const auto params = context.getParams();
    const Duration action_deadline = timeout_of(params.getTimeout());
    return in_turn([this, context, action_deadline, batch = batch_of(params)]() mutable {
      return answer_batch(context, std::move(batch), caller_, robot_, follower(),
                          [&](std::vector<model::Action> actions, task_host::Completion completed) {
                            robot_->begin_in_order(std::move(actions), action_deadline, std::move(completed));
                          });
    });
  }
  kj::Promise<void> beginNoMore(BeginNoMoreContext /*context*/) override {
    return in_turn([this]() -> kj::Promise<void> {
      robot_->begin_no_more();
      return kj::READY_NOW;
    });
  }
  kj::Promise<void> getReady(GetReadyContext context) override {
    const auto params = context.getParams();
    return in_turn([this, context,
                    job = [robot = robot_, target = decode(params.getTarget()),
                           links = decode_list<distributed::LinkWait>(
                               params.getLinks(), [](const auto& part) { return decode(part); }),
                           deadline = deadline_after(params.getTimeout())] {
                      return robot->get_ready(target, links, deadline);
                    }]() mutable { return caller_.answer(context, std::move(job)); });
  }
  kj::Promise<void> armCommit(ArmCommitContext context) override {
    const auto params = context.getParams();
    return in_turn([this, context,
                    job = [robot = robot_, transition = decode(params.getTransition()),
                           number = params.getNumber(), deadline = deadline_after(params.getTimeout())] {
                      return robot->arm_commit(transition, number, deadline);
                    }]() mutable { return caller_.answer(context, std::move(job)); });
  }
  kj::Promise<void> vote(VoteContext context) override {
    const auto params = context.getParams();
    return caller_.answer_here(
        context, [&] { return robot_->vote(params.getNumber(), Duration(params.getValidity())); },
        [](auto) {});
  }
  kj::Promise<void> commit(CommitContext context) override {
    return caller_.answer(context, [robot = robot_, number = context.getParams().getNumber()] {
      return robot->commit(number);
    });
  }
  kj::Promise<void> conclude(ConcludeContext context) override {
    return in_turn(
        [this, context, job = [robot = robot_, transition = decode(context.getParams().getTransition())] {
          return robot->conclude(transition);
        }]() mutable { return caller_.answer(context, std::move(job)); });
  }
  kj::Promise<void> withdraw(WithdrawContext context) override {
    return in_turn([this, context]() mutable {
      return caller_.answer(context, [robot = robot_] { return robot->withdraw(); });
    });
  }
  kj::Promise<void> endProcesses(EndProcessesContext context) override {
    return caller_.answer(context,
                          [robot = robot_, deadline = deadline_after(context.getParams().getTimeout())] {
                            return robot->end_processes(deadline);
                          });
  }
  kj::Promise<void> listen(ListenContext context) override;

 private:
  using Events = Broadcast<task_host::HostEvent>;

  /// The client does not wait for the answer to beginTransition(); its next requests come after that.
  template <class Work>
  kj::Promise<void> in_turn(Work work) {
    return begun_.addBranch().then(std::move(work));
  }

  Caller caller_;
  const std::shared_ptr<HostedRobot> robot_;
  /// Shared with the robot's listener, which may still be called when this is destroyed.
  const std::shared_ptr<Events> events_ = std::make_shared<Events>();
  std::vector<std::unique_ptr<Events::Listener>> listeners_;
  kj::ForkedPromise<void> begun_ = kj::Promise<void>(kj::READY_NOW).fork();
};

kj::Promise<void> HostedRobotServer::listen(ListenContext context) {
  if (caller_.client()->listeners >= kMaxListenersPerClient) {
    encode(fail(ErrorCode::ResourceExhausted, "this client listens too often"),
           context.getResults().initError());
    return kj::READY_NOW;
  }
  auto send = [listener = context.getParams().getListener()](const std::vector<task_host::HostEvent>& events,
                                                             std::uint64_t lost) mutable {
    auto request = listener.reportRequest();
    request.setLost(lost);
    encode_list(events, request.initEvents(count_of(events)),
                [](const task_host::HostEvent& event, auto builder) { encode(event, builder); });
    return request.send().ignoreResult();
  };
  listeners_.push_back(std::make_unique<Events::Listener>(*events_, std::move(send)));
  ++caller_.client()->listeners;
  robot_->set_listener([events = events_, &core = caller_.core()](const task_host::HostEvent& event) {
    events->tell(event, core.loop);
  });
  return kj::READY_NOW;
}

class HostServer final : public DecodingServer<wire::Host> {
 public:
  HostServer(Caller caller, HostService& service) : caller_(std::move(caller)), service_(service) {}

  kj::Promise<void> info(InfoContext context) override {
    return caller_.answer(
        context, [&service = service_] { return service.info(); },
        [](distributed::HostInfo& info, auto results) { encode(info, results.initInfo()); });
  }
  kj::Promise<void> clock(ClockContext context) override {
    return caller_.answer_here(
        context, [&] { return service_.clock(); },
        [](std::chrono::system_clock::time_point& time, auto results) {
          results.setTime(
              std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count());
        });
  }
  kj::Promise<void> robots(RobotsContext context) override {
    return caller_.answer(
        context, [&service = service_] { return service.robots(); },
        [](std::vector<distributed::LeaseInfo>& robots, auto results) {
          encode_list(robots, results.initRobots(count_of(robots)),
                      [](const distributed::LeaseInfo& lease, auto builder) { encode(lease, builder); });
        });
  }
  kj::Promise<void> log(LogContext context) override {
    const auto params = context.getParams();
    distributed::LogRequest request;
    request.robot = as_string(params.getRobot());
    request.process = model::ProcessName(as_string(params.getProcess()));
    request.lines = params.getLines();
    if (params.hasAfter()) request.after = decode(params.getAfter());
    return caller_.answer(
        context, [&service = service_, request = std::move(request)] { return service.log(request); },
        [](process_server::LogPart& part, auto results) {
          results.setText(kj::arrayPtr(part.text.data(), part.text.size()).asBytes());
          encode(part.end, results.initEnd());
        });
  }
  kj::Promise<void> highestTerm(HighestTermContext context) override {
    return caller_.answer(
        Role::Operate, context,
        [&service = service_, robot = as_string(context.getParams().getRobot())] {
          return service.highest_term(robot);
        },
        [](std::uint64_t& term, auto results) { results.setTerm(term); });
  }
  kj::Promise<void> acquire(AcquireContext context) override {
    const auto params = context.getParams();
    distributed::RobotRequest request;
    request.holder = as_string(params.getHolder());
    request.secret = as_string(params.getSecret());
    request.identity = identity_of(caller_.client()->peer);
    request.take_over = params.getTakeOver();
    request.again = params.getAgain();
    request.term = params.getTerm();
    request.models = decode_list<distributed::ModelFile>(params.getModels(),
                                                         [](const auto& part) { return decode(part); });
    auto job = [&service = service_, request = std::move(request),
                launch = decode(params.getLaunch(), kServerMessageWords),
                deadline =
                    deadline_after(params.getTimeout())]() mutable -> Result<std::shared_ptr<HostedRobot>> {
      if (!launch) return launch.error();
      auto checked = process_server::launch_from(*launch);
      if (!checked) return checked.error();
      request.launch = std::move(*checked);
      request.launch.deployment = {};  // of whichever process is deployed
      return service.acquire(request, deadline);
    };
    // To take a robot away from another runtime that is alive needs a higher role than to command it. A term
    // says that the runtime has taken the robot over, and keeps others from it.
    const bool takes_over = params.getTakeOver() || params.getTerm() > 0;
    return caller_.answer(takes_over ? Role::Administer : Role::Operate, context, std::move(job),
                          [caller = caller_](std::shared_ptr<HostedRobot>& robot, auto results) {
                            results.setRobot(kj::heap<HostedRobotServer>(caller, std::move(robot)));
                          });
  }

 private:
  Caller caller_;
  HostService& service_;
};

class OfferedHost final : public OfferedService {
 public:
  explicit OfferedHost(HostService& service) : OfferedService(kHostKind), service_(service) {}
  capnp::Capability::Client make_server(const Caller& caller) override {
    return wire::Host::Client(kj::heap<HostServer>(caller, service_));
  }

 private:
  HostService& service_;
};

}  // namespace

std::unique_ptr<OfferedService> offer(HostService& service) {
  return std::make_unique<OfferedHost>(service);
}

}  // namespace segue::control::detail
