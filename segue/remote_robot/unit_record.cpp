// SPDX-License-Identifier: Apache-2.0
#include <segue/base/secret.hpp>
#include <segue/remote_robot/unit_record.hpp>

namespace segue::remote_robot {

using type::Value;

namespace {

/// Executions of one report.
constexpr std::size_t kAtOnce = 500;

/// By which the robot recognises an execution that it is told of again.
std::string name_of(const mission::Execution& execution) {
  return execution.path + "#" + std::to_string(execution.iteration) +
         (execution.loops.empty() ? "" : ":" + execution.loops);
}

}  // namespace

std::string UnitRecord::begin(const std::string& journal) {
  const Lock lock(mutex_);
  has_journal_ = !journal.empty();
  run_ = has_journal_ ? "journal " + journal : "run " + random_secret();
  last_number_ = 0;
  return run_;
}

void UnitRecord::changed(const mission::Execution& execution, const mission::UnitChanges& changes) {
  const Lock lock(mutex_);
  // Where nothing is replayed, each call is of another execution, and some are stepped back and begin again.
  const std::string name = has_journal_ ? name_of(execution) : std::to_string(++last_number_);
  waiting_.push_back({run_, name, changes});
}

bool UnitRecord::has_waiting() const {
  const Lock lock(mutex_);
  return !waiting_.empty();
}

std::pair<Value, std::size_t> UnitRecord::waiting() const {
  const Lock lock(mutex_);
  if (waiting_.empty()) return {Value(), 0};
  Value::List changes;
  const std::string& run = waiting_.front().run;
  for (const Entry& entry : waiting_) {
    if (entry.run != run || changes.size() == kAtOnce) break;
    changes.push_back(
        Value::map({{"execution", entry.execution}, {"units", mission::to_value(entry.changes)}}));
  }
  const std::size_t count = changes.size();
  return {Value::map({{"run", run}, {"changes", std::move(changes)}}), count};
}

void UnitRecord::taken(std::size_t count) {
  const Lock lock(mutex_);
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(count));
}

}  // namespace segue::remote_robot
