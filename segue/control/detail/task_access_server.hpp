// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc_codecs/tasks.capnp.h>
#include <segue/control/detail/batch_server.hpp>
#include <segue/control/detail/stream_server.hpp>
#include <segue/control/detail/watch_server.hpp>
#include <segue/control/reader_stream.hpp>
#include <segue/rpc/detail/caller.hpp>
#include <segue/rpc_codecs/tasks_wire.hpp>
#include <segue/task_host/task_access.hpp>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

namespace segue::control::detail {

/// Offers a TaskAccess to one client; the servers of deployment processes and of robots on hosts are this and
/// more. Only for use in the event loop.
class TaskAccessServer : public virtual wire::TaskAccess::Server {
 public:
  kj::Promise<void> perform(PerformContext context) override {
    const auto params = context.getParams();
    const TimePoint deadline = deadline_after(params.getTimeout());
    return answer_batch(context, batch_of(params), caller_, tasks_, follower_,
                        [&](std::vector<model::Action> actions, task_host::Completion completed) {
                          tasks_->begin_all(std::move(actions), deadline, std::move(completed));
                        });
  }

  kj::Promise<void> follow(FollowContext context) override {
    *follower_ = context.getParams().getFollower();
    return kj::READY_NOW;
  }

  kj::Promise<void> saveState(SaveStateContext context) override {
    const auto params = context.getParams();
    return caller_.answer(
        context,
        [tasks = tasks_, task = model::TaskId(as_string(params.getTask())),
         deadline = deadline_after(params.getTimeout())] { return tasks->save_state(task, deadline); },
        [](std::optional<task::SavedState>& state, auto results) {
          if (state) encode(*state, results.initState());
        });
  }

  kj::Promise<void> restoreState(RestoreStateContext context) override {
    const auto params = context.getParams();
    return caller_.answer(
        context, [tasks = tasks_, task = model::TaskId(as_string(params.getTask())),
                  state = decode(params.getState()), deadline = deadline_after(params.getTimeout())] {
          return tasks->restore_state(task, state, deadline);
        });
  }

  kj::Promise<void> describe(DescribeContext context) override {
    return caller_.answer(
        context,
        [tasks = tasks_, task = model::TaskId(as_string(context.getParams().getTask()))] {
          return tasks->describe(task);
        },
        [](model::ComponentModel& model, auto results) { encode(model, results.initModel()); });
  }

  kj::Promise<void> properties(PropertiesContext context) override {
    return caller_.answer_value(
        context, [tasks = tasks_, task = model::TaskId(as_string(context.getParams().getTask()))] {
          return tasks->properties(task);
        });
  }

  kj::Promise<void> watch(WatchContext context) override {
    return answer_watch<task_host::TaskLevel>(
        Role::Observe, caller_, context,
        [tasks = tasks_](const task_host::LevelQuestion& question, const Wait& wait,
                         task_host::LevelAnswer answered) {
          tasks->watch(question, wait, std::move(answered));
        },
        [](const task_host::TaskLevel& level, auto results) { encode(level, results.initLevel()); });
  }

  kj::Promise<void> details(DetailsContext context) override {
    return caller_.answer(
        context,
        [tasks = tasks_, task = model::TaskId(as_string(context.getParams().getTask()))] {
          return tasks->details(task);
        },
        [](task_host::TaskDetails& details, auto results) { encode(details, results.initDetails()); });
  }

  kj::Promise<void> setProperty(SetPropertyContext context) override {
    const auto params = context.getParams();
    return caller_.answer(context, [tasks = tasks_, task = model::TaskId(as_string(params.getTask())),
                                    path = as_string(params.getPath()), value = get(params.getValue()),
                                    deadline = deadline_after(params.getTimeout())] {
      return tasks->set_property(task, path, value, deadline);
    });
  }

  kj::Promise<void> call(CallContext context) override {
    const auto params = context.getParams();
    return caller_.answer_value(
        context, [tasks = tasks_, task = model::TaskId(as_string(params.getTask())),
                  operation = as_string(params.getOperation()), arguments = get(params.getArguments()),
                  deadline = deadline_after(params.getTimeout())] {
          return tasks->call(task, operation, arguments, deadline);
        });
  }

  kj::Promise<void> write(WriteContext context) override {
    const auto params = context.getParams();
    return caller_.answer(
        context,
        [tasks = tasks_, port = decode(params.getPort()), value = get(params.getValue()),
         deadline = deadline_after(params.getTimeout())] { return tasks->write(port, value, deadline); });
  }

  kj::Promise<void> openReader(OpenReaderContext context) override {
    const auto params = context.getParams();
    auto open = [tasks = tasks_, port = decode(params.getPort()),
                 buffer = std::min<std::size_t>(params.getBuffer(),
                                                kMaxBuffer)]() -> Result<std::unique_ptr<SampleStream>> {
      auto reader = tasks->open_reader(port, buffer);
      if (!reader) return reader.error();
      return std::make_unique<ReaderStream>(std::move(*reader));
    };
    return answer_stream(caller_, context, std::move(open));
  }

 protected:
  /// Calls in progress keep `tasks`, so the last of them may destroy it, on any thread.
  TaskAccessServer(Caller caller, std::shared_ptr<task_host::TaskAccess> tasks)
      : caller_(std::move(caller)), tasks_(std::move(tasks)) {}
  [[nodiscard]] const Follower& follower() const { return follower_; }

 private:
  Caller caller_;
  const std::shared_ptr<task_host::TaskAccess> tasks_;
  const Follower follower_ = std::make_shared<kj::Maybe<wire::BatchFollower::Client>>();
};

}  // namespace segue::control::detail
