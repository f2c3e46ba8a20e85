// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/unit_reports.hpp>

#include <segue/base/text.hpp>
#include <segue/runtime/runtime_implementation.hpp>
#include <segue/runtime/runtime_service.hpp>
#include <segue/runtime/served_runtime.hpp>
#include <segue/type/value_at.hpp>

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace segue::runtime {

namespace detail {

namespace {

using journal::StoredUnits;
using type::Value;

/// Bytes; longer texts are of no mission.
constexpr std::size_t kLongestUnitText = 8192;

Error malformed() {
  return fail(ErrorCode::InvalidArgument, "what is reported of the robot's units is malformed");
}

std::optional<StoredUnits::Changes> changes_in(const Value* map) {
  if (map == nullptr || !map->is_map()) return std::nullopt;
  StoredUnits::Changes changes;
  for (const auto& [name, change] : map->as_map()) {
    constexpr std::int64_t kMost = std::numeric_limits<std::uint32_t>::max();
    if (change.kind() != Value::Kind::Int || change.as_int() < -kMost || change.as_int() > kMost)
      return std::nullopt;
    changes.emplace(name, change.as_int());
  }
  return changes;
}

std::optional<std::vector<StoredUnits::Execution>> executions_in(const Value& list) {
  if (!list.is_list()) return std::nullopt;
  std::vector<StoredUnits::Execution> executions;
  for (const Value& one : list.as_list()) {
    auto changes = changes_in(one.find("units"));
    const std::string name = text_at(one, "execution");
    if (!changes || name.empty() || name.size() > kLongestUnitText) return std::nullopt;
    executions.push_back({name, std::move(*changes)});
  }
  return executions;
}

Result<void> begin(const std::string& run, const Value& begun, StoredUnits& units,
                   const StoredUnits::Permit& permit) {
  const auto counts = changes_in(&begun);
  if (!counts) return malformed();
  StoredUnits::Counts given;
  for (const auto& [name, count] : *counts) {
    if (count < 0) return malformed();
    given.emplace(name, static_cast<std::uint32_t>(count));
  }
  return units.begin(run, given, permit);
}

}  // namespace

Result<void> take_units(Value& doing, std::uint64_t lease, const Leases& leases, StoredUnits& units) {
  const Value* said = doing.find("units");
  if (said == nullptr) return {};
  const std::string run = text_at(*said, "run");
  if (run.empty() || run.size() > kLongestUnitText) return malformed();
  const StoredUnits::Permit permit = [&]() -> Result<void> {
    if (leases.holder_of(lease)) return {};
    return fail(ErrorCode::InvalidState, "the robot is not commanded with that lease any more");
  };
  if (const Value* begun = said->find("begun")) {
    if (auto begins = begin(run, *begun, units, permit); !begins) return begins;
  }
  if (const Value* changes = said->find("changes")) {
    const auto executions = executions_in(*changes);
    if (!executions) return malformed();
    if (auto changed = units.change(run, *executions, permit); !changed) return changed;
  }
  doing.as_map().erase("units");
  return {};
}

}  // namespace detail

Result<type::Value> ServedRuntime::units() const {
  const auto counts = implementation_.units.counts();
  if (!counts) {
    return counts.error();
  }
  type::Value::List list;
  for (const auto& [name, count] : *counts) {
    list.push_back(type::Value::map({{"name", name}, {"count", static_cast<std::uint64_t>(count)}}));
  }
  return type::Value(std::move(list));
}

Result<std::uint32_t> ServedRuntime::set_units(std::string_view name, std::uint32_t count,
                                               const std::string& who) {
  const auto permit = [this]() -> Result<void> {
    if (auto lost = implementation_.refusal_of_lost_robot()) {
      return std::move(*lost);
    }
    const auto holder = implementation_.leases.holder();
    return !holder ? Result<void>()
                   : fail(ErrorCode::InvalidState, "the robot is commanded by " + holder->name +
                                                       ", which goes by the counts of units that it began "
                                                       "with; set them when that has ended");
  };
  auto before = implementation_.units.set(name, count, permit);
  if (before) {
    implementation_.log.add(EventKind::Units, std::string(name),
                            (who.empty() ? "somebody" : who) + " set it from " + std::to_string(*before) +
                                " to " + std::to_string(count));
  }
  return before;
}

Result<type::Value> RuntimeService::units() {
  return served_.units();
}

Result<std::uint32_t> RuntimeService::set_units(std::string_view name, std::uint32_t count,
                                                std::string_view who) {
  return served_.set_units(name, count, std::string(who));
}

}  // namespace segue::runtime
