// SPDX-License-Identifier: Apache-2.0
// The box-fetching plans of Brunner et al. 2019 (section V), as reconstructed in examples/07_boxes.
#include <segue/task_network/concurrent_engine.hpp>
#include <segue/task_network/critical_path.hpp>
#include <segue/task_network/flat_file.hpp>
#include <segue/task_network/sequential.hpp>

#include <support/paths.hpp>

#include <gmock/gmock.h>

#include <array>
#include <initializer_list>
#include <string>

namespace segue::task_network {
namespace {

constexpr double kTolerance = 0.06;  // seconds; the figures are rounded to a tenth

class Boxes : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    const std::filesystem::path file =
        segue::paths::in_sources("/examples/07_boxes/boxes_") + std::to_string(GetParam()) + ".json";
    Diagnostics diagnostics;
    flat_ = load_flat_network(file, diagnostics);
    ASSERT_TRUE(flat_) << to_string(diagnostics);
  }

  Duration run(std::uint32_t planners, std::uint32_t copies, ConcurrentEngineOptions options = {}) {
    for (const char* name : {"process:path_planner", "worldmodel:projected"})
      flat_->network.resources[flat_->network.resources.intern(name)].count = planners;
    const Order order = derive_order(flat_->network);
    SimulatedEnvironment environment(flat_->network, flat_->trials);
    options.world_copies = copies;
    ConcurrentEngine engine(flat_->network, order, environment, options);
    const RunResult result = engine.run();
    EXPECT_TRUE(result.done()) << to_string(*result.error);
    return result.makespan;
  }

  /// How long the nodes of these names take, one after the other.
  Duration together(std::initializer_list<const char*> names) const {
    Duration sum{};
    for (const std::string name : names) {
      std::uint32_t found = 0;
      for (NodeId node{0}; index(node) < flat_->network.size(); node = NodeId{index(node) + 1}) {
        if (flat_->network.name_of(node) != name) continue;
        sum += flat_->network[node].duration;
        ++found;
      }
      EXPECT_EQ(found, 1U) << name;
    }
    return sum;
  }

  /// The time that the nodes of these names take one after the other, for each box from `first` on.
  Duration for_boxes(int first, std::initializer_list<const char*> names) const {
    Duration sum{};
    for (int box = first; box <= GetParam(); ++box) {
      for (const std::string name : names)
        sum += together({(name + std::to_string(box)).c_str()});
    }
    return sum;
  }

  std::size_t row() const { return static_cast<std::size_t>(GetParam()) - 1; }
  std::optional<FlatNetwork> flat_;
};

double in_seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

/// The durations were fitted to the paper's figures, and come within 0.6 % of them.
TEST_P(Boxes, TakeAsLongSequentiallyAsAllNodesTogether) {
  SimulatedEnvironment environment(flat_->network, flat_->trials);
  const RunResult result = run_sequential(flat_->network, environment);
  Duration all{};
  for (NodeId node{0}; index(node) < flat_->network.size(); node = NodeId{index(node) + 1})
    all += flat_->network[node].duration;
  EXPECT_EQ(result.makespan, all);
  EXPECT_NEAR(in_seconds(all), (std::array{81.6, 123.1, 164.5})[row()], kTolerance);
  const double published = (std::array{81.3, 123.7, 164.2})[row()];
  EXPECT_NEAR(in_seconds(all), published, published * 0.006);
}

/// The arm rests only until the first way has been planned: all other planning is done while it moves.
TEST_P(Boxes, ReachTheCriticalPathWithOnePlanner) {
  const Duration expected =
      together({"LOOK", "D1", "P-MA1", "STOW"}) + for_boxes(1, {"MA", "MT", "G", "R", "PL"});
  EXPECT_EQ(run(1, 0), expected);
  EXPECT_EQ(critical_path(flat_->network, derive_order(flat_->network)).length, expected);
  EXPECT_NEAR(in_seconds(expected), (std::array{72.9, 95.2, 117.5})[row()], kTolerance);
}

/// A copy of the world is kept until the plan that was made in it has been carried out. So where there is
/// one, from the second box on the way to a box is planned once the arm has retreated from the last one, and
/// its last piece when the arm has come near the box; of the rest, all is planned while the arm moves. How
/// many copies the paper's robot kept is not published. Its figures were measured and ours are computed, so
/// ours must not be longer.
TEST_P(Boxes, WithOneCopyOfTheWorldPlanEachWayToABoxAfterTheMotionBefore) {
  const Duration makespan = run(1, 1);
  EXPECT_EQ(makespan, together({"LOOK", "D1", "P-MA1", "MA1", "MT1", "G1", "R1"}) +
                          for_boxes(2, {"P-MA", "MA", "P-MT", "MT", "G", "R"}) +
                          for_boxes(GetParam(), {"PL"}) + together({"STOW"}));
  EXPECT_LE(in_seconds(makespan), (std::array{73.5, 107.3, 141.5})[row()]);
}

/// Two planners with three copies need not wait for each other. The paper's figures for two planners, which
/// are measured, lie up to 0.9 % below the critical path of the durations that were fitted to it, so nobody
/// can keep to them exactly: ours are no longer than 1.01 times these.
TEST_P(Boxes, ReachTheCriticalPathWithTwoPlannersAndThreeCopiesOfTheWorld) {
  const Duration makespan = run(2, 3);
  EXPECT_EQ(makespan, critical_path(flat_->network, derive_order(flat_->network)).length);
  EXPECT_LE(in_seconds(makespan), 1.01 * (std::array{72.3, 97.3, 116.5})[row()]);
}

/// Only moving the arm out and looking for later boxes are done beside other things.
TEST_P(Boxes, PlanEveryWayWhileTheArmRestsWithoutRunningAhead) {
  ConcurrentEngineOptions options;
  options.speculate = false;
  const Duration makespan = run(1, 0, options);
  EXPECT_EQ(makespan, together({"LOOK", "D1", "STOW"}) +
                          for_boxes(1, {"P-MA", "MA", "P-MT", "MT", "G", "P-R", "R", "PL"}));
  EXPECT_LT(in_seconds(makespan), (std::array{81.6, 123.1, 164.5})[row()]);
}

INSTANTIATE_TEST_SUITE_P(Paper, Boxes, testing::Values(1, 2, 3));

}  // namespace
}  // namespace segue::task_network
