// SPDX-License-Identifier: Apache-2.0
#include "checked_robot.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

#include "random_robot.hpp"

#include <segue/base/mutex.hpp>

namespace segue::testing {

std::optional<std::string> CheckedRobot::problem() const {
  const Lock lock(mutex_);
  return problem_;
}

std::set<std::string> CheckedRobot::running() const {
  const Lock lock(mutex_);
  return running_;
}

void CheckedRobot::blame(std::string what) {
  const Lock lock(mutex_);
  if (!problem_) problem_ = std::move(what);
}

Result<void> CheckedRobot::request(const mission::ControllerRequest& what, const Wait& wait) {
  const bool was_lost = is_lost();
  const std::set<std::string> names(what.controllers.begin(), what.controllers.end());
  ++requests_begun_;
  auto outcome = inner_->request(what, wait);
  if (outcome) {
    check_granted(names, was_lost);
  } else if (!may_fail_ && !may_be_lost_) {
    blame(fmt::format("a request for {} failed: {}", names, outcome.error().message));
  }
  ++requests_ended_;
  answered(1);
  return outcome;
}

void CheckedRobot::check_granted(const std::set<std::string>& names, bool was_lost) {
  if (was_lost) blame("a request was carried out after the robot had been taken over");
  const model::Network runs = runtime_.belief();
  const model::Network expected = united(controllers_, names);
  if (!may_be_lost_ && !equivalent(runs, expected))
    blame(fmt::format("{} was requested, but the robot runs: {}", names, differences(runs, expected)));
  const Lock lock(mutex_);
  running_ = names;
}

Result<mission::ControllerTrouble> CheckedRobot::trouble(std::string_view controller, const Wait& wait) {
  const bool was_lost = is_lost();
  const int ended_before = requests_ended_;
  auto trouble = inner_->trouble(controller, wait);
  const bool others_asked = requests_begun_ != ended_before;
  if (trouble) check_fine(std::string(controller), *trouble, was_lost, others_asked);
  answered(1);
  return trouble;
}

void CheckedRobot::check_fine(const std::string& name, const mission::ControllerTrouble& trouble,
                              bool was_lost, bool others_asked) {
  const bool is_fine = trouble.why.empty() && trouble.tasks.empty();
  if (was_lost && is_fine) blame(name + " was said to run although the robot had been taken over");
  if (may_be_lost_ || others_asked) return;
  const bool was_granted = running().contains(name);
  if (is_fine && !was_granted) blame(name + " was said to run, but had not been requested");
  if (!is_fine && was_granted && !may_fail_) blame(name + " was said not to run: " + trouble.why);
}

void CheckedRobot::answered(int count) {
  answers_ += count;
  answers_.notify_all();
}

void CheckedRobot::await_answers(int count) const {
  for (int so_far = answers_; so_far < count; so_far = answers_)
    answers_.wait(so_far);
}

}  // namespace segue::testing
