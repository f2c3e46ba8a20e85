// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/result_history.hpp>

#include <utility>

namespace segue::runtime::detail {

namespace {

constexpr std::size_t kKeptResults = 100;
/// Of texts and properties of an action, on average.
constexpr std::size_t kBytesOfTexts = 512;

std::size_t bytes_of(const SwitchResult& result) {
  const std::size_t actions = result.actions.size() + (result.undo ? result.undo->actions.size() : 0);
  return sizeof(SwitchResult) + actions * (sizeof(ActionRecord) + kBytesOfTexts);
}

}  // namespace

void ResultHistory::add(SwitchResult result) {
  const Lock lock(mutex_);
  results_.push_back(std::move(result));
  std::size_t bytes = 0;
  for (const auto& kept : results_) {
    bytes += bytes_of(kept);
  }
  while (results_.size() > kKeptResults || (bytes > kept_bytes_ && results_.size() > 1)) {
    bytes -= bytes_of(results_.front());
    results_.pop_front();
  }
}

std::vector<SwitchResult> ResultHistory::all() const {
  const Lock lock(mutex_);
  return {results_.begin(), results_.end()};
}

std::string ResultHistory::last_error() const {
  const Lock lock(mutex_);
  return !results_.empty() && results_.back().error ? results_.back().error->message : std::string();
}

}  // namespace segue::runtime::detail
