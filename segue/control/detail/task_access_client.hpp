// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/detail/batch_client.hpp>
#include <segue/control/detail/stream_client.hpp>
#include <segue/control/detail/watch_client.hpp>
#include <segue/rpc/detail/rpc_channel.hpp>
#include <segue/rpc_codecs/tasks_wire.hpp>
#include <segue/task_host/task_access.hpp>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace segue::control::detail {

/// A stream of samples as the reader of a port; a stream that cannot be read any more has no samples.
class ClientReader final : public task_host::PortReader {
 public:
  explicit ClientReader(std::unique_ptr<SampleStream> stream) : stream_(std::move(stream)) {}
  std::vector<type::Value> read(std::size_t limit) override {
    auto samples = stream_->read(limit);
    return samples ? std::move(*samples) : std::vector<type::Value>();
  }
  void next(std::size_t limit, const Wait& wait, task_host::SamplesAnswer answered) override {
    stream_->next(limit, wait, std::move(answered));
  }
  [[nodiscard]] std::string type_name() const override { return stream_->type_name(); }

 private:
  std::unique_ptr<SampleStream> stream_;
};

/// The part of a client that is about tasks: `Service` is a task_host::TaskAccess, whose other functions the
/// derived client has. Thread safe, except in the channel's own thread.
template <class Service>
class TaskAccessClient : public Service {
 public:
  void begin_all(std::vector<model::Action> actions, TimePoint deadline,
                 task_host::Completion completed) override {
    batches_.begin(std::move(actions), deadline, std::move(completed));
  }

  Result<std::optional<task::SavedState>> save_state(const model::TaskId& task, TimePoint deadline) override {
    using State = std::optional<task::SavedState>;
    const Duration left = time_left(deadline);
    return ask<State>(left + kGrace, [&](wire::TaskAccess::Client tasks) {
      auto request = tasks.saveStateRequest();
      request.setTask(as_text(task.str()));
      request.setTimeout(left.count());
      return RpcChannel::send<State>(request, [](auto& results) {
        return results.hasState() ? State(decode(results.getState())) : State();
      });
    });
  }

  Result<void> restore_state(const model::TaskId& task, const task::SavedState& state,
                             TimePoint deadline) override {
    const Duration left = time_left(deadline);
    return ask<void>(left + kGrace, [&](wire::TaskAccess::Client tasks) {
      auto request = tasks.restoreStateRequest();
      request.setTask(as_text(task.str()));
      request.setTimeout(left.count());
      encode(state, request.initState());
      return RpcChannel::send<void>(request, [](auto&) { return Result<void>(); });
    });
  }

  Result<model::ComponentModel> describe(const model::TaskId& task) const override {
    return ask<model::ComponentModel>(kQueryTimeout, [&](wire::TaskAccess::Client tasks) {
      auto request = tasks.describeRequest();
      request.setTask(as_text(task.str()));
      return RpcChannel::send<model::ComponentModel>(
          request, [](auto& results) { return decode(results.getModel()); });
    });
  }

  Result<type::Value> properties(const model::TaskId& task) const override {
    return ask<type::Value>(kQueryTimeout, [&](wire::TaskAccess::Client tasks) {
      auto request = tasks.propertiesRequest();
      request.setTask(as_text(task.str()));
      return RpcChannel::send(request);
    });
  }

  void watch(const task_host::LevelQuestion& question, const Wait& wait,
             task_host::LevelAnswer answered) override {
    send_watch<task_host::TaskLevel>(
        *channel_, question, wait, std::move(answered),
        [tasks = tasks_](RpcChannel::Connection& connection) { return tasks(connection).watchRequest(); },
        [](auto& results) { return decode(results.getLevel()); });
  }

  Result<task_host::TaskDetails> details(const model::TaskId& task) const override {
    return ask<task_host::TaskDetails>(kQueryTimeout, [&](wire::TaskAccess::Client tasks) {
      auto request = tasks.detailsRequest();
      request.setTask(as_text(task.str()));
      return RpcChannel::send<task_host::TaskDetails>(
          request, [](auto& results) { return decode(results.getDetails()); });
    });
  }

  Result<void> set_property(const model::TaskId& task, std::string_view path, const type::Value& value,
                            TimePoint deadline) override {
    const Duration left = time_left(deadline);
    return ask<void>(left + kGrace, [&](wire::TaskAccess::Client tasks) {
      auto request = tasks.setPropertyRequest();
      request.setTask(as_text(task.str()));
      request.setPath(as_text(std::string(path)));
      request.setTimeout(left.count());
      put(value, request.initValue());
      return RpcChannel::send<void>(request, [](auto&) { return Result<void>(); });
    });
  }

  Result<type::Value> call(const model::TaskId& task, std::string_view operation,
                           const type::Value& arguments, TimePoint deadline) override {
    const Duration left = time_left(deadline);
    return ask<type::Value>(left + kGrace, [&](wire::TaskAccess::Client tasks) {
      auto request = tasks.callRequest();
      request.setTask(as_text(task.str()));
      request.setOperation(as_text(std::string(operation)));
      request.setTimeout(left.count());
      put(arguments, request.initArguments());
      return RpcChannel::send(request);
    });
  }

  Result<void> write(const model::PortRef& port, const type::Value& value, TimePoint deadline) override {
    const Duration left = time_left(deadline);
    return ask<void>(left + kGrace, [&](wire::TaskAccess::Client tasks) {
      auto request = tasks.writeRequest();
      encode(port, request.initPort());
      request.setTimeout(left.count());
      put(value, request.initValue());
      return RpcChannel::send<void>(request, [](auto&) { return Result<void>(); });
    });
  }

  Result<std::unique_ptr<task_host::PortReader>> open_reader(const model::PortRef& port,
                                                             std::size_t buffer) override {
    const RpcChannel::StreamId id = channel_->new_stream_id();
    auto type = channel_->ask(kQueryTimeout, [&, id](RpcChannel::Connection& connection) {
      auto request = tasks_(connection).openReaderRequest();
      encode(port, request.initPort());
      request.setBuffer(static_cast<std::uint32_t>(std::min<std::size_t>(buffer, UINT32_MAX)));
      return connection.open(id, request);
    });
    auto stream = opened_stream(channel_, id, type);
    if (!stream) return stream.error();
    return std::make_unique<ClientReader>(std::move(*stream));
  }

 protected:
  /// `tasks` gives the other side's capability, in the loop of the channel.
  TaskAccessClient(std::shared_ptr<RpcChannel> channel, TasksOf tasks)
      : channel_(std::move(channel)), tasks_(std::move(tasks)), batches_(channel_, tasks_) {}
  [[nodiscard]] RpcChannel& channel() const { return *channel_; }
  [[nodiscard]] BatchClient& batches() { return batches_; }

 private:
  template <class T, class Build>
  Result<T> ask(Duration timeout, const Build& build) const {
    return channel_->ask<T>(timeout,
                            [&](RpcChannel::Connection& connection) { return build(tasks_(connection)); });
  }

  const std::shared_ptr<RpcChannel> channel_;
  const TasksOf tasks_;
  BatchClient batches_;
};

}  // namespace segue::control::detail
