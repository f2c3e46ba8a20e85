// SPDX-License-Identifier: Apache-2.0
#include <segue/control/detail/stream_server.hpp>
#include <segue/control/detail/task_access_server.hpp>
#include <segue/control/detail/watch_server.hpp>
#include <segue/control/reader_stream.hpp>
#include <segue/rpc_codecs/tasks_wire.hpp>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

namespace segue::control::detail {

TaskAccessServer::TaskAccessServer(Caller caller, std::shared_ptr<deploy::TaskAccess> tasks)
    : caller_(std::move(caller)), tasks_(std::move(tasks)) {}

kj::Promise<void> TaskAccessServer::perform(PerformContext context) {
  const auto params = context.getParams();
  const TimePoint deadline = deadline_after(params.getTimeout());
  return answer_batch(context, batch_of(params), caller_, tasks_, follower_,
                      [&](std::vector<model::Action> actions, task_host::Completion completed) {
                        tasks_->begin_all(std::move(actions), deadline, std::move(completed));
                      });
}

kj::Promise<void> TaskAccessServer::follow(FollowContext context) {
  *follower_ = context.getParams().getFollower();
  return kj::READY_NOW;
}

kj::Promise<void> TaskAccessServer::saveState(SaveStateContext context) {
  const auto params = context.getParams();
  return caller_.answer(
      context,
      [tasks = tasks_, task = model::TaskId(as_string(params.getTask())),
       deadline = deadline_after(params.getTimeout())] { return tasks->save_state(task, deadline); },
      [](std::optional<task::SavedState>& state, auto results) {
        if (state) encode(*state, results.initState());
      });
}

kj::Promise<void> TaskAccessServer::restoreState(RestoreStateContext context) {
  const auto params = context.getParams();
  return caller_.answer(context,
                        [tasks = tasks_, task = model::TaskId(as_string(params.getTask())),
                         state = decode(params.getState()), deadline = deadline_after(params.getTimeout())] {
                          return tasks->restore_state(task, state, deadline);
                        });
}

kj::Promise<void> TaskAccessServer::describe(DescribeContext context) {
  return caller_.answer(
      context,
      [tasks = tasks_, task = model::TaskId(as_string(context.getParams().getTask()))] {
        return tasks->describe(task);
      },
      [](model::ComponentModel& model, auto results) { encode(model, results.initModel()); });
}

kj::Promise<void> TaskAccessServer::properties(PropertiesContext context) {
  return caller_.answer_value(
      context, [tasks = tasks_, task = model::TaskId(as_string(context.getParams().getTask()))] {
        return tasks->properties(task);
      });
}

kj::Promise<void> TaskAccessServer::watch(WatchContext context) {
  return answer_watch<task_host::TaskLevel>(
      Role::Observe, caller_, context,
      [tasks = tasks_](const task_host::LevelQuestion& question, const Wait& wait,
                       task_host::LevelAnswer answered) {
        tasks->watch(question, wait, std::move(answered));
      },
      [](const task_host::TaskLevel& level, auto results) { encode(level, results.initLevel()); });
}

kj::Promise<void> TaskAccessServer::details(DetailsContext context) {
  return caller_.answer(
      context,
      [tasks = tasks_, task = model::TaskId(as_string(context.getParams().getTask()))] {
        return tasks->details(task);
      },
      [](task_host::TaskDetails& details, auto results) { encode(details, results.initDetails()); });
}

kj::Promise<void> TaskAccessServer::setProperty(SetPropertyContext context) {
  const auto params = context.getParams();
  return caller_.answer(context, [tasks = tasks_, task = model::TaskId(as_string(params.getTask())),
                                  path = as_string(params.getPath()), value = get(params.getValue()),
                                  deadline = deadline_after(params.getTimeout())] {
    return tasks->set_property(task, path, value, deadline);
  });
}

kj::Promise<void> TaskAccessServer::call(CallContext context) {
  const auto params = context.getParams();
  return caller_.answer_value(
      context, [tasks = tasks_, task = model::TaskId(as_string(params.getTask())),
                operation = as_string(params.getOperation()), arguments = get(params.getArguments()),
                deadline = deadline_after(params.getTimeout())] {
        return tasks->call(task, operation, arguments, deadline);
      });
}

kj::Promise<void> TaskAccessServer::write(WriteContext context) {
  const auto params = context.getParams();
  return caller_.answer(
      context,
      [tasks = tasks_, port = decode(params.getPort()), value = get(params.getValue()),
       deadline = deadline_after(params.getTimeout())] { return tasks->write(port, value, deadline); });
}

kj::Promise<void> TaskAccessServer::openReader(OpenReaderContext context) {
  const auto params = context.getParams();
  auto open = [tasks = tasks_, port = decode(params.getPort()),
               buffer = std::clamp<std::size_t>(params.getBuffer(), 1,
                                                kMaxBuffer)]() -> Result<std::unique_ptr<SampleStream>> {
    auto reader = tasks->open_reader(port, buffer);
    if (!reader) return reader.error();
    return std::make_unique<ReaderStream>(std::move(*reader));
  };
  return answer_stream(caller_, context, std::move(open));
}

}  // namespace segue::control::detail
