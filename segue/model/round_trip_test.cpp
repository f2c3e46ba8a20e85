// SPDX-License-Identifier: Apache-2.0
#include <segue/model/files.hpp>
#include <segue/type/json.hpp>
#include <support/random_networks.hpp>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

namespace segue::model {
namespace {

using testing::Random;

testing::NetworkShape everything() {
  testing::NetworkShape shape;
  shape.error_states = true;
  shape.awkward_text = true;
  shape.foreign_seats = true;
  return shape;
}

RC_GTEST_PROP(RoundTripTest, networkFile, (std::uint64_t seed)) {
  Random random(seed);
  const Network network = testing::random_network(random, everything());
  const std::string text = write_network(network);
  Diagnostics diagnostics;
  const auto read = read_network(text, "x.yaml", diagnostics);
  if (!read || !(*read == network)) RC_LOG() << text << to_string(diagnostics);
  RC_ASSERT(diagnostics.empty());
  RC_ASSERT(read.has_value());
  RC_ASSERT(*read == network);
}

Action random_action(Random& random, const Network& network, int id) {
  Action action;
  action.id = id;
  action.phase = static_cast<Phase>(testing::up_to(random, 2));
  for (int i = testing::up_to(random, 2); i > 0 && id > 1; --i)
    action.after.push_back(1 + testing::up_to(random, id - 2));
  const Task task = testing::random_task(random, everything(), "t" + std::to_string(id));
  switch (testing::up_to(random, 4)) {
    case 0:
      action.kind = testing::any_of(
          random, std::array{ActionKind::Recover, ActionKind::Stop, ActionKind::Cleanup, ActionKind::Start});
      action.what = TaskAction{task.id};
      break;
    case 1:
      action.kind = ActionKind::Undeploy;
      action.what = DeploymentAction{testing::random_deployment(random, everything(), id)};
      break;
    case 2:
      action.kind = ActionKind::CallOperation;
      action.what =
          CallAction{task.id, "reset", type::Value::map({{"x", testing::random_value(random, true)}})};
      break;
    case 3:
      if (!network.connections.empty()) {
        action.kind = ActionKind::Connect;
        action.what = ConnectionAction{testing::any_of(random, network.connections)};
        break;
      }
      [[fallthrough]];
    default:
      action.kind = ActionKind::ApplyConfig;
      ConfigAction config{task, {}, testing::one_in(random, 2) ? task.id.str() : "seat"};
      if (testing::one_in(random, 2)) config.process = {HostName("base"), ProcessName("p")};
      if (testing::one_in(random, 4)) config.process = {kLocalHost, {}};
      action.what = config;
  }
  return action;
}

Transition random_transition(Random& random) {
  const Network network = testing::random_network(random, everything());
  Transition transition;
  transition.from = NetworkName("a");
  transition.to = network.name;
  transition.order = static_cast<Order>(testing::up_to(random, 1));
  for (int i = 1; i <= testing::up_to(random, 8); ++i)
    transition.actions.push_back(
        random_action(random, network, static_cast<int>(transition.actions.size()) + 1));
  for (const Task& task : network.tasks) {
    if (testing::one_in(random, 3)) transition.removes.push_back(task.id);
    if (testing::one_in(random, 3)) transition.redefines.push_back(task);
  }
  return transition;
}

RC_GTEST_PROP(RoundTripTest, transitionFile, (std::uint64_t seed)) {
  Random random(seed);
  const Transition transition = random_transition(random);
  const std::string text = write_transition(transition);
  Diagnostics diagnostics;
  const auto read = read_transition(text, "x.yaml", diagnostics);
  if (!read || !(*read == transition)) RC_LOG() << text << to_string(diagnostics);
  RC_ASSERT(diagnostics.empty());
  RC_ASSERT(read.has_value());
  RC_ASSERT(*read == transition);
}

RC_GTEST_PROP(RoundTripTest, jsonOfATransition, (std::uint64_t seed)) {
  Random random(seed);
  const Transition transition = random_transition(random);
  // Numbers that JSON lacks become null, so only the frame is compared.
  const std::string text = type::to_json(to_value(transition));
  Diagnostics diagnostics;
  const auto read = read_transition(text, "x.json", diagnostics);
  if (!read) RC_LOG() << text << to_string(diagnostics);
  RC_ASSERT(diagnostics.empty());
  RC_ASSERT(read.has_value());
  RC_ASSERT(read->actions.size() == transition.actions.size());
  RC_ASSERT(read->counts().by_kind == transition.counts().by_kind);
}

}  // namespace
}  // namespace segue::model
