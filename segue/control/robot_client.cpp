// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc_codecs/robot.capnp.h>
#include <segue/base/text.hpp>
#include <segue/control/detail/lease_client.hpp>
#include <segue/control/detail/request_codec.hpp>
#include <segue/control/detail/services.hpp>
#include <segue/control/detail/stream_client.hpp>
#include <segue/control/detail/watch_client.hpp>
#include <segue/control/server.hpp>
#include <segue/rpc/detail/rpc_channel.hpp>
#include <segue/rpc/detail/wire.hpp>

#include <algorithm>
#include <string>
#include <utility>

namespace segue::control {

namespace {

using detail::as_text;
using detail::kGrace;
using detail::kQueryTimeout;
using detail::RpcChannel;
using detail::time_left;
using type::Value;

/// Of whoever waits for events; a longer time could not be added to.
constexpr Duration kLongestPatience = std::chrono::hours(24);

/// 0 where it is none.
std::uint64_t number_in(const Value* value) {
  if (value == nullptr || !value->is_integer()) return 0;
  if (value->kind() == Value::Kind::UInt) return value->as_uint();
  return static_cast<std::uint64_t>(std::max<std::int64_t>(value->as_int(), 0));
}

Result<void> without_value(const Result<Value>& answer) {
  if (!answer) return answer.error();
  return {};
}

/// Whether the text of a file fits into a message.
Result<void> check_text(std::string_view text) {
  return detail::check_size(Value(text), detail::kServerMessageWords);
}

class Client final : public RobotService {
 public:
  explicit Client(std::shared_ptr<RpcChannel> channel) : channel_(std::move(channel)) {}

  Result<Value> status(const Wait& wait) override {
    return query(wait, [](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().statusRequest();
      return RpcChannel::send(request);
    });
  }

  using RobotService::task;
  Result<Value> task(std::string_view id, const Wait& wait) override {
    return query(wait, [id = std::string(id)](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().taskRequest();
      request.setId(as_text(id));
      return RpcChannel::send(request);
    });
  }

  void watch(const task_host::LevelQuestion& question, const Wait& wait, RobotLevelAnswer answered) override {
    detail::send_watch<RobotLevel>(
        *channel_, question, wait, std::move(answered),
        [](RpcChannel::Connection& connection) { return connection.as<wire::Robot>().watchRequest(); },
        [](auto& results) {
          return RobotLevel{detail::decode(results.getLevel()), results.getChanges()};
        });
  }

  Result<Value> running(std::uint64_t lease, const Wait& wait) override {
    return query(wait, [lease](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().runningRequest();
      request.setLease(lease);
      return RpcChannel::send(request);
    });
  }

  void changes(std::uint64_t seen, const Wait& wait, ChangesAnswer answered) override {
    detail::ask_later<std::uint64_t>(
        *channel_, wait, std::move(answered), [seen](RpcChannel::Connection& connection, Duration left) {
          auto request = connection.as<wire::Robot>().changesRequest();
          request.setSeen(seen);
          request.setTimeout(left.count());
          return RpcChannel::send<std::uint64_t>(
              request, [](auto& results) { return Result<std::uint64_t>(results.getCount()); });
        });
  }

  Result<Value> switch_to(std::string_view controller, const RequestOptions& options,
                          const Wait& wait) override {
    return switch_or_diff(controller, false, options, wait);
  }

  Result<Value> diff(std::string_view controller, const RequestOptions& options, const Wait& wait) override {
    return switch_or_diff(controller, true, options, wait);
  }

  Result<Value> switch_to_network(std::string_view network, std::string_view file,
                                  const RequestOptions& options, TimePoint deadline) override {
    return switch_or_diff_to_network(network, file, false, options, deadline);
  }

  Result<Value> diff_to_network(std::string_view network, std::string_view file,
                                const RequestOptions& options, TimePoint deadline) override {
    return switch_or_diff_to_network(network, file, true, options, deadline);
  }

  Result<Value> plan(std::string_view controller, const RequestOptions& options,
                     TimePoint deadline) override {
    return request(deadline, options, [controller = std::string(controller)](wire::Robot::Client robot) {
      auto plan = robot.planRequest();
      plan.setController(as_text(controller));
      return plan;
    });
  }

  Result<Value> apply(const RequestOptions& options, TimePoint deadline) override {
    return request(deadline, options, [](wire::Robot::Client robot) { return robot.applyFilesRequest(); });
  }

