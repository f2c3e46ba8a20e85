// SPDX-License-Identifier: Apache-2.0
#include <segue/task_network/concurrent_engine.hpp>
#include <segue/task_network/flat_file.hpp>
#include <segue/task_network/priority.hpp>
#include <segue/task_network/sequential.hpp>
#include <segue/task_network/waits.hpp>
#include <segue/type/json.hpp>

#include <gmock/gmock.h>

#include <future>
#include <list>
#include <stop_token>
#include <thread>

namespace segue::task_network {
namespace {

using testing::HasSubstr;

double seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

FlatNetwork read(const std::string& nodes, const std::string& head = "") {
  Diagnostics diagnostics;
  auto flat = read_flat_network("{" + head + "\"nodes\": [" + nodes + "]}", "test.json", diagnostics);
  EXPECT_TRUE(flat) << to_string(diagnostics);
  return flat ? std::move(*flat) : FlatNetwork{};
}

RunResult run(const FlatNetwork& flat, ConcurrentEngineOptions options = {}) {
  const Order order = derive_order(flat.network);
  SimulatedEnvironment environment(flat.network, flat.trials);
  return ConcurrentEngine(flat.network, order, environment, options).run();
}

TEST(ConcurrentEngine, RunsAnEmptyNetwork) {
  EXPECT_TRUE(run(read("")).done());
}

TEST(ConcurrentEngine, TakesTheBranchThatWasChosen) {
  const auto flat = read(R"j({"name": "ask", "duration_s": 2, "pia": false, "outcome": "no"},
    {"name": "yes", "duration_s": 5, "pia": false, "condition_deps": ["ask"]},
    {"name": "no", "duration_s": 1, "pia": true, "effects": ["+done()"], "resources": [],
     "condition_deps": [{"node": "ask", "outcome": "no"}]})j");
  const RunResult result = run(flat);
  ASSERT_TRUE(result.done());
  EXPECT_EQ(result.nodes[1].status, NodeStatus::Skipped);
  EXPECT_EQ(seconds(result.makespan), 3);
  EXPECT_EQ(result.statistics.wasted, 1U) << "it ran ahead for nothing";
  EXPECT_THAT(result.world.texts(flat.network.facts), testing::ElementsAre("done()"));
}

TEST(ConcurrentEngine, AbortsANodeThatWouldEndAfterAllTimeThatThereIs) {
  std::string nodes;
  for (int i = 0; i < 10; ++i)
    nodes += std::string(i == 0 ? "" : ",") + R"({"name": "n)" + std::to_string(i) +
             R"(", "duration_s": 1000000000})";
  const FlatNetwork flat = read(nodes);
  SimulatedEnvironment environment(flat.network, flat.trials);
  const auto expect_error = [](const RunResult& result) {
    ASSERT_FALSE(result.done());
    EXPECT_THAT(to_string(*result.error), HasSubstr("it would end after more than 292 years"));
    EXPECT_EQ(seconds(result.makespan), 9e9);
  };
  expect_error(run(flat));
  expect_error(run_sequential(flat.network, environment));
}

