// SPDX-License-Identifier: Apache-2.0
#include <segue/control/detail/services.hpp>
#include <segue/control/detail/task_access_server.hpp>
#include <segue/rpc/detail/broadcast.hpp>
#include <segue/rpc/detail/decoding_server.hpp>
#include <segue/rpc/detail/rpc_channel.hpp>
#include <segue/rpc_codecs/deployment_wire.hpp>
#include <segue/rpc_codecs/memory_wire.hpp>

#include <memory>
#include <utility>
#include <vector>

namespace segue::control::detail {

namespace {

using deploy::DeploymentService;
using type::Value;

/// How long to wait for the descriptors of an offer, which a client may resolve later.
constexpr auto kOfferTimeout = 5 * kj::SECONDS;

/// The deadline of calls for which the client sends none.
TimePoint soon() {
  return RealClock::instance().now() + kQueryTimeout;
}

template <class Outcome>
Result<std::vector<Outcome>> all(std::vector<Outcome> outcomes) {
  return outcomes;
}

/// Writes a list of outcomes into the list that `init` makes.
template <class Outcome, class Init>
auto listing(Init init) {
  return [init](std::vector<Outcome>& outcomes, auto results) {
    encode_list(outcomes, init(results, count_of(outcomes)),
                [](const Outcome& outcome, auto builder) { encode(outcome, builder); });
  };
}

constexpr auto kInitOutcomes = [](auto results, unsigned size) { return results.initOutcomes(size); };
constexpr auto kDecode = [](const auto& part) { return decode(part); };

using DeploymentEvents = Broadcast<task_host::TaskEvent>;

class DeploymentServer final : public DecodingServer<wire::DeploymentProcess>, public TaskAccessServer {
 public:
  DeploymentServer(Caller caller, DeploymentService& service, DeploymentEvents& events)
      : TaskAccessServer(caller, {std::shared_ptr<void>(), &service}),
        caller_(std::move(caller)),
        service_(service),
        events_(events) {}
  ~DeploymentServer() noexcept { caller_.client()->listeners -= listeners_.size(); }

  kj::Promise<void> info(InfoContext context) override {
    return caller_.answer_here(
        context, [&service = service_] { return service.info(); },
        [](deploy::DeploymentInfo& info, auto results) { encode(info, results.initInfo()); });
  }

  kj::Promise<void> snapshot(SnapshotContext context) override {
    return caller_.answer_here(
        context, [&service = service_] { return service.snapshot(); },
        [](deploy::Snapshot& snapshot, auto results) { encode(snapshot, results.initSnapshot()); });
  }

  kj::Promise<void> expect(ExpectContext context) override {
    auto network = decode(context.getParams().getNetwork());
    return caller_.answer(
        context, [&service = service_, network = std::move(network)] { return service.expect(network); });
  }

  kj::Promise<void> conclude(ConcludeContext context) override {
    auto transition = decode(context.getParams().getTransition());
    return caller_.answer(context, [&service = service_, transition = std::move(transition)] {
      return service.conclude(transition, soon());
    });
  }

  kj::Promise<void> armCommit(ArmCommitContext context) override {
    const auto params = context.getParams();
    deploy::ArmCommit what;
    what.number = params.getNumber();
    what.within = decode_list<model::Connection>(params.getWithin(), kDecode);
    what.endpoints = decode_list<deploy::ArmCommit::Endpoint>(params.getEndpoints(), kDecode);
    return in_time(decode(params.getPage()))
        .then([this, context, what = std::move(what)](Result<Descriptor>&& page) mutable {
          return caller_.answer_here(
              context,
              [&]() -> Result<void> {
                if (!page) return page.error();
                auto mapped = sample_link::CommitPage::map(page->get());
                if (!mapped) return mapped.error();
                what.page = std::move(*mapped);
                return service_.arm_commit(what, soon());
              },
              [](auto) {});
        });
  }

  kj::Promise<void> settle(SettleContext context) override {
    return caller_.answer_here(
        context, [&service = service_] { return service.settle(soon()); }, [](auto) {});
  }

  kj::Promise<void> memory(MemoryContext context) override {
    return caller_.answer(
        context, [&service = service_] { return service.memory(soon()); },
        [](sample_link::MemoryOffer& offer, auto results) { encode(std::move(offer), results.initOffer()); });
  }

  kj::Promise<void> admit(AdmitContext context) override {
    return in_time(decode(context.getParams().getOffer()))
        .then([this, context](Result<sample_link::MemoryOffer>&& offer) mutable {
          auto held = std::make_shared<Result<sample_link::MemoryOffer>>(std::move(offer));
          return caller_.answer(context, [&service = service_, held]() -> Result<void> {
            if (!*held) return held->error();
            return service.admit(**held, soon());
          });
        });
  }

