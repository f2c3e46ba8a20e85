// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/transition.hpp>
#include <support/random_networks.hpp>

#include <array>
#include <string>

/// Random actions and transitions with every feature of files and messages, for tests only. They need not be
/// consistent.
namespace segue::testing {

inline NetworkShape everything() {
  NetworkShape shape;
  shape.error_states = true;
  shape.awkward_text = true;
  shape.foreign_placements = true;
  return shape;
}

/// Any kind of action, with any content.
inline model::Action random_action(Random& random, const model::Network& network, int id) {
  model::Action action;
  action.id = id;
  action.phase = static_cast<model::Phase>(up_to(random, 2));
  for (int i = up_to(random, 2); i > 0 && id > 1; --i)
    action.after.push_back(1 + up_to(random, id - 2));
  const model::Task task = random_task(random, everything(), "t" + std::to_string(id));
  switch (up_to(random, 5)) {
    case 0:
      action.kind = any_of(random, std::array{model::ActionKind::Recover, model::ActionKind::Stop,
                                              model::ActionKind::Cleanup, model::ActionKind::Start});
      action.what = model::TaskAction{task.id};
      break;
    case 1:
      action.kind = model::ActionKind::Undeploy;
      action.what = model::DeploymentAction{random_deployment(random, everything(), id), one_in(random, 2)};
      break;
    case 2:
      action.kind = model::ActionKind::CallOperation;
      action.what =
          model::CallAction{task.id, "reset", type::Value::map({{"x", random_value(random, true)}})};
      break;
    case 3:
      action.kind = model::ActionKind::HandOver;
      action.what = model::HandOverAction{model::TaskId("old"), task.id};
      break;
    case 4:
      if (!network.connections.empty()) {
        action.kind = model::ActionKind::Connect;
        action.what = model::ConnectionAction{any_of(random, network.connections)};
        break;
      }
      [[fallthrough]];
    default:
      action.kind = model::ActionKind::ApplyConfig;
      model::ConfigAction config{task, {}, one_in(random, 2) ? task.id.str() : "other_name"};
      if (one_in(random, 2)) config.process = {model::HostName("base"), model::ProcessName("p")};
      if (one_in(random, 4)) config.process = {model::kLocalHost, {}};
      action.what = config;
  }
  return action;
}

inline model::Transition random_transition(Random& random) {
  const model::Network network = random_network(random, everything());
  model::Transition transition;
  transition.from = model::NetworkName("a");
  transition.to = network.name;
  transition.order = static_cast<model::Order>(up_to(random, 1));
  for (int i = 1; i <= up_to(random, 8); ++i)
    transition.actions.push_back(
        random_action(random, network, static_cast<int>(transition.actions.size()) + 1));
  for (const model::Task& task : network.tasks) {
    if (one_in(random, 3)) transition.removes.push_back(task.id);
    if (one_in(random, 3)) transition.redefines.push_back(task);
  }
  return transition;
}

}  // namespace segue::testing
