// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/control/detail/services.hpp>
#include <segue/control/detail/task_access_client.hpp>
#include <segue/control/host_client.hpp>
#include <segue/rpc/detail/callback_slot.hpp>
#include <segue/rpc/detail/rpc_channel.hpp>
#include <segue/rpc_codecs/host_wire.hpp>
#include <segue/task_host/ordered_actions.hpp>

#include <future>
#include <string>
#include <utility>

namespace segue::control {

namespace {

using detail::as_text;
using detail::count_of;
using detail::decode;
using detail::encode;
using detail::kGrace;
using detail::kQueryTimeout;
using detail::RpcChannel;
using detail::time_left;

/// A host that does not answer for so long counts as lost.
constexpr Duration kHostPatience = std::chrono::seconds(4);

/// A launch names its process; one for all processes of a robot stands for whichever is deployed.
const model::ProcessName kAnyProcess{"any"};

constexpr auto kNoResult = [](auto&) { return Result<void>(); };

using EventSlot = detail::CallbackSlot<task_host::HostEvent>;

/// Receives events of a robot's tasks and processes.
class HostListenerServer final : public wire::HostListener::Server {
 public:
  explicit HostListenerServer(std::shared_ptr<EventSlot> listener) : listener_(std::move(listener)) {}

  kj::Promise<void> report(ReportContext context) override {
    const auto params = context.getParams();
    if (const auto lost = params.getLost(); lost > 0) {
      log(LogLevel::Warning, "control",
          std::to_string(lost) + " events of a host came too fast and were lost");
    }
    for (const auto event : params.getEvents())
      listener_->call(decode(event));
    return kj::READY_NOW;
  }

 private:
  std::shared_ptr<EventSlot> listener_;
};

class HostedRobotClient final : public detail::TaskAccessClient<distributed::HostedRobot> {
 public:
  /// `id` names the robot's capability, which the channel holds.
  HostedRobotClient(std::shared_ptr<RpcChannel> channel, RpcChannel::StreamId id)
      : TaskAccessClient(std::move(channel),
                         [id](RpcChannel::Connection& connection) -> wire::TaskAccess::Client {
                           return connection.held<wire::HostedRobot>(id);
                         }),
        id_(id) {}
  ~HostedRobotClient() override {
    listener_->set(nullptr);
    channel().close_stream(id_);
  }

  Result<void> renew() override {
    return order(kHostPatience, [](wire::HostedRobot::Client robot) { return robot.renewRequest(); });
  }
  Result<void> release() override {
    return order(kHostPatience, [](wire::HostedRobot::Client robot) { return robot.releaseRequest(); });
  }
  Result<distributed::HostView> snapshot() override {
    return ask<distributed::HostView>(kHostPatience, [](wire::HostedRobot::Client robot) {
      auto request = robot.snapshotRequest();
      return RpcChannel::send<distributed::HostView>(request,
                                                     [](auto& results) { return decode(results.getView()); });
    });
  }
  Result<void> expect(const model::Network& target) override {
    return order(kHostPatience, [&](wire::HostedRobot::Client robot) {
      auto request = robot.expectRequest();
      encode(target, request.initTarget());
      return request;
    });
  }
  Result<void> begin_transition(const model::Network& before, const model::Network& target) override {
    return post([&](wire::HostedRobot::Client robot) {
      auto request = robot.beginTransitionRequest();
      encode(before, request.initBefore());
      encode(target, request.initTarget());
      return request;
    });
  }
  void begin_in_order(std::vector<model::Action> actions, Duration action_deadline,
                      task_host::Completion completed) override {
    const Duration longest = action_deadline * task_host::longest_chain(actions);
    auto send = [action_deadline](wire::TaskAccess::Client tasks, const std::vector<model::Action>& what,
                                  std::uint64_t ticket) {
      return detail::BatchClient::send(tasks.castAs<wire::HostedRobot>().performInOrderRequest(), what,
                                       action_deadline, ticket);
    };
    batches().begin(std::move(actions), longest, std::move(send), std::move(completed));
  }
  void begin_no_more() override {
    // May be called in the loop's own thread. Where it does not arrive, the connection is lost, which lets
    // nothing more begin too.
    (void)channel().start(
        kHostPatience,
        [id = id_](RpcChannel::Connection& connection) {
          return connection.held<wire::HostedRobot>(id).beginNoMoreRequest().send().ignoreResult();
        },
        [](const Error&) {});
  }
  Result<void> get_ready(const model::Network& target, const std::vector<distributed::LinkWait>& links,
                         TimePoint deadline) override {
    const Duration left = time_left(deadline);
    return order(left + kGrace, [&](wire::HostedRobot::Client robot) {
      auto request = robot.getReadyRequest();
      encode(target, request.initTarget());
      detail::encode_list(links, request.initLinks(count_of(links)),
                          [](const auto& link, auto builder) { encode(link, builder); });
      request.setTimeout(left.count());
      return request;
    });
  }
  Result<void> arm_commit(const model::Transition& transition, std::uint64_t number,
                          TimePoint deadline) override {
    const Duration left = time_left(deadline);
    return order(left + kGrace, [&](wire::HostedRobot::Client robot) {
      auto request = robot.armCommitRequest();
      encode(transition, request.initTransition());
      request.setNumber(number);
      request.setTimeout(left.count());
      return request;
    });
  }
  Result<void> vote(std::uint64_t number, Duration validity) override {
    // An answer that comes later than the promise lasts is worth nothing.
    return order(validity, [&](wire::HostedRobot::Client robot) {
      auto request = robot.voteRequest();
      request.setNumber(number);
      request.setValidity(validity.count());
      return request;
    });
  }
  Result<void> commit(std::uint64_t number) override {
    return order(kHostPatience, [&](wire::HostedRobot::Client robot) {
      auto request = robot.commitRequest();
      request.setNumber(number);
      return request;
    });
  }
  Result<void> conclude(const model::Transition& transition) override {
    return order(kHostPatience, [&](wire::HostedRobot::Client robot) {
      auto request = robot.concludeRequest();
      encode(transition, request.initTransition());
      return request;
    });
  }
  Result<void> withdraw() override {
    return order(kQueryTimeout, [](wire::HostedRobot::Client robot) { return robot.withdrawRequest(); });
  }
  Result<void> end_processes(TimePoint deadline) override {
    const Duration left = time_left(deadline);
    return order(left + kGrace, [&](wire::HostedRobot::Client robot) {
      auto request = robot.endProcessesRequest();
      request.setTimeout(left.count());
      return request;
    });
  }

