// SPDX-License-Identifier: Apache-2.0
#include <segue/journal/entries.hpp>

#include <algorithm>

namespace segue::journal {

namespace {

/// Actions that a process carries out one after the other are quicker than this; slower ones go on beside the
/// others (host::LocalTaskHost).
constexpr Duration kQuick = std::chrono::microseconds(200);
/// Begins of what was taken up together, and ends of what was told together, one after the other.
constexpr Duration kTogether = std::chrono::microseconds(50);

Duration end_of(const ActionEntry& action) {
  return action.started + action.duration;
}

/// `b` follows `a` by batch_order().
bool of_one_batch(const ActionEntry& a, const ActionEntry& b) {
  return a.phase == b.phase && a.host == b.host && a.process == b.process &&
         b.started - a.started < kTogether && end_of(b) - end_of(a) < kTogether &&
         end_of(a) - end_of(b) < kTogether;
}

bool batch_order(const ActionEntry* a, const ActionEntry* b) {
  if (const auto order = a->host <=> b->host; order != 0) return order < 0;
  if (const auto order = a->process <=> b->process; order != 0) return order < 0;
  if (a->started != b->started) return a->started < b->started;
  return end_of(*a) < end_of(*b);
}

std::vector<const ActionEntry*> done_actions(const TransitionEntry& entry) {
  std::vector<const ActionEntry*> done;
  for (const ActionEntry& action : entry.actions) {
    if (action.outcome == kDone && action.duration >= Duration(0)) done.push_back(&action);
  }
  std::sort(done.begin(), done.end(), batch_order);
  return done;
}

}  // namespace

Lesson lesson_of(const TransitionEntry& entry) {
  const auto done = done_actions(entry);
  Lesson lesson;
  for (std::size_t first = 0; first < done.size();) {
    std::size_t last = first + 1;
    while (last < done.size() && of_one_batch(*done[last - 1], *done[last]))
      ++last;
    const Duration share =
        (end_of(*done[last - 1]) - done[first]->started) / static_cast<std::int64_t>(last - first);
    for (; first < last; ++first) {
      const ActionEntry& action = *done[first];
      lesson.actions.push_back(
          {{action.component, action.kind, action.host}, share < kQuick ? share : action.duration});
      lesson.waits.push_back(std::max(action.waited, Duration(0)));
    }
  }
  return lesson;
}

}  // namespace segue::journal
