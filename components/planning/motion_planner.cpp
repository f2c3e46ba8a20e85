// SPDX-License-Identifier: Apache-2.0
#include "motion_plan.hpp"

#include <segue/task/component.hpp>

#include <chrono>
#include <memory>
#include <thread>

namespace planning {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Its deadline is that of operations, too.
static segue::Activity patient() {
  segue::Activity activity;
  activity.update_deadline = std::chrono::minutes(5);
  return activity;
}

/// Plans motions of the rover's arm. Whatever it needs to know is part of the request, so that motions can be
/// planned long before their turn, by any instance of a pool. Planning allocates and takes up to seconds:
/// give the task no thread group with tasks that have real-time demands.
class MotionPlanner final : public Component {
 public:
  MotionPlanner()
      : Component({.doc = "Finds motions of the rover's arm that touch nothing (OMPL, MuJoCo)",
                   .activity = patient()}) {}

 private:
  segue::Result<void> on_configure() override {
    auto made = ArmScene::create();
    if (!made) return std::move(made.error());
    scene_ = std::move(*made);
    return {};
  }

  void on_cleanup() override { scene_.reset(); }

  segue::Result<PlanResult> plan(const PlanRequest& request) {
    if (!scene_) return segue::fail(segue::ErrorCode::InvalidState, "the planner must be configured first");
    planning_.enter();
    const auto planned = std::chrono::steady_clock::now() + std::chrono::duration<double>(effort_.get());
    auto result = plan_motion(*scene_, request);
    std::this_thread::sleep_until(planned);
    (result ? planned_ : no_path_).enter();
    return result;
  }

  State planning_{*this, "planning"};
  State planned_{*this, "planned"};
  State no_path_{*this, "no_path"};
  Property<double> effort_{
      *this,
      "effort",
      0.0,
      {.doc = "s that each plan takes at least, as on a slower computer or a harder problem"}};
  Operation<segue::Result<PlanResult>(PlanRequest)> plan_{
      *this,
      "plan",
      {"request"},
      [this](const PlanRequest& request) { return plan(request); },
      RunsIn::TaskThread,
      "finds a path to one of the goals, or fails and says why there is none; the same request has the same "
      "answer"};

  std::unique_ptr<ArmScene> scene_;
};

}  // namespace planning

SEGUE_COMPONENT(planning::MotionPlanner)