  Result<Value> repair(const RequestOptions& options, const Wait& wait) override {
    return request(wait, options, [](wire::Robot::Client robot) { return robot.repairRequest(); });
  }

  Result<Value> conflicts(const std::vector<std::string>& controllers, const Wait& wait) override {
    return query(wait, [&](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().conflictsRequest();
      auto names = request.initControllers(static_cast<unsigned>(controllers.size()));
      for (unsigned i = 0; i < names.size(); ++i)
        names.set(i, as_text(controllers[i]));
      return RpcChannel::send(request);
    });
  }

  Result<std::unique_ptr<RobotLease>> lease(std::string_view holder) override {
    const RpcChannel::StreamId id = channel_->new_stream_id();
    const auto answer =
        channel_->ask(kQueryTimeout, [holder = std::string(holder), id](RpcChannel::Connection& connection) {
          auto request = connection.as<wire::Robot>().leaseRequest();
          request.setHolder(as_text(holder));
          return connection.open(id, request);
        });
    return detail::opened_lease(channel_, id, answer);
  }

  Result<void> report(std::uint64_t lease, const Value& doing) override {
    if (auto fits = detail::check_size(doing, detail::kServerMessageWords); !fits) return fits;
    return without_value(
        channel_->ask(kQueryTimeout, [&](RpcChannel::Connection& connection) -> RpcChannel::Answer {
          auto request = connection.as<wire::Robot>().reportRequest();
          request.setLease(lease);
          if (auto done = detail::encode(doing, request.initDoing()); !done)
            return Result<Value>(done.error());
          return RpcChannel::send(request);
        }));
  }

  Result<Value> mission(std::uint64_t after, bool with_plan) override {
    return channel_->ask(kQueryTimeout, [after, with_plan](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().missionRequest();
      request.setAfter(after);
      request.setWithPlan(with_plan);
      return RpcChannel::send(request);
    });
  }

  Result<std::uint64_t> send_command(std::string_view what, const Value& arguments) override {
    if (auto fits = detail::check_size(arguments, detail::kServerMessageWords); !fits) return fits.error();
    const auto number = channel_->ask(
        kQueryTimeout,
        [what = std::string(what), arguments](RpcChannel::Connection& connection) -> RpcChannel::Answer {
          auto request = connection.as<wire::Robot>().sendCommandRequest();
          request.setWhat(as_text(what));
          if (auto done = detail::encode(arguments, request.initArguments()); !done)
            return Result<Value>(done.error());
          return RpcChannel::send(request);
        });
    if (!number) return number.error();
    return number_in(&*number);
  }

  Result<Value> cancel(std::uint64_t number, std::string_view who, TimePoint deadline) override {
    const Duration left = time_left(deadline);
    return channel_->ask(left + kGrace,
                         [left, number, who = std::string(who)](RpcChannel::Connection& connection) {
                           auto request = connection.as<wire::Robot>().cancelRequest();
                           request.setRequest(number);
                           request.setWho(as_text(who));
                           request.setTimeout(left.count());
                           return RpcChannel::send(request);
                         });
  }

  Result<Value> give_back(std::uint64_t lease, bool keep, TimePoint deadline) override {
    const Duration left = time_left(deadline);
    return channel_->ask(left + kGrace, [left, lease, keep](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().giveBackRequest();
      request.setLease(lease);
      request.setKeep(keep);
      request.setTimeout(left.count());
      return RpcChannel::send(request);
    });
  }

  Result<Value> stop(std::string_view who, TimePoint deadline) override {
    const Duration left = time_left(deadline);
    return channel_->ask(left + kGrace, [left, who = std::string(who)](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().stopRequest();
      request.setWho(as_text(who));
      request.setTimeout(left.count());
      return RpcChannel::send(request);
    });
  }

  Result<void> release_stop(std::string_view who) override {
    return without_value(
        channel_->ask(kQueryTimeout, [who = std::string(who)](RpcChannel::Connection& connection) {
          auto request = connection.as<wire::Robot>().releaseRequest();
          request.setWho(as_text(who));
          return RpcChannel::send(request);
        }));
  }

  Result<Value> prepare(const std::vector<std::string>& controllers, std::uint64_t lease,
                        const Wait& wait) override {
    return ask(wait, [&](RpcChannel::Connection& connection, Duration left) {
      auto request = connection.as<wire::Robot>().prepareRequest();
      request.setLease(lease);
      auto names = request.initControllers(static_cast<unsigned>(controllers.size()));
      for (unsigned i = 0; i < names.size(); ++i)
        names.set(i, as_text(controllers[i]));
      request.setTimeout(left.count());
      return RpcChannel::send(request);
    });
  }

