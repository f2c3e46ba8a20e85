// SPDX-License-Identifier: Apache-2.0
#include <segue/journal/entries.hpp>

#include <algorithm>

namespace segue::journal {

Lesson lesson_of(const TransitionEntry& entry) {
  Lesson lesson;
  for (const ActionEntry& action : entry.actions) {
    if (action.outcome != kDone || action.duration < Duration(0)) {
      continue;
    }
    lesson.actions.push_back({{action.component, action.kind, action.host}, action.duration});
    lesson.waits.push_back(std::max(action.waited, Duration(0)));
  }
  return lesson;
}

}  // namespace segue::journal