TEST(ConcurrentEngine, AnAbortWithAHandlerIsABranch) {
  const RunResult result = run(read(R"j({"name": "grasp", "pia": true, "effects": [], "fails": true},
    {"name": "lift", "pia": true, "effects": [], "condition_deps": ["grasp"]},
    {"name": "retry", "pia": true, "effects": [], "condition_deps": [{"node": "grasp", "outcome": "aborted"}]})j"));
  ASSERT_TRUE(result.done());
  EXPECT_EQ(result.nodes[1].status, NodeStatus::Skipped);
  EXPECT_EQ(result.nodes[2].status, NodeStatus::Done);
}

TEST(ConcurrentEngine, EndsWithTheErrorOfTheLowestNode) {
  const RunResult result = run(read(R"j(
    {"name": "slow", "duration_s": 9, "pia": true, "effects": [], "fails": true},
    {"name": "quick", "duration_s": 1, "pia": true, "effects": [], "fails": true},
    {"name": "last", "duration_s": 20, "pia": true, "effects": []})j"));
  ASSERT_TRUE(result.failed);
  EXPECT_EQ(*result.failed, NodeId{0});
  EXPECT_EQ(result.nodes[2].status, NodeStatus::Preempted);
  EXPECT_EQ(seconds(result.makespan), 9);
}

// "plan" runs ahead in the world that "use" will leave, and has the arm when "use" could start.
const char* const kAheadWithTheArm = R"j(
    {"name": "drive", "duration_s": 5, "pia": true, "effects": ["+there()"]},
    {"name": "use", "duration_s": 2, "pia": true, "preconditions": ["there()"], "effects": ["+used()"],
     "resources": [{"name": "system:arm", "op": "block"}]},
    {"name": "plan", "duration_s": 10, "pia": false, "preconditions": ["used()"], "effects": [],
     "resources": [{"name": "system:arm", "op": "block"}]})j";

TEST(ConcurrentEngine, WhoRunsAheadGivesBackWhatANodeBeforeItNeeds) {
  const RunResult result = run(read(kAheadWithTheArm));
  ASSERT_TRUE(result.done());
  EXPECT_EQ(seconds(result.nodes[1].started.time_since_epoch()), 5);
  EXPECT_EQ(seconds(result.makespan), 17) << "as one after the other";
  ASSERT_EQ(result.wasted.size(), 1U);
  EXPECT_EQ(seconds(result.wasted[0].ended - result.wasted[0].started), 5);
  EXPECT_EQ(result.statistics.preempted, 1U);
  EXPECT_EQ(result.statistics.wasted, 1U);
}

TEST(ConcurrentEngine, WhoRunsAheadKeepsWhatIsThereTwice) {
  const auto flat = read(kAheadWithTheArm, R"("resources": {"system:arm": {"count": 2}},)");
  const RunResult result = run(flat);
  EXPECT_EQ(seconds(result.makespan), 10);
  EXPECT_EQ(result.statistics.preempted, 0U);
}

TEST(ConcurrentEngine, WhoIsCertainToBeWantedKeepsWhatItHas) {
  const RunResult result = run(read(R"j(
    {"name": "drive", "duration_s": 5, "pia": true, "effects": ["+there()"]},
    {"name": "use", "duration_s": 2, "pia": true, "preconditions": ["there()"], "effects": [],
     "resources": [{"name": "system:arm", "op": "block"}]},
    {"name": "plan", "duration_s": 10, "pia": false, "effects": [],
     "resources": [{"name": "system:arm", "op": "block"}]})j"));
  EXPECT_EQ(seconds(result.makespan), 12);
  EXPECT_EQ(result.statistics.preempted, 0U);
}

TEST(ConcurrentEngine, WhoRunsAheadGivesBackItsWorker) {
  ConcurrentEngineOptions options;
  options.workers = 2;
  const RunResult result = run(read(R"j(
    {"name": "drive", "duration_s": 5, "pia": true, "effects": ["+there()"]},
    {"name": "look", "duration_s": 1, "pia": true, "preconditions": ["there()"], "effects": ["+seen()"]},
    {"name": "listen", "duration_s": 1, "pia": true, "preconditions": ["there()"], "effects": []},
    {"name": "plan", "duration_s": 10, "pia": false, "preconditions": ["seen()"], "effects": []})j"),
                               options);
  EXPECT_EQ(seconds(result.nodes[2].started.time_since_epoch()), 5);
  EXPECT_EQ(seconds(result.makespan), 16);
  EXPECT_EQ(result.statistics.preempted, 1U);
}

TEST(ConcurrentEngine, AnEffectThatIsNotDeclaredNamesItsNode) {
  const RunResult result =
      run(read(R"j({"name": "push", "pia": true, "effects": ["+at(a)"], "uncertain": false,
    "actual_effects": ["+at(b)"]})j"));
  ASSERT_TRUE(result.error);
  EXPECT_THAT(to_string(*result.error), HasSubstr("push"));
  EXPECT_THAT(to_string(*result.error), HasSubstr("at(b)"));
}

TEST(ConcurrentEngine, RunsAPureNodeAgainWhereThePredictionWasWrong) {
  const auto flat = read(R"j({"name": "push", "duration_s": 3, "pia": true, "effects": ["+at(a)"],
     "actual_effects": ["+at(a)", "-open()"]},
    {"name": "plan", "duration_s": 1, "pia": false, "preconditions": ["at(a)"], "effects": []})j");
  EXPECT_TRUE(run(flat).error) << "open() is not among the declared facts";
  const RunResult result =
      run(read(R"j({"name": "push", "duration_s": 3, "pia": true, "effects": ["+at(a)", "+open()"],
     "actual_effects": ["+at(a)"]
  },
    {"name": "plan", "duration_s": 1, "pia": false, "preconditions": ["at(a)", "!open()"], "effects": []})j"));
  ASSERT_TRUE(result.done());
  EXPECT_EQ(seconds(result.makespan), 4) << "it could not run ahead";
}

/// Two nodes that use up cups, of which there is one, and one that has nothing to do with it.
TaskNetwork lacking_a_cup(bool handled) {
  TaskNetwork network;
  const ResourceId cup = network.resources.intern("cup");
  network.resources[cup].varies = true;
  NodeSpec spec;
  spec.duration = std::chrono::seconds(2);
  spec.claims = {{cup, ResourceOp::Consume, 1}};
  spec.name = "first";
  network.append(spec);
  spec.name = "second";
  spec.branches = spec.handles_abort = handled;
  const NodeId second = network.append(spec);
  NodeSpec handler;
  handler.name = "wash";
  if (handled) handler.conditions = {{second, kAborted}};
  network.append(handler);
  return network;
}

TEST(ConcurrentEngine, AShortageAbortsItsNodeAsInTheSequentialRun) {
  for (const bool handled : {false, true}) {
    const TaskNetwork network = lacking_a_cup(handled);
    const Order order = derive_order(network);
    SimulatedEnvironment environment(network);
    const RunResult sequential = run_sequential(network, environment);
    const RunResult concurrent = ConcurrentEngine(network, order, environment).run();
    EXPECT_EQ(concurrent.done(), handled);
    EXPECT_EQ(concurrent.nodes[1].outcome, kAborted);
    EXPECT_EQ(concurrent.nodes[1].attempts, 0U);
    EXPECT_EQ(concurrent.nodes[2].status == NodeStatus::Done,
              sequential.nodes[2].status == NodeStatus::Done || !handled);
    EXPECT_EQ(concurrent.units, sequential.units);
    if (handled) continue;
    EXPECT_EQ(to_string(*concurrent.error), to_string(*sequential.error));
    EXPECT_THAT(to_string(*concurrent.error),
                HasSubstr("second: it needs 1 of the resource 'cup', of which there are 0"));
  }
}

TEST(ConcurrentEngine, SaysWhoWaitsForWhat) {
  TaskNetwork network;
  const ResourceId arm = network.resources.intern("system:arm");
  NodeSpec spec;
  spec.name = "lift";
  spec.claims = {{arm, ResourceOp::Block, 2, network.add_group(arm)}};  // more than its group holds
  network.append(spec);
  spec.name = "turn";
  network.append(spec);
  const Order order = derive_order(network);
  SimulatedEnvironment environment(network);
  const RunResult result = ConcurrentEngine(network, order, environment).run();
  ASSERT_TRUE(result.error);
  EXPECT_THAT(to_string(*result.error), HasSubstr("'lift' waits for 2 of 'system:arm' (1 in total, 1 free)"));
  EXPECT_THAT(to_string(*result.error), HasSubstr("'turn' waits for 'lift' (resource: system:arm)"));
}

/// Nodes that run on threads of their own.
class Threads final : public Environment {
 public:
  ~Threads() override {
    for (std::thread& thread : threads_)
      thread.join();
  }
  void start(NodeContext& context, Completions& completions) override {
    threads_.emplace_back(
        [&completions, node = context.node(), attempt = context.attempt(), world = context.world()] {
          auto report = std::make_unique<Report>();
          report->outputs = std::make_shared<type::Value>(static_cast<std::uint64_t>(world.facts().size()));
          completions.finish(node, attempt, std::move(report));
        });
  }
  void cancel(NodeId, std::uint32_t, Completions&) override {}

 private:
  std::list<std::thread> threads_;
};

TEST(ConcurrentEngine, TakesEndsFromOtherThreads) {
  TaskNetwork network;
  NodeSpec spec;
  for (std::uint32_t i = 0; i < 50; ++i) {
    spec.name = "n" + std::to_string(i);
    spec.kind = i % 3 == 0 ? ActionClass::Pure : ActionClass::Irreversible;
    spec.reads_world = true;
    spec.effects = {{*network.facts.intern("f(" + std::to_string(i) + ")"), true}};
    network.append(spec);
  }
  const Order order = derive_order(network);
  Threads environment;
  ConcurrentEngineOptions options;
  options.clock = ClockKind::Real;
  ConcurrentEngine engine(network, order, environment, options);
  const RunResult result = engine.run();
  ASSERT_TRUE(result.done()) << to_string(*result.error);
  for (std::uint32_t i = 0; i < 50; ++i)
    EXPECT_EQ(result.outputs[i]->as_uint(), i) << "each saw what came before it in the program";
}

/// Nodes that wait for the unit of the first. Speculating: they want two, of which one is held by a node that
/// runs ahead, and preempting it would not help.
RunResult run_crowd(std::uint32_t waiting, bool speculating) {
  TaskNetwork network;
  const ResourceId arm = network.resources.intern("arm");
  network.resources[arm].count = speculating ? 2 : 1;
  NodeSpec spec;
  spec.kind = ActionClass::Pure;
  spec.claims = {{arm}};
  spec.duration = std::chrono::seconds(10);
  network.append(spec);
  NodeSpec first;
  first.duration = std::chrono::seconds(1);
  const NodeId signal = network.append(first);
  spec.duration = std::chrono::seconds(0);
  spec.claims = {{arm, ResourceOp::Block, network.resources[arm].count}};
  spec.inputs = {{signal, 0, 0}};
  for (std::uint32_t i = 0; i < waiting; ++i)
    network.append(spec);
  NodeSpec slow;
  slow.branches = true;
  slow.duration = std::chrono::seconds(20);
  const NodeId decision = network.append(slow);
  NodeSpec ahead;
  ahead.kind = ActionClass::Pure;
  ahead.claims = {{arm}};
  ahead.duration = std::chrono::seconds(5);
  ahead.conditions = {{decision, kSuccess}};
  if (speculating) network.append(ahead);
  const Order order = derive_order(network);
  SimulatedEnvironment environment(network);
  return ConcurrentEngine(network, order, environment).run();
}

TEST(ConcurrentEngine, ManyThatWaitForOneResourceCostNoMoreForEach) {
  for (const bool speculating : {false, true}) {
    const RunResult few = run_crowd(100, speculating);
    const RunResult many = run_crowd(3'000, speculating);
    ASSERT_TRUE(few.done() && many.done());
    EXPECT_EQ(many.statistics.speculative > 0, speculating);
    EXPECT_LE(many.statistics.looked_at, 35 * few.statistics.looked_at) << speculating;
  }
}

TEST(Waits, WhatTheEngineTakesItselfIsNoWait) {
  const auto flat = read(R"j({"name": "a", "effects": ["+p()"]}, {"name": "b", "effects": ["+q()"]})j");
  const Order order = derive_order(flat.network);
  RunResult result = run(flat);
  const TimePoint begin{};
  using std::chrono::microseconds;
  result.nodes[0] = {NodeStatus::Done,         kSuccess, 1, begin, begin + microseconds(400),
                     begin + microseconds(450)};
  result.nodes[1] = {NodeStatus::Done, kSuccess, 1, begin + microseconds(500), begin + microseconds(900), {}};
  const auto waits = [&] { return WaitFinder(flat.network, order, result).of(NodeId{1}); };
  ASSERT_EQ(waits().size(), 1U);
  EXPECT_EQ(waits()[0].kind, Wait::Kind::Turn);
  result.own_time = std::chrono::milliseconds(1);
  EXPECT_THAT(waits(), testing::IsEmpty());
}

/// A node that only ends when it is told to.
class Endless final : public Environment {
 public:
  void start(NodeContext&, Completions&) override { started.set_value(); }
  void cancel(NodeId node, std::uint32_t attempt, Completions& completions) override {
    auto report = std::make_unique<Report>();
    report->outcome = kPreempted;
    completions.finish(node, attempt, std::move(report));
  }
  std::promise<void> started;
};

TEST(ConcurrentEngine, StopsOnRequest) {
  const auto flat = read(R"j({"name": "wait", "pia": true, "effects": []})j");
  const Order order = derive_order(flat.network);
  Endless environment;
  ConcurrentEngineOptions options;
  options.clock = ClockKind::Real;
  ConcurrentEngine engine(flat.network, order, environment, options);
  std::thread stopper([&] {
    environment.started.get_future().wait();
    engine.stop();
  });
  const RunResult result = engine.run();
  stopper.join();
  EXPECT_TRUE(result.stopped);
  EXPECT_EQ(result.nodes[0].status, NodeStatus::Preempted);
}

/// A loop of a sensing and an irreversible node, unrolled until it has gone round often enough.
class Loop final : public Expansion {
 public:
  explicit Loop(int rounds) : rounds_(rounds) {}
  void expand(TaskNetwork& network, std::size_t wanted) override {
    const FactId ready = *network.facts.intern("ready()");
    for (std::size_t i = 0; i < wanted && !finished(); i += 2, --rounds_) {
      NodeSpec look;
      look.name = "look";
      look.iteration = network.size() / 2;
      look.kind = ActionClass::Sensing;
      look.preconditions = {{ready, look.iteration % 2 == 0}};
      network.append(look);
      NodeSpec act = look;
      act.name = "act";
      act.kind = ActionClass::Irreversible;
      act.effects = {{ready, look.iteration % 2 == 1}};
      network.append(act);
    }
    largest = std::max(largest, network.size() - ended_);
  }
  void ended(NodeId, OutcomeId, const type::Value*) override { ++ended_; }
  [[nodiscard]] bool finished() const override { return rounds_ == 0; }
  std::uint32_t largest = 0;

 private:
  int rounds_;
  std::uint32_t ended_ = 0;
};

TEST(ConcurrentEngine, UnrollsALoopAHorizonAhead) {
  TaskNetwork network;
  network.initial_world.set({*network.facts.intern("ready()"), true});
  Loop loop(500);
  SimulatedEnvironment environment(network);
  ConcurrentEngineOptions options;
  options.horizon = 10;
  const RunResult result = ConcurrentEngine(network, loop, environment, options).run();
  ASSERT_TRUE(result.done()) << to_string(*result.error);
  EXPECT_EQ(result.nodes.size(), 1000U);
  EXPECT_LE(loop.largest, 12U);
}

TEST(FlatNetwork, IsWrittenAsItIsRead) {
  const auto flat = read(R"j({"name": "a", "duration_s": 1.5, "pia": true, "effects": ["+p(x)"],
      "resources": [{"name": "system:arm", "op": "block"}]},
    {"name": "b", "pia": false, "sensing": true, "preconditions": ["!q()"], "condition_deps": ["a"],
     "data_flows": [["a", "o", "b", "i"]]},
    {"name": "likely", "condition_deps": [{"node": "a", "outcome": "done", "likelihood": 0.75}]},
    {"name": "c", "pia": true, "resources": [{"name": "system:arm", "op": "release"}]})j");
  Diagnostics diagnostics;
  const std::string text = write_flat_network(flat);
  EXPECT_THAT(text, testing::HasSubstr("\"likelihood\": 0.75"));
  const auto again = read_flat_network(text, "again.json", diagnostics);
  ASSERT_TRUE(again) << to_string(diagnostics);
  EXPECT_EQ(write_flat_network(*again), text);
}

/// Asks to stop when a node starts.
class StoppingEnvironment final : public Environment {
 public:
  StoppingEnvironment(const TaskNetwork& network, NodeId at) : inner_(network), at_(at) {}
  void start(NodeContext& context, Completions& completions) override {
    if (context.node() == at_) stop.request_stop();
    inner_.start(context, completions);
  }
  void cancel(NodeId node, std::uint32_t attempt, Completions& completions) override {
    inner_.cancel(node, attempt, completions);
  }
  std::stop_source stop;

 private:
  SimulatedEnvironment inner_;
  NodeId at_;
};

constexpr const char* kThree = R"j({"name": "a", "duration_s": 1, "effects": ["+p()"]},
    {"name": "b", "duration_s": 100, "effects": ["+q()"]}, {"name": "c", "duration_s": 1, "effects": []})j";

