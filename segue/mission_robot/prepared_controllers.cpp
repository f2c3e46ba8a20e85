// SPDX-License-Identifier: Apache-2.0
#include <segue/concurrent/thread.hpp>
#include <segue/mission_robot/prepared_controllers.hpp>

#include <algorithm>
#include <utility>

namespace segue::mission {

PreparedControllers::PreparedControllers(std::shared_ptr<CommandedRobot> robot, std::size_t most,
                                         Duration deadline)
    : robot_(std::move(robot)), most_(most), deadline_(deadline) {
  if (most_ == 0) return;
  thread_ = concurrent::start_stoppable_thread("segue-prepare",
                                               [this](const std::stop_token& stop) { work(stop); });
}

PreparedControllers::~PreparedControllers() = default;

void PreparedControllers::began(std::uint64_t action, std::string controller,
                                std::vector<UpcomingController> ahead) {
  const Lock lock(mutex_);
  std::erase_if(running_, [](const auto& entry) { return entry.second.has_ended; });
  running_[action] = {std::move(controller), std::move(ahead), false};
  if (likeliest() != prepared_) changed_.notify_all();
}

void PreparedControllers::ended(std::uint64_t action) {
  const Lock lock(mutex_);
  const auto found = running_.find(action);
  if (found != running_.end()) found->second.has_ended = true;
}

/// The likeliest controllers ahead, without those that run.
std::vector<std::string> PreparedControllers::likeliest() const {
  std::map<std::string, UpcomingController> all;
  for (const auto& [action, running] : running_) {
    for (const UpcomingController& one : running.ahead) {
      UpcomingController& sum = all.try_emplace(one.controller, one).first->second;
      sum.probability = std::max(sum.probability, one.probability);
      sum.after = std::min(sum.after, one.after);
    }
  }
  for (const auto& [action, running] : running_)
    all.erase(running.controller);
  std::vector<UpcomingController> ordered;
  for (auto& [name, one] : all)
    ordered.push_back(std::move(one));
  std::ranges::sort(ordered, sooner_or_likelier);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < std::min(most_, ordered.size()); ++i)
    names.push_back(std::move(ordered[i].controller));
  return names;
}

/// A robot that cannot prepare them runs the mission all the same.
void PreparedControllers::work(const std::stop_token& stop) {
  Lock lock(mutex_);
  while (!stop.stop_requested()) {
    changed_.wait(mutex_, stop, [this]() SEGUE_REQUIRES(mutex_) { return likeliest() != prepared_; });
    if (stop.stop_requested()) break;
    prepared_ = likeliest();
    lock.unlock();
    [[maybe_unused]] const auto done =
        robot_->prepare(prepared_, {RealClock::instance().now() + deadline_, stop});
    lock.lock();
  }
  lock.unlock();
  // Nobody waits until the robot has released them.
  if (!prepared_.empty()) [[maybe_unused]]
    const auto told = robot_->prepare({}, RealClock::instance().now());
}

}  // namespace segue::mission
