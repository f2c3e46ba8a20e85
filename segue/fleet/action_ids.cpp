// SPDX-License-Identifier: Apache-2.0
#include <segue/fleet/action_ids.hpp>

#include <segue/task_host/full_id.hpp>

namespace segue::fleet::detail {

Which which_of(model::ActionKind kind) {
  switch (kind) {
    case model::ActionKind::Recover:
    case model::ActionKind::Stop:
    case model::ActionKind::Cleanup:
    case model::ActionKind::Disconnect:
      return Which::Current;
    default:
      return Which::Next;
  }
}

model::Connection plain(model::Connection connection) {
  connection.from.task = task_host::plain_id(connection.from.task);
  connection.to.task = task_host::plain_id(connection.to.task);
  return connection;
}

model::Action plain(model::Action action) {
  if (auto* task = std::get_if<model::TaskAction>(&action.what)) {
    task->task = task_host::plain_id(task->task);
  } else if (auto* call = std::get_if<model::CallAction>(&action.what)) {
    call->task = task_host::plain_id(call->task);
  } else if (auto* config = std::get_if<model::ConfigAction>(&action.what)) {
    config->definition.id = task_host::plain_id(config->definition.id);
  } else if (auto* hand_over = std::get_if<model::HandOverAction>(&action.what)) {
    hand_over->from = task_host::plain_id(hand_over->from);
    hand_over->to = task_host::plain_id(hand_over->to);
  } else if (auto* wire = std::get_if<model::ConnectionAction>(&action.what)) {
    wire->connection = plain(std::move(wire->connection));
  }
  return action;
}

}  // namespace segue::fleet::detail
