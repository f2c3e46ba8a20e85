// SPDX-License-Identifier: Apache-2.0
// The box-fetching plans of Brunner et al. 2019 (section V), as reconstructed in examples/07_boxes.
#include <segue/cdtn/concurrent_engine.hpp>
#include <segue/cdtn/critical_path.hpp>
#include <segue/cdtn/flat_file.hpp>
#include <segue/cdtn/sequential.hpp>

#include <support/paths.hpp>

#include <gmock/gmock.h>

#include <array>

namespace segue::cdtn {
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

  double run(std::uint32_t planners, std::uint32_t copies, ConcurrentEngineOptions options = {}) {
    for (const char* name : {"process:path_planner", "worldmodel:projected"})
      flat_->network.resources[flat_->network.resources.intern(name)].count = planners;
    const Order order = derive_order(flat_->network);
    SimulatedEnvironment environment(flat_->network, flat_->trials);
    options.world_copies = copies;
    ConcurrentEngine engine(flat_->network, order, environment, options);
    const RunResult result = engine.run();
    EXPECT_TRUE(result.done()) << to_string(*result.error);
    return std::chrono::duration<double>(result.makespan).count();
  }

  std::size_t row() const { return static_cast<std::size_t>(GetParam()) - 1; }
  std::optional<FlatNetwork> flat_;
};

TEST_P(Boxes, TakeAsLongAsThePaperSaysSequentially) {
  SimulatedEnvironment environment(flat_->network, flat_->trials);
  const RunResult result = run_sequential(flat_->network, environment);
  EXPECT_NEAR(std::chrono::duration<double>(result.makespan).count(), (std::array{81.6, 123.1, 164.5})[row()],
              kTolerance);
}

TEST_P(Boxes, ReachTheCriticalPathWithOnePlanner) {
  const double expected = (std::array{72.9, 95.2, 117.5})[row()];
  EXPECT_NEAR(run(1, 0), expected, kTolerance);
  const auto path = critical_path(flat_->network, derive_order(flat_->network));
  EXPECT_NEAR(std::chrono::duration<double>(path.length).count(), expected, kTolerance);
}

/// With one planner the paper has 73.5, 107.3, 141.5 s, with two 72.3, 97.3, 116.5 s. One copy of the world
/// that is kept until its plan has been carried out comes within 5 % of the former, three copies within 3 %
/// of the latter.
TEST_P(Boxes, TakeAsLongAsInThePaperWithAsManyCopiesOfTheWorld) {
  const double one_planner = (std::array{73.5, 107.3, 141.5})[row()];
  const double two_planners = (std::array{72.3, 97.3, 116.5})[row()];
  EXPECT_NEAR(run(1, 1), one_planner, one_planner * 0.05);
  EXPECT_NEAR(run(2, 3), two_planners, two_planners * 0.03);
}

TEST_P(Boxes, TakeNoLongerThanSequentiallyWithoutRunningAhead) {
  ConcurrentEngineOptions options;
  options.speculate = false;
  EXPECT_LT(run(1, 0, options), (std::array{81.6, 123.1, 164.5})[row()]);
}

INSTANTIATE_TEST_SUITE_P(Paper, Boxes, testing::Values(1, 2, 3));

}  // namespace
}  // namespace segue::cdtn
