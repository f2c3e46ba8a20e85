// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/standby_requests.hpp>

#include <segue/runtime/process_memory.hpp>

#include <memory>
#include <string>
#include <utility>

namespace segue::runtime::detail {

std::optional<std::future<std::vector<Readiness>>> StandbyRequests::request(
    std::vector<model::NetworkName> wanted, std::uint64_t lease) {
  std::optional<std::promise<std::vector<Readiness>>> older;
  std::future<std::vector<Readiness>> future;
  std::vector<Readiness> last;
  {
    const Lock lock(mutex_);
    if (sources_.leases.refusal_of(lease)) {
      return std::nullopt;
    }
    older.swap(waiting_);
    wanted_ = std::move(wanted);
    lease_ = lease;
    future = waiting_.emplace().get_future();
    due_ = true;
    last = readiness_;
  }
  if (older) {
    older->set_value(std::move(last));
  }
  return future;
}

std::vector<PrepareRequest> StandbyRequests::known_requests(const model::Network& controller) const {
  std::vector<model::NetworkName> names;
  {
    const Lock lock(mutex_);
    if (!sources_.leases.refusal_of(lease_)) {
      names = wanted_;
    }
  }
  // A robot that runs nothing is at rest.
  const auto halt = controller.empty() ? nullptr : sources_.controllers.halt();
  std::vector<PrepareRequest> all;
  if (auto rest = halt ? sources_.controllers.expanded(halt->controller) : std::nullopt) {
    all.push_back({halt->controller, std::move(rest), true});
  }
  for (auto& wanted : names) {
    all.push_back({wanted, sources_.controllers.expanded(wanted)});
  }
  return all;
}

LookAheadPlan StandbyRequests::plan(const model::Network& controller) const {
  const auto all = known_requests(controller);
  if (all.empty()) {
    return {};
  }
  return detail::look_ahead(controller, all, sources_.catalog, budget_, memory_of(sources_.host));
}

void StandbyRequests::answer(std::vector<Readiness> readiness) {
  std::optional<std::promise<std::vector<Readiness>>> asked;
  {
    const Lock lock(mutex_);
    readiness_ = readiness;
    asked.swap(waiting_);
  }
  for (const auto& one : readiness) {
    sources_.log.add(
        EventKind::Prepared, one.controller.str(),
        one.ready ? std::to_string(one.prepared) + " of " + std::to_string(one.tasks) + " tasks are ready"
                  : one.reason);
  }
  if (asked) {
    asked->set_value(std::move(readiness));
  }
}

std::vector<Readiness> StandbyRequests::readiness() const {
  const Lock lock(mutex_);
  return readiness_;
}

void StandbyRequests::look_again() {
  const bool has_halt = sources_.controllers.halt() != nullptr;
  const Lock lock(mutex_);
  due_ = !wanted_.empty() || waiting_ || has_halt;
}

bool StandbyRequests::take_due() {
  const Lock lock(mutex_);
  return std::exchange(due_, false);
}

void StandbyRequests::end() {
  std::vector<Readiness> none;
  {
    const Lock lock(mutex_);
    for (const auto& wanted : wanted_) {
      none.push_back({wanted, false, 0, 0, "the runtime ended"});
    }
  }
  answer(std::move(none));
}

}  // namespace segue::runtime::detail