  Result<Value> apply_transition(const GivenTransition& transition, const RequestOptions& options,
                                 TimePoint deadline) override {
    if (auto fits = check_text(transition.text); !fits) return fits.error();
    return request(deadline, options, [&](wire::Robot::Client robot) {
      auto request = robot.applyTransitionRequest();
      request.setName(as_text(transition.name));
      request.setText(detail::as_data(transition.text));
      request.setFile(as_text(transition.file));
      return request;
    });
  }

  Result<void> reset_belief(std::string_view network, std::string_view file) override {
    if (auto fits = check_text(network); !fits) return fits;
    return without_value(channel_->ask(kQueryTimeout, [&](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().resetBeliefRequest();
      request.setNetwork(detail::as_data(network));
      request.setFile(as_text(std::string(file)));
      return RpcChannel::send(request);
    }));
  }

  Result<Value> units() override {
    return channel_->ask(kQueryTimeout, [](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().unitsRequest();
      return RpcChannel::send(request);
    });
  }

  Result<std::uint32_t> set_units(std::string_view name, std::uint32_t count, std::string_view who) override {
    const auto before = channel_->ask(
        kQueryTimeout,
        [name = std::string(name), count, who = std::string(who)](RpcChannel::Connection& connection) {
          auto request = connection.as<wire::Robot>().setUnitsRequest();
          request.setName(as_text(name));
          request.setCount(count);
          request.setWho(as_text(who));
          return RpcChannel::send(request);
        });
    if (!before) return before.error();
    return static_cast<std::uint32_t>(number_in(&*before));
  }

  Result<void> set_property(std::string_view task, std::string_view property, const Value& value,
                            const Sender& sender, const Wait& wait) override {
    if (auto fits = detail::check_size(value, detail::kServerMessageWords); !fits) return fits;
    return without_value(
        ask(wait, [&](RpcChannel::Connection& connection, Duration left) -> RpcChannel::Answer {
          auto request = connection.as<wire::Robot>().setPropertyRequest();
          detail::encode(sender, request.initSender());
          request.setTask(as_text(std::string(task)));
          request.setProperty(as_text(std::string(property)));
          request.setTimeout(left.count());
          if (auto done = detail::encode(value, request.initValue()); !done)
            return Result<Value>(done.error());
          return RpcChannel::send(request);
        }));
  }

  Result<void> write(std::string_view task, std::string_view port, const Value& value, const Sender& sender,
                     const Wait& wait) override {
    if (auto fits = detail::check_size(value, detail::kServerMessageWords); !fits) return fits;
    return without_value(
        ask(wait, [&](RpcChannel::Connection& connection, Duration left) -> RpcChannel::Answer {
          auto request = connection.as<wire::Robot>().writeRequest();
          detail::encode(sender, request.initSender());
          request.setTask(as_text(std::string(task)));
          request.setPort(as_text(std::string(port)));
          request.setTimeout(left.count());
          if (auto done = detail::encode(value, request.initValue()); !done)
            return Result<Value>(done.error());
          return RpcChannel::send(request);
        }));
  }

  Result<Value> call(std::string_view task, std::string_view operation, const Value& arguments,
                     const Sender& sender, const Wait& wait) override {
    if (auto fits = detail::check_size(arguments, detail::kServerMessageWords); !fits) return fits.error();
    return ask(wait, [&](RpcChannel::Connection& connection, Duration left) -> RpcChannel::Answer {
      auto request = connection.as<wire::Robot>().callRequest();
      detail::encode(sender, request.initSender());
      request.setTask(as_text(std::string(task)));
      request.setOperation(as_text(std::string(operation)));
      request.setTimeout(left.count());
      if (auto done = detail::encode(arguments, request.initArguments()); !done) {
        return Result<Value>(done.error());
      }
      return RpcChannel::send(request);
    });
  }

  void take_instance(const model::InstanceQuestion& what, const Wait& wait,
                     model::InstanceAnswer answered) override {
    detail::ask_later<model::TakenInstance>(
        *channel_, wait, std::move(answered), [what](RpcChannel::Connection& connection, Duration left) {
          auto request = connection.as<wire::Robot>().takeInstanceRequest();
          request.setPool(as_text(what.pool));
          request.setLost(as_text(what.lost.task));
          request.setLostPid(what.lost.pid);
          request.setTimeout(left.count());
          return RpcChannel::send<model::TakenInstance>(request, [](auto& results) {
            return Result<model::TakenInstance>({detail::as_string(results.getTask()), results.getPid()});
          });
        });
  }

