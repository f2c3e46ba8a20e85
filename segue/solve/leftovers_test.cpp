// SPDX-License-Identifier: Apache-2.0
// Transitions from networks that hold more than what runs: standby tasks, and what earlier requests left.
#include <segue/solve/solve.hpp>

#include <support/network_of.hpp>

#include <gmock/gmock.h>

#include <string>
#include <string_view>

namespace segue::solve {
namespace {

using model::Phase;
using model::TaskId;
using segue::testing::network_of;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

std::vector<std::string> phases_and_labels(const model::Transition& transition) {
  std::vector<std::string> all;
  for (const auto& action : transition.actions) {
    all.push_back(std::string(to_string(action.phase)) + ' ' + action.label());
  }
  return all;
}

model::Transition solved(const model::Network& from, const model::Network& to, const Options& options) {
  auto transition = diff(from, to, {}, options);
  EXPECT_TRUE(transition) << to_string(transition.error());
  return transition.value_or(model::Transition{});
}

/// `consumer` runs in process c; an earlier request has prepared it in p as well, connected to its writer.
model::Network with_prepared_consumer() {
  auto network = network_of(R"(network: a
tasks:
  producer: {component: x::Producer}
  consumer: {component: x::Consumer}
  left: {component: x::Consumer, state: stopped}
deployments:
  c: {process: c, tasks: [consumer]}
  p: {process: p, tasks: [producer, left]}
connections:
  - producer.out -> consumer.in
  - producer.out -> left.in
)");
  const TaskId id("consumer@localhost/p");
  network.find_task(TaskId("left"))->id = id;
  network.deployments[1].tasks[1] = {id, "consumer"};
  network.connections[1].to.task = id;
  return network;
}

Options with_prepared() {
  Options options;
  options.idle = {TaskId("consumer@localhost/p")};
  options.prepared = {{TaskId("consumer"), TaskId("consumer@localhost/p")}};
  return options;
}

constexpr std::string_view kMoved = R"(network: l
tasks:
  producer: {component: x::Producer}
  consumer: {component: x::Consumer}
deployments:
  p: {process: p, tasks: [producer, consumer]}
connections:
  - producer.out -> consumer.in
)";

TEST(Prepared, IncarnationIsUsedAsItIs) {
  const auto transition = solved(with_prepared_consumer(), network_of(kMoved), with_prepared());
  EXPECT_THAT(phases_and_labels(transition),
              ElementsAre("commit stop consumer", "commit start consumer",
                          "retire disconnect producer.out -> consumer.in", "retire cleanup consumer",
                          "retire undeploy localhost/c"));
  EXPECT_THAT(transition.actions[1].after, ElementsAre(1)) << "two incarnations never run at the same time";
  EXPECT_THAT(transition.removes, IsEmpty()) << "its incarnation in c is replaced";
}

TEST(Prepared, IncarnationWithAnotherConfigurationIsConfiguredAgainInPrepare) {
  auto current = with_prepared_consumer();
  current.find_task(TaskId("consumer@localhost/p"))->properties = type::Value::map({{"gain", 2}});
  const auto transition = solved(current, network_of(kMoved), with_prepared());
  EXPECT_THAT(phases_and_labels(transition),
              ElementsAre("prepare cleanup consumer@localhost/p", "prepare apply_config consumer",
                          "prepare configure consumer", "commit stop consumer", "commit start consumer",
                          "retire disconnect producer.out -> consumer.in", "retire cleanup consumer",
                          "retire undeploy localhost/c"));
}

TEST(Prepared, IncarnationTakesOverTheStateOfTheOldOne) {
  auto target = network_of(kMoved);
  target.find_task(TaskId("consumer"))->takes_over = TaskId("consumer");
  const auto transition = solved(with_prepared_consumer(), target, with_prepared());
  EXPECT_THAT(phases_and_labels(transition), Contains("commit hand_over consumer -> consumer"));
}

TEST(Prepared, IncarnationThatIsNotWantedIsRemovedInRetire) {
  Options options = with_prepared();
  options.prepared.clear();
  auto target = network_of(kMoved);
  target.deployments[0].tasks.pop_back();
  target.tasks.pop_back();
  target.connections.clear();
  const auto transition = solved(with_prepared_consumer(), target, options);
  EXPECT_THAT(phases_and_labels(transition), Contains("retire cleanup consumer@localhost/p"));
  EXPECT_THAT(transition.removes, ElementsAre(TaskId("consumer"), TaskId("consumer@localhost/p")));
}

constexpr std::string_view kStandby = R"(network: now
tasks:
  a: {component: x::A}
  spare: {component: x::B, state: pre_operational}
)";
constexpr std::string_view kBoth = R"(network: then
tasks:
  a: {component: x::A}
  spare: {component: x::B}
)";

TEST(Idle, TasksAreConfiguredInPrepare) {
  Options options;
  EXPECT_THAT(phases_and_labels(solved(network_of(kStandby), network_of(kBoth), options)),
              Contains("commit configure spare"))
      << "a task of what runs is left alone until commit";
  options.idle = {TaskId("spare")};
  EXPECT_THAT(phases_and_labels(solved(network_of(kStandby), network_of(kBoth), options)),
              ElementsAre("prepare configure spare", "commit start spare"));
}

constexpr std::string_view kHolder = R"(network: now
tasks:
  a: {component: x::A}
  holder: {component: x::B, state: stopped, exclusive: [arm]}
)";
constexpr std::string_view kClaimer = R"(network: then
tasks:
  a: {component: x::A}
  claimer: {component: x::C, exclusive: [arm]}
)";

TEST(Idle, TasksGiveWayToWhatIsPrepared) {
  Options options;
  options.idle = {TaskId("holder")};
  EXPECT_THAT(phases_and_labels(solved(network_of(kHolder), network_of(kClaimer), options)),
              ElementsAre("prepare cleanup holder", "prepare apply_config claimer",
                          "prepare configure claimer", "commit start claimer"));
  options.idle.clear();
  EXPECT_THAT(phases_and_labels(solved(network_of(kHolder), network_of(kClaimer), options)),
              Not(Contains("prepare cleanup holder")));
}

TEST(Idle, TasksThatRunAreStoppedInCommit) {
  auto current = network_of(kHolder);
  current.find_task(TaskId("holder"))->state = TaskState::Running;
  Options options;
  options.idle = {TaskId("holder")};
  EXPECT_THAT(phases_and_labels(solved(current, network_of(kClaimer), options)),
              ElementsAre("prepare apply_config claimer", "commit stop holder", "commit cleanup holder",
                          "commit configure claimer", "commit start claimer"));
}

}  // namespace
}  // namespace segue::solve
