// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/control/deployment_client.hpp>
#include <segue/control/detail/services.hpp>
#include <segue/control/detail/task_access_client.hpp>
#include <segue/rpc/detail/callback_slot.hpp>
#include <segue/rpc/detail/rpc_channel.hpp>
#include <segue/rpc_codecs/deployment_wire.hpp>
#include <segue/rpc_codecs/memory_wire.hpp>

#include <fcntl.h>

#include <algorithm>
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
using type::Value;
using Process = wire::DeploymentProcess;

constexpr auto kNothing = [](auto&) { return Result<void>(); };
constexpr auto kEncode = [](const auto& item, auto builder) { encode(item, builder); };
constexpr auto kDecode = [](const auto& part) { return decode(part); };
constexpr auto kOutcomes = [](auto& results) { return results.getOutcomes(); };

/// Receives events from the deployment process.
class ListenerServer final : public wire::TaskListener::Server {
 public:
  ListenerServer(std::shared_ptr<detail::CallbackSlot<task_host::TaskEvent>> listener, std::string who)
      : listener_(std::move(listener)), who_(std::move(who)) {}

  kj::Promise<void> report(ReportContext context) override {
    const auto params = context.getParams();
    if (const auto lost = params.getLost(); lost > 0) {
      log(LogLevel::Warning, "control",
          std::to_string(lost) + " events of tasks of " + who_ + " came too fast and were lost");
    }
    for (const auto event : params.getEvents())
      listener_->call(decode(event));
    return kj::READY_NOW;
  }

 private:
  std::shared_ptr<detail::CallbackSlot<task_host::TaskEvent>> listener_;
  std::string who_;
};

RpcChannel::Reply<deploy::DeploymentInfo> ask_for_info(Process::Client process) {
  auto request = process.infoRequest();
  return RpcChannel::send<deploy::DeploymentInfo>(request,
                                                  [](auto& results) { return decode(results.getInfo()); });
}

using EventSlot = detail::CallbackSlot<task_host::TaskEvent>;

wire::TaskAccess::Client service_of(RpcChannel::Connection& connection) {
  return connection.as<Process>();
}

class DeploymentClient final : public detail::TaskAccessClient<deploy::DeploymentService> {
 public:
  /// `listener` gets the events of the process already.
  DeploymentClient(std::shared_ptr<RpcChannel> channel, std::shared_ptr<EventSlot> listener,
                   std::function<void()> gone)
      : TaskAccessClient(std::move(channel), &service_of), listener_(std::move(listener)) {
    this->channel().watch(std::move(gone));
  }
  ~DeploymentClient() override {
    channel().unwatch();
    listener_->set(nullptr);
  }

  Result<deploy::DeploymentInfo> info() override {
    return ask<deploy::DeploymentInfo>(kQueryTimeout, &ask_for_info);
  }

  Result<deploy::Snapshot> snapshot() override {
    return ask<deploy::Snapshot>(kQueryTimeout, [](Process::Client process) {
      auto request = process.snapshotRequest();
      return RpcChannel::send<deploy::Snapshot>(request,
                                                [](auto& results) { return decode(results.getSnapshot()); });
    });
  }

  Result<void> expect(const model::Network& network) override {
    return ask<void>(kQueryTimeout, [&](Process::Client process) {
      auto request = process.expectRequest();
      encode(network, request.initNetwork());
      return RpcChannel::send<void>(request, kNothing);
    });
  }

  Result<void> arm_commit(const deploy::ArmCommit& what, TimePoint deadline) override {
    Descriptor page(::fcntl(what.page->descriptor(), F_DUPFD_CLOEXEC, 0));
    if (!page.valid()) {
      return fail(ErrorCode::ResourceExhausted, "no file descriptors are left to commit a transition");
    }
    return ask<void>(time_left(deadline), [&](Process::Client process) {
      auto request = process.armCommitRequest();
      request.setPage(encode(std::move(page)));
      request.setNumber(what.number);
      detail::encode_list(what.within, request.initWithin(count_of(what.within)), kEncode);
      detail::encode_list(what.endpoints, request.initEndpoints(count_of(what.endpoints)), kEncode);
      return RpcChannel::send<void>(request, kNothing);
    });
  }

  Result<void> settle(TimePoint deadline) override {
    return ask<void>(time_left(deadline), [](Process::Client process) {
      auto request = process.settleRequest();
      return RpcChannel::send<void>(request, kNothing);
    });
  }

  Result<void> conclude(const model::Transition& transition, TimePoint deadline) override {
    return ask<void>(time_left(deadline), [&](Process::Client process) {
      auto request = process.concludeRequest();
      encode(transition, request.initTransition());
      return RpcChannel::send<void>(request, kNothing);
    });
  }

  Result<sample_link::MemoryOffer> memory(TimePoint deadline) override {
    return ask<sample_link::MemoryOffer>(time_left(deadline), [](Process::Client process) {
      return process.memoryRequest().send().then(
          [](auto&& response) -> RpcChannel::Reply<sample_link::MemoryOffer> {
            if (response.hasError()) return Result<sample_link::MemoryOffer>(decode(response.getError()));
            return decode(response.getOffer());
          });
    });
  }

  Result<void> admit(const sample_link::MemoryOffer& peer, TimePoint deadline) override {
    sample_link::MemoryOffer offer{peer.incarnation, peer.payload.duplicate(), peer.control.duplicate()};
    if (!offer.payload.valid() || !offer.control.valid()) {
      return fail(ErrorCode::ResourceExhausted, "no file descriptors are left to offer memory");
    }
    return ask<void>(time_left(deadline), [&](Process::Client process) {
      auto request = process.admitRequest();
      encode(std::move(offer), request.initOffer());
      return RpcChannel::send<void>(request, kNothing);
    });
  }