  kj::Promise<void> forget(ForgetContext context) override {
    return caller_.answer(context, [&service = service_, peer = context.getParams().getIncarnation()] {
      return service.forget(peer);
    });
  }

  kj::Promise<void> describeOutputs(DescribeOutputsContext context) override {
    const auto params = context.getParams();
    auto job = [&service = service_, ports = decode_list<model::PortRef>(params.getPorts(), kDecode),
                deadline = deadline_after(params.getTimeout())] {
      return all(service.describe_outputs(ports, deadline));
    };
    return caller_.answer(context, std::move(job),
                          listing<Result<sample_link::OutputOrigin>>(
                              [](auto results, unsigned size) { return results.initOrigins(size); }));
  }

  kj::Promise<void> openInputs(OpenInputsContext context) override {
    const auto params = context.getParams();
    auto job = [&service = service_, inputs = decode_list<deploy::OpenInput>(params.getInputs(), kDecode),
                deadline = deadline_after(params.getTimeout())] {
      return all(service.open_inputs(inputs, deadline));
    };
    return caller_.answer(context, std::move(job),
                          listing<Result<sample_link::InputPlace>>(
                              [](auto results, unsigned size) { return results.initPlaces(size); }));
  }

  kj::Promise<void> attachOutputs(AttachOutputsContext context) override {
    const auto params = context.getParams();
    auto job = [&service = service_,
                outputs = decode_list<deploy::AttachOutput>(params.getOutputs(), kDecode),
                deadline = deadline_after(params.getTimeout())] {
      return all(service.attach_outputs(outputs, deadline));
    };
    return caller_.answer(context, std::move(job), listing<Result<void>>(kInitOutcomes));
  }

  kj::Promise<void> closeEndpoints(CloseEndpointsContext context) override {
    const auto params = context.getParams();
    auto job = [&service = service_,
                endpoints = decode_list<deploy::CloseEndpoint>(params.getEndpoints(), kDecode),
                deadline = deadline_after(params.getTimeout())] {
      return all(service.close_endpoints(endpoints, deadline));
    };
    return caller_.answer(context, std::move(job), listing<Result<void>>(kInitOutcomes));
  }

  kj::Promise<void> listen(ListenContext context) override {
    if (caller_.client()->listeners >= kMaxListenersPerClient) {
      encode(fail(ErrorCode::ResourceExhausted, "this client listens too often"),
             context.getResults().initError());
      return kj::READY_NOW;
    }
    auto send = [listener = context.getParams().getListener()](
                    const std::vector<task_host::TaskEvent>& events, std::uint64_t lost) mutable {
      auto request = listener.reportRequest();
      request.setLost(lost);
      encode_list(events, request.initEvents(count_of(events)),
                  [](const task_host::TaskEvent& event, auto builder) { encode(event, builder); });
      return request.send().ignoreResult();
    };
    listeners_.push_back(std::make_unique<DeploymentEvents::Listener>(events_, std::move(send)));
    ++caller_.client()->listeners;
    return kj::READY_NOW;
  }

 private:
  /// The offer, which comes with file descriptors, or DeadlineExceeded.
  template <class T>
  kj::Promise<Result<T>> in_time(kj::Promise<Result<T>> offer) {
    auto late = caller_.core().loop.timer().afterDelay(kOfferTimeout).then([] {
      return Result<T>(fail(ErrorCode::DeadlineExceeded, "a memory offer did not come whole"));
    });
    return offer.exclusiveJoin(kj::mv(late));
  }

  Caller caller_;
  DeploymentService& service_;
  DeploymentEvents& events_;
  std::vector<std::unique_ptr<DeploymentEvents::Listener>> listeners_;
};

class OfferedDeployment final : public OfferedService {
 public:
  explicit OfferedDeployment(DeploymentService& service)
      : OfferedService(kDeploymentKind), service_(service) {}
  capnp::Capability::Client make_server(const Caller& caller) override {
    return wire::DeploymentProcess::Client(kj::heap<DeploymentServer>(caller, service_, events_));
  }
  void report_events(EventLoop* loop) override {
    if (loop == nullptr) return service_.set_listener({});
    service_.set_listener([this, loop](const task_host::TaskEvent& event) { events_.tell(event, *loop); });
  }

 private:
  DeploymentService& service_;
  DeploymentEvents events_;
};

}  // namespace

std::unique_ptr<OfferedService> offer(DeploymentService& service) {
  return std::make_unique<OfferedDeployment>(service);
}

}  // namespace segue::control::detail