  Result<std::unique_ptr<SampleStream>> open_port(std::string_view task, std::string_view port,
                                                  std::size_t buffer, const Wait& wait) override {
    const RpcChannel::StreamId id = channel_->new_stream_id();
    auto type = query(wait, [&, id](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().openPortRequest();
      request.setTask(as_text(std::string(task)));
      request.setPort(as_text(std::string(port)));
      request.setBuffer(static_cast<std::uint32_t>(std::min<std::size_t>(buffer, UINT32_MAX)));
      return connection.open(id, request);
    });
    return detail::opened_stream(channel_, id, type);
  }

  Result<Value> events(std::uint64_t after, const Wait& wait) override {
    const Duration patience = std::min(time_left(wait.deadline), kLongestPatience);
    const auto begin = [after, patience](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().eventsRequest();
      request.setAfter(after);
      request.setWait(patience.count());
      return RpcChannel::send(request);
    };
    return channel_->ask(patience + kQueryTimeout, begin, wait.stop);
  }

  Result<Value> past(const Value& question) override {
    if (auto fits = detail::check_size(question, detail::kServerMessageWords); !fits) return fits.error();
    return channel_->ask(kQueryTimeout, [&](RpcChannel::Connection& connection) -> RpcChannel::Answer {
      auto request = connection.as<wire::Robot>().pastRequest();
      if (auto done = detail::encode(question, request.initQuestion()); !done)
        return Result<Value>(done.error());
      return RpcChannel::send(request);
    });
  }

  Result<Value> history() override {
    return channel_->ask(kQueryTimeout, [](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().historyRequest();
      return RpcChannel::send(request);
    });
  }

  Result<void> shut_down() override {
    return without_value(channel_->ask(kQueryTimeout, [](RpcChannel::Connection& connection) {
      auto request = connection.as<wire::Robot>().shutDownRequest();
      return RpcChannel::send(request);
    }));
  }

 private:
  template <class Build>
  Result<Value> query(const Wait& wait, const Build& build) {
    return channel_->ask(detail::query_timeout(wait), build, wait.stop);
  }

  /// `build(connection, left)`: the call, which the robot is to answer within that time.
  template <class Build>
  Result<Value> ask(const Wait& wait, const Build& build) {
    const Duration left = time_left(wait.deadline);
    const auto begin = [&](RpcChannel::Connection& connection) -> RpcChannel::Answer {
      return build(connection, left);
    };
    return channel_->ask(left + kGrace, begin, wait.stop);
  }

  /// A call with options, which `begin(robot)` begins and the robot is to answer by then.
  template <class Begin>
  Result<Value> request(const Wait& wait, const RequestOptions& options, const Begin& begin) {
    return ask(wait, [&](RpcChannel::Connection& connection, Duration left) -> RpcChannel::Answer {
      auto request = begin(connection.as<wire::Robot>());
      request.setTimeout(left.count());
      if (auto done = detail::encode(options, request.initOptions()); !done)
        return Result<Value>(done.error());
      return RpcChannel::send(request);
    });
  }

  Result<Value> switch_or_diff(std::string_view controller, bool dry_run, const RequestOptions& options,
                               const Wait& wait) {
    return request(wait, options, [&](wire::Robot::Client robot) {
      auto request = robot.switchToRequest();
      request.setController(as_text(std::string(controller)));
      request.setDryRun(dry_run);
      return request;
    });
  }

  Result<Value> switch_or_diff_to_network(std::string_view network, std::string_view file, bool dry_run,
                                          const RequestOptions& options, const Wait& wait) {
    if (auto fits = check_text(network); !fits) return fits.error();
    return request(wait, options, [&](wire::Robot::Client robot) {
      auto request = robot.switchToNetworkRequest();
      request.setText(detail::as_data(network));
      request.setFile(as_text(std::string(file)));
      request.setDryRun(dry_run);
      return request;
    });
  }

  std::shared_ptr<RpcChannel> channel_;
};

}  // namespace

Result<std::unique_ptr<RobotService>> connect(const Endpoint& endpoint, Duration timeout,
                                              const std::stop_token& stop) {
  auto channel = RpcChannel::open(endpoint, detail::kRobotKind, "robot " + quote(detail::name_of(endpoint)),
                                  timeout, {}, stop);
  if (!channel) return channel.error();
  return std::make_unique<Client>(std::move(*channel));
}

}  // namespace segue::control
