// SPDX-License-Identifier: Apache-2.0
#include <segue/control/robot.capnp.h>
#include <segue/base/text.hpp>
#include <segue/control/detail/rpc_channel.hpp>
#include <segue/control/detail/stream_client.hpp>
#include <segue/control/detail/wire.hpp>
#include <segue/control/server.hpp>

#include <algorithm>
#include <string>
#include <utility>

namespace segue::control {

namespace {

using detail::as_text;
using detail::kGrace;
using detail::kLookTimeout;
using detail::RpcChannel;
using detail::time_left;
using type::Value;

Result<void> without_value(const Result<Value>& answer) {
  if (!answer) return answer.error();
  return {};
}

/// Of requests that may be dry runs.
template <class Request>
void set_options(Request& request, const SwitchOptions& options) {
  request.setDryRun(options.dry_run);
  request.setForce(options.force);
  request.setOrder(as_text(options.order));
  request.setWho(as_text(options.who));
}

/// Whether the text of a file fits into a message.
Result<void> check_text(std::string_view text) {
  return detail::check_size(Value(text), detail::kServerMessageWords);
}

class Client final : public RobotService {
 public:
  explicit Client(std::shared_ptr<RpcChannel> channel) : channel_(std::move(channel)) {}

  Result<Value> status() override {
    return channel_->ask(kLookTimeout, [](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().statusRequest();
      return RpcChannel::send(request);
    });
  }

  Result<Value> task(std::string_view id) override {
    return channel_->ask(kLookTimeout, [id = std::string(id)](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().taskRequest();
      request.setId(as_text(id));
      return RpcChannel::send(request);
    });
  }

  Result<Value> switch_to(std::string_view controller, const SwitchOptions& options,
                          TimePoint deadline) override {
    const Duration left = time_left(deadline);
    return channel_->ask(left + kGrace, [left, options, controller = std::string(controller)](
                                            RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().switchToRequest();
      request.setController(as_text(controller));
      set_options(request, options);
      request.setTimeout(left.count());
      return RpcChannel::send(request);
    });
  }

  Result<Value> switch_to_network(std::string_view network, std::string_view file,
                                  const SwitchOptions& options, TimePoint deadline) override {
    if (auto fits = check_text(network); !fits) return fits.error();
    const Duration left = time_left(deadline);
    return channel_->ask(left + kGrace, [&, file = std::string(file)](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().switchToNetworkRequest();
      request.setText(detail::as_data(network));
      request.setFile(as_text(file));
      set_options(request, options);
      request.setTimeout(left.count());
      return RpcChannel::send(request);
    });
  }

  Result<Value> plan(std::string_view controller, const SwitchOptions& options, TimePoint deadline) override {
    const Duration left = time_left(deadline);
    return channel_->ask(left + kGrace,
                         [&, controller = std::string(controller)](RpcChannel::Connection& connection) {
                           auto request = connection.as<wire::Robot>().planRequest();
                           request.setTimeout(left.count());
                           request.setController(as_text(controller));
                           request.setForce(options.force);
                           request.setOrder(as_text(options.order));
                           return RpcChannel::send(request);
                         });
  }

  Result<Value> apply(const SwitchOptions& options, TimePoint deadline) override {
    const Duration left = time_left(deadline);
    return channel_->ask(left + kGrace, [left, options](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().applyFilesRequest();
      request.setForce(options.force);
      request.setOrder(as_text(options.order));
      request.setWho(as_text(options.who));
      request.setTimeout(left.count());
      return RpcChannel::send(request);
    });
  }

  Result<Value> prepare(const std::vector<std::string>& controllers, TimePoint deadline) override {
    const Duration left = time_left(deadline);
    return channel_->ask(left + kGrace, [left, controllers](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().prepareRequest();
      auto names = request.initControllers(static_cast<unsigned>(controllers.size()));
      for (unsigned i = 0; i < names.size(); ++i)
        names.set(i, as_text(controllers[i]));
      request.setTimeout(left.count());
      return RpcChannel::send(request);
    });
  }