  void set_listener(task_host::TaskHost::Listener listener) override {
    const bool wanted = listener != nullptr;
    listener_->set(std::move(listener));
    if (!wanted || std::exchange(listening_, true)) return;
    const auto done = order(kHostPatience, [&](wire::HostedRobot::Client robot) {
      auto request = robot.listenRequest();
      request.setListener(kj::heap<HostListenerServer>(listener_));
      return request;
    });
    if (!done) log(LogLevel::Warning, "control", "cannot listen: " + to_string(done.error()));
  }

 private:
  template <class T, class Build>
  Result<T> ask(Duration timeout, const Build& build) {
    return channel().ask<T>(timeout, [&](RpcChannel::Connection& connection) {
      return build(connection.held<wire::HostedRobot>(id_));
    });
  }
  /// Sends the request that `build` returns, whose answer is only whether it was done.
  template <class Build>
  Result<void> order(Duration timeout, const Build& build) {
    return ask<void>(timeout, [&](wire::HostedRobot::Client robot) {
      auto request = build(std::move(robot));
      return RpcChannel::send<void>(request, kNoResult);
    });
  }

  /// Sends the request that `build` returns, and returns once it is on its way; an error where it cannot be.
  template <class Build>
  Result<void> post(const Build& build) {
    struct Sent {
      std::promise<Result<void>> outcome;
      bool known = false;
      void set(Result<void> result) {
        if (!std::exchange(known, true)) outcome.set_value(std::move(result));
      }
    };
    const auto sent = std::make_shared<Sent>();
    auto outcome = sent->outcome.get_future();
    const bool begun = channel().start(
        kHostPatience,
        [sent, &build, id = id_](RpcChannel::Connection& connection) -> kj::Promise<void> {
          auto request = build(connection.held<wire::HostedRobot>(id));
          auto fits = detail::check_request(request.totalSize().wordCount);
          const bool fitting = fits.has_value();
          auto answer = fitting ? request.send().ignoreResult() : kj::Promise<void>(kj::READY_NOW);
          sent->set(std::move(fits));
          return answer;
        },
        [sent](Error error) { sent->set(std::move(error)); });
    if (!begun) return fail(ErrorCode::Unavailable, "the connection is closed");
    return outcome.get();
  }