TEST(Sequential, AStopPreemptsWhatRunsAndNothingFollows) {
  const auto flat = read(kThree);
  StoppingEnvironment environment(flat.network, NodeId{1});
  const RunResult result =
      run_sequential(flat.network, environment, ClockKind::Virtual, environment.stop.get_token());
  EXPECT_TRUE(result.stopped);
  EXPECT_FALSE(result.failed);
  EXPECT_EQ(result.nodes[0].status, NodeStatus::Done);
  EXPECT_EQ(result.nodes[1].status, NodeStatus::Preempted);
  EXPECT_EQ(result.nodes[2].status, NodeStatus::NotReached);
  EXPECT_EQ(seconds(result.makespan), 1);
  EXPECT_THAT(result.world.texts(flat.network.facts), testing::ElementsAre("p()"));
}

TEST(Sequential, AStopBeforehandStartsNothing) {
  const auto flat = read(kThree);
  StoppingEnvironment environment(flat.network, NodeId{kNone});
  environment.stop.request_stop();
  const RunResult result =
      run_sequential(flat.network, environment, ClockKind::Real, environment.stop.get_token());
  EXPECT_TRUE(result.stopped);
  EXPECT_EQ(result.statistics.starts, 0U);
}

TEST(Sequential, AStopWakesARunThatWaits) {
  const auto flat = read(R"j({"name": "a", "duration_s": 3600, "effects": []})j");
  SimulatedEnvironment environment(flat.network);
  std::stop_source stop;
  std::thread other([&] { stop.request_stop(); });
  const RunResult result = run_sequential(flat.network, environment, ClockKind::Real, stop.get_token());
  other.join();
  EXPECT_TRUE(result.stopped);
  EXPECT_NE(result.nodes[0].status, NodeStatus::Done);
}