  Result<Value> apply_transition(std::string_view transition, std::string_view file,
                                 TimePoint deadline) override {
    if (auto fits = check_text(transition); !fits) return fits.error();
    const Duration left = time_left(deadline);
    return channel_->ask(left + kGrace, [&, file = std::string(file)](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().applyTransitionRequest();
      request.setText(detail::as_data(transition));
      request.setFile(as_text(file));
      request.setTimeout(left.count());
      return RpcChannel::send(request);
    });
  }

  Result<void> reset_belief() override {
    return without_value(channel_->ask(kLookTimeout, [](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().resetBeliefRequest();
      return RpcChannel::send(request);
    }));
  }

  Result<void> set_property(std::string_view task, std::string_view property, const Value& value,
                            TimePoint deadline) override {
    if (auto fits = detail::check_size(value, detail::kServerMessageWords); !fits) return fits;
    const Duration left = time_left(deadline);
    return without_value(
        channel_->ask(left + kGrace, [&](RpcChannel::Connection& connection) -> RpcChannel::Answer {
          auto request = connection.as<wire::Robot>().setPropertyRequest();
          request.setTask(as_text(std::string(task)));
          request.setProperty(as_text(std::string(property)));
          request.setTimeout(left.count());
          if (auto done = detail::encode(value, request.initValue()); !done)
            return Result<Value>(done.error());
          return RpcChannel::send(request);
        }));
  }

  Result<Value> call(std::string_view task, std::string_view operation, const Value& arguments,
                     TimePoint deadline) override {
    if (auto fits = detail::check_size(arguments, detail::kServerMessageWords); !fits) return fits.error();
    const Duration left = time_left(deadline);
    return channel_->ask(left + kGrace, [&](RpcChannel::Connection& connection) -> RpcChannel::Answer {
      auto request = connection.as<wire::Robot>().callRequest();
      request.setTask(as_text(std::string(task)));
      request.setOperation(as_text(std::string(operation)));
      request.setTimeout(left.count());
      if (auto done = detail::encode(arguments, request.initArguments()); !done) {
        return Result<Value>(done.error());
      }
      return RpcChannel::send(request);
    });
  }

  Result<std::unique_ptr<SampleStream>> open_port(std::string_view task, std::string_view port,
                                                  std::size_t buffer) override {
    const RpcChannel::StreamId id = channel_->new_stream_id();
    auto type = channel_->ask(kLookTimeout, [&, id](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().openPortRequest();
      request.setTask(as_text(std::string(task)));
      request.setPort(as_text(std::string(port)));
      request.setBuffer(static_cast<std::uint32_t>(std::min<std::size_t>(buffer, UINT32_MAX)));
      return connection.open(id, request);
    });
    return detail::opened_stream(channel_, id, type);
  }

  Result<Value> events(std::uint64_t after, Duration wait) override {
    const Duration patience = std::max(wait, Duration(0));
    return channel_->ask(patience + kLookTimeout, [after, patience](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().eventsRequest();
      request.setAfter(after);
      request.setWait(patience.count());
      return RpcChannel::send(request);
    });
  }

  Result<Value> history() override {
    return channel_->ask(kLookTimeout, [](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().historyRequest();
      return RpcChannel::send(request);
    });
  }

  Result<void> shut_down() override {
    return without_value(channel_->ask(kLookTimeout, [](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().shutDownRequest();
      return RpcChannel::send(request);
    }));
  }

 private:
  std::shared_ptr<RpcChannel> channel_;
};

}  // namespace

Result<std::unique_ptr<RobotService>> connect(const Endpoint& endpoint, Duration timeout) {
  auto channel =
      RpcChannel::open(endpoint, detail::kRobotKind, "robot " + quote(detail::name_of(endpoint)), timeout);
  if (!channel) return channel.error();
  return std::make_unique<Client>(std::move(*channel));
}

}  // namespace segue::control
