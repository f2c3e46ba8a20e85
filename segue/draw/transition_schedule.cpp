// SPDX-License-Identifier: Apache-2.0
#include <segue/draw/transition_schedule.hpp>

#include <algorithm>
#include <unordered_map>

namespace segue::draw {

namespace {

class Scheduler {
 public:
  Scheduler(const model::Transition& transition, const std::vector<Duration>& durations)
      : actions_(transition.actions), durations_(durations), decider_(actions_.size(), -1) {
    found_.actions.resize(actions_.size());
    found_.measured = durations.size() == actions_.size() && !actions_.empty();
    for (std::size_t i = 0; i < actions_.size(); ++i)
      places_.emplace(actions_[i].id, i);
  }

  Schedule schedule() {
    double now = 0;
    for (std::size_t phase = 0; phase < found_.phases.size(); ++phase) {
      found_.phases.at(phase) = {now, now};
      now = run(static_cast<model::Phase>(phase));
    }
    return std::move(found_);
  }

 private:
  /// The end of the phase.
  double run(model::Phase phase) {
    Schedule::Span& span = found_.phases.at(static_cast<std::size_t>(phase));
    int last = -1;
    for (std::size_t i = 0; i < actions_.size(); ++i) {
      if (actions_[i].phase != phase) continue;
      place(i, span.begin);
      if (last < 0 || found_.actions[i].end > span.end) last = static_cast<int>(i);
      span.end = std::max(span.end, found_.actions[i].end);
    }
    add_critical(last);
    return span.end;
  }

  void place(std::size_t i, double begin) {
    for (const int id : actions_[i].after) {
      const auto before = places_.find(id);
      if (before == places_.end() || actions_[before->second].phase != actions_[i].phase) continue;
      const double end = found_.actions[before->second].end;
      if (decider_[i] >= 0 && end <= begin) continue;
      decider_[i] = static_cast<int>(before->second);
      begin = std::max(begin, end);
    }
    found_.actions[i] = {begin, begin + length_of(i)};
  }

  [[nodiscard]] double length_of(std::size_t i) const {
    return found_.measured ? std::chrono::duration<double>(durations_[i]).count() : 1;
  }

  /// Adds the critical path of a phase: from its last action back to one that waits for nothing in the phase.
  void add_critical(int last) {
    const auto old = static_cast<std::ptrdiff_t>(found_.critical.size());
    for (int i = last; i >= 0; i = decider_[static_cast<std::size_t>(i)])
      found_.critical.push_back(i);
    std::reverse(found_.critical.begin() + old, found_.critical.end());
  }

  const std::vector<model::Action>& actions_;
  const std::vector<Duration>& durations_;
  std::unordered_map<int, std::size_t> places_;  ///< by id
  std::vector<int> decider_;                     ///< the last that the action waits for in its phase
  Schedule found_;
};

}  // namespace

Schedule schedule_of(const model::Transition& transition, const std::vector<Duration>& durations) {
  return Scheduler(transition, durations).schedule();
}

}  // namespace segue::draw