TEST(Priorities, AStopLeavesProgramOrder) {
  const auto flat = read(kThree);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_TRUE(
      choose_priorities(flat.network, derive_order(flat.network), flat.trials, {}, stop.get_token()).empty());
}

TEST(FlatNetwork, SaysWhatIsWrongAndWhere) {
  const auto problems = [](const std::string& text) {
    Diagnostics diagnostics;
    EXPECT_FALSE(read_flat_network(text, "f.json", diagnostics)) << text;
    return to_string(diagnostics);
  };
  EXPECT_THAT(problems("{"), HasSubstr("f.json:1:"));
  EXPECT_THAT(problems("[]"), HasSubstr("must be a map"));
  EXPECT_THAT(problems(R"j({"nodes": [{"name": "a"}, {"name": "a"}]})j"), HasSubstr("a second node 'a'"));
  EXPECT_THAT(problems(R"j({"nodes": [{"name": "a", "condition_deps": ["a"]}]})j"),
              HasSubstr("does not come before"));
  EXPECT_THAT(problems(R"j({"nodes": [{"name": "a", "effects": ["p"]}]})j"), HasSubstr("bad-effect"));
  EXPECT_THAT(problems(R"j({"nodes": [{"name": "a", "duration_s": -1}]})j"), HasSubstr("bad-duration"));
  EXPECT_THAT(problems(R"j({"nodes": [{"name": "a", "preconditions": ["p", "!p"]}]})j"),
              HasSubstr("both true"));
  EXPECT_THAT(problems(R"j({"nodes": [{"name": "a", "resources": [{"name": "r", "op": "eat"}]}]})j"),
              HasSubstr("unknown-operation"));
  EXPECT_THAT(problems(R"j({"nodes": [{"name": "a", "resources": [{"name": "r", "op": "release"}]}]})j"),
              HasSubstr("no node before it blocks"));
  EXPECT_THAT(problems(R"j({"resources": {"r": {"count": 0}}, "nodes": [{"name": "a", "resources":
      [{"name": "r", "op": "block"}]}, {"name": "b", "resources": [{"name": "r", "op": "create"}]}]})j"),
              HasSubstr("missing-resource"));
}

}  // namespace
}  // namespace segue::task_network