  Result<void> forget(sample_link::Incarnation peer) override {
    return ask<void>(kQueryTimeout, [&](Process::Client process) {
      auto request = process.forgetRequest();
      request.setIncarnation(peer);
      return RpcChannel::send<void>(request, kNothing);
    });
  }

  std::vector<Result<sample_link::OutputOrigin>> describe_outputs(std::span<const model::PortRef> ports,
                                                                  TimePoint deadline) override {
    return ask_each<sample_link::OutputOrigin>(
        ports, deadline, [](auto& results) { return results.getOrigins(); },
        [](Process::Client process, auto items) {
          auto request = process.describeOutputsRequest();
          detail::encode_list(items, request.initPorts(count_of(items)), kEncode);
          return request;
        });
  }

  std::vector<Result<sample_link::InputPlace>> open_inputs(std::span<const deploy::OpenInput> inputs,
                                                           TimePoint deadline) override {
    return ask_each<sample_link::InputPlace>(
        inputs, deadline, [](auto& results) { return results.getPlaces(); },
        [](Process::Client process, auto items) {
          auto request = process.openInputsRequest();
          detail::encode_list(items, request.initInputs(count_of(items)), kEncode);
          return request;
        });
  }

  std::vector<Result<void>> attach_outputs(std::span<const deploy::AttachOutput> outputs,
                                           TimePoint deadline) override {
    return ask_each<void>(outputs, deadline, kOutcomes, [](Process::Client process, auto items) {
      auto request = process.attachOutputsRequest();
      detail::encode_list(items, request.initOutputs(count_of(items)), kEncode);
      return request;
    });
  }

  std::vector<Result<void>> close_endpoints(std::span<const deploy::CloseEndpoint> endpoints,
                                            TimePoint deadline) override {
    return ask_each<void>(endpoints, deadline, kOutcomes, [](Process::Client process, auto items) {
      auto request = process.closeEndpointsRequest();
      detail::encode_list(items, request.initEndpoints(count_of(items)), kEncode);
      return request;
    });
  }

  void set_listener(Listener listener) override { listener_->set(std::move(listener)); }

 private:
  template <class T, class Build>
  Result<T> ask(Duration timeout, const Build& build) {
    return channel().ask<T>(
        timeout, [&](RpcChannel::Connection& connection) { return build(connection.as<Process>()); });
  }

  /// One call for all `items`: `build(process, items)` is the request, `list(results)` the outcomes. An error
  /// of the call is the outcome of each.
  template <class T, class Item, class List, class Build>
  std::vector<Result<T>> ask_each(std::span<const Item> items, TimePoint deadline, List list, Build build) {
    using Outcomes = std::vector<Result<T>>;
    const Duration left = time_left(deadline);
    auto outcomes = ask<Outcomes>(left + kGrace, [&](Process::Client process) {
      auto request = build(std::move(process), items);
      request.setTimeout(left.count());
      return RpcChannel::send<Outcomes>(
          request, [list](auto& results) { return detail::decode_list<Result<T>>(list(results), kDecode); });
    });
    if (!outcomes) return Outcomes(items.size(), Result<T>(outcomes.error()));
    if (outcomes->size() == items.size()) return std::move(*outcomes);
    return Outcomes(items.size(), Result<T>(fail(ErrorCode::Internal,
                                                 channel().who() + " did not answer for everything asked")));
  }

  const std::shared_ptr<EventSlot> listener_;
};

/// The answers to the questions that a client asks when it connects.
struct Introduction {
  Result<deploy::DeploymentInfo> info = fail(ErrorCode::Unavailable, "the process has not said what it is");
  Result<void> listening;
};

/// Asks for all of it at once; the promise is resolved when all of it has been answered.
kj::Promise<void> introduce(const std::shared_ptr<Introduction>& answers, Process::Client process,
                            std::shared_ptr<EventSlot> listener, std::string who) {
  auto request = process.listenRequest();
  request.setListener(kj::heap<ListenerServer>(std::move(listener), std::move(who)));
  auto listening = RpcChannel::send<void>(request, kNothing).then([answers](Result<void>&& done) {
    answers->listening = std::move(done);
  });
  return ask_for_info(std::move(process))
      .then([answers, listening = kj::mv(listening)](Result<deploy::DeploymentInfo>&& info) mutable {
        answers->info = std::move(info);
        return kj::mv(listening);
      });
}

}  // namespace

Result<deploy::ConnectedDeployment> connect_deployment(const std::filesystem::path& socket,
                                                       TimePoint deadline, std::function<void()> gone) {
  const std::string who = "deployment process " + quote(socket.stem().string());
  const auto listener = std::make_shared<EventSlot>();
  const auto answers = std::make_shared<Introduction>();
  auto channel = RpcChannel::open(socket, detail::kDeploymentKind, who, time_left(deadline),
                                  [&](RpcChannel::Connection& connection) {
                                    return introduce(answers, connection.as<Process>(), listener, who);
                                  });
  if (!channel) return channel.error();
  if (!answers->info) return std::move(answers->info.error());
  if (!answers->listening) {
    log(LogLevel::Warning, "control", "cannot listen: " + to_string(answers->listening.error()));
  }
  return deploy::ConnectedDeployment{
      std::make_unique<DeploymentClient>(std::move(*channel), listener, std::move(gone)),
      std::move(answers->info).value()};
}

}  // namespace segue::control