  const RpcChannel::StreamId id_;
  const std::shared_ptr<EventSlot> listener_ = std::make_shared<EventSlot>();
  bool listening_ = false;
};

class HostClient final : public distributed::HostService {
 public:
  HostClient(std::shared_ptr<RpcChannel> channel, std::function<void()> gone) : channel_(std::move(channel)) {
    channel_->watch(std::move(gone));
  }
  ~HostClient() override { channel_->unwatch(); }

  Result<distributed::HostInfo> info() override {
    return ask<distributed::HostInfo>(kQueryTimeout, [](wire::Host::Client host) {
      auto request = host.infoRequest();
      return RpcChannel::send<distributed::HostInfo>(request,
                                                     [](auto& results) { return decode(results.getInfo()); });
    });
  }
  Result<std::chrono::system_clock::time_point> clock() override {
    using Time = std::chrono::system_clock::time_point;
    return ask<Time>(kHostPatience, [](wire::Host::Client host) {
      auto request = host.clockRequest();
      return RpcChannel::send<Time>(
          request, [](auto& results) { return Time(std::chrono::nanoseconds(results.getTime())); });
    });
  }
  Result<std::vector<distributed::LeaseInfo>> robots() override {
    using Leases = std::vector<distributed::LeaseInfo>;
    return ask<Leases>(kQueryTimeout, [](wire::Host::Client host) {
      auto request = host.robotsRequest();
      return RpcChannel::send<Leases>(request, [](auto& results) {
        return detail::decode_list<distributed::LeaseInfo>(results.getRobots(),
                                                           [](const auto& part) { return decode(part); });
      });
    });
  }
  Result<std::uint64_t> highest_term(const std::string& robot) override {
    return ask<std::uint64_t>(kHostPatience, [&](wire::Host::Client host) {
      auto request = host.highestTermRequest();
      request.setRobot(as_text(robot));
      return RpcChannel::send<std::uint64_t>(request, [](auto& results) { return results.getTerm(); });
    });
  }
  Result<process_server::LogPart> log(const distributed::LogRequest& what) override {
    return ask<process_server::LogPart>(kQueryTimeout, [&](wire::Host::Client host) {
      auto request = host.logRequest();
      request.setRobot(as_text(what.robot));
      request.setProcess(as_text(what.process.str()));
      request.setLines(what.lines);
      if (what.after) encode(*what.after, request.initAfter());
      return RpcChannel::send<process_server::LogPart>(request, [](auto& results) {
        const auto text = results.getText().asChars();
        return process_server::LogPart{{text.begin(), text.end()}, decode(results.getEnd())};
      });
    });
  }
  Result<std::shared_ptr<distributed::HostedRobot>> acquire(const distributed::RobotRequest& what,
                                                            TimePoint deadline) override {
    const Duration left = time_left(deadline);
    const RpcChannel::StreamId id = channel_->new_stream_id();
    const auto done = channel_->ask<void>(left + kGrace, [&, id](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Host>().acquireRequest();
      request.setHolder(as_text(what.holder));
      request.setSecret(as_text(what.secret));
      process_server::Launch launch = what.launch;
      launch.deployment.process = kAnyProcess;
      detail::put(process_server::to_value(launch), request.initLaunch());
      detail::encode_list(what.models, request.initModels(count_of(what.models)),
                          [](const auto& file, auto builder) { encode(file, builder); });
      request.setTakeOver(what.take_over);
      request.setAgain(what.again);
      request.setTerm(what.term);
      request.setTimeout(left.count());
      return RpcChannel::send<void>(request, [&connection, id](auto& results) {
        connection.hold(id, results.getRobot());
        return Result<void>();
      });
    });
    if (!done) return done.error();
    return std::make_shared<HostedRobotClient>(channel_, id);
  }

 private:
  template <class T, class Build>
  Result<T> ask(Duration timeout, const Build& build) {
    return channel_->ask<T>(
        timeout, [&](RpcChannel::Connection& connection) { return build(connection.as<wire::Host>()); });
  }

  const std::shared_ptr<RpcChannel> channel_;
};

}  // namespace

Result<std::unique_ptr<distributed::HostService>> connect_host(const Endpoint& endpoint, TimePoint deadline,
                                                               std::function<void()> gone) {
  const auto* tcp = std::get_if<TcpEndpoint>(&endpoint);
  const std::string who = tcp == nullptr ? "the host" : "host " + quote(tcp->host);
  auto channel = RpcChannel::open(endpoint, detail::kHostKind, who, time_left(deadline));
  if (!channel) return channel.error();
  return std::make_unique<HostClient>(std::move(*channel), std::move(gone));
}

}  // namespace segue::control
