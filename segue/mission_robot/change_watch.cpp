// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_robot/change_watch.hpp>

#include <utility>

namespace segue::mission {

ChangeWatch::ChangeWatch(CommandedRobot& robot, std::shared_ptr<Bell> bell)
    : robot_(robot), question_(std::move(bell)) {}

void ChangeWatch::ask() {
  const TimePoint now = RealClock::instance().now();
  if (question_.is_asked() || now < ask_at_) return;
  question_.ask(now + kPatience, [this](const Wait& wait, ChangesAnswer answered) {
    robot_.changes(seen_, wait, std::move(answered));
  });
}

bool ChangeWatch::take() {
  const auto answer = question_.take();
  if (!answer) return false;
  if (*answer) seen_ = **answer;
  ask_at_ = RealClock::instance().now() + (*answer ? kBetweenNews : kBetweenTries);
  return true;
}

TimePoint ChangeWatch::next_question() const {
  return question_.is_asked() ? TimePoint::max() : ask_at_;
}

}  // namespace segue::mission
