// SPDX-License-Identifier: Apache-2.0
#include <segue/base/shortage.hpp>
#include <segue/mission/units.hpp>

#include <algorithm>
#include <iterator>
#include <limits>
#include <memory>

namespace segue::mission {

namespace {

/// The units that all uses of the resource take together.
std::int64_t taken(std::span<const UnitUse> uses, std::string_view resource) {
  std::int64_t sum = 0;
  for (const UnitUse& use : uses) {
    const bool takes = use.operation == ResourceOperation::Block ||
                       use.operation == ResourceOperation::Consume ||
                       use.operation == ResourceOperation::Delete;
    if (takes && use.resource == resource) sum += use.count;
  }
  return sum;
}

}  // namespace

type::Value to_value(const UnitChanges& changes) {
  type::ValueMap map;
  for (const auto& [resource, change] : changes)
    map.set(resource, change);
  return map;
}

UnitChanges unit_changes(const type::ValueMap& map) {
  UnitChanges changes;
  for (const auto& [resource, change] : map) {
    if (change.is_integer()) changes.emplace_back(resource, change.as_int());
  }
  return changes;
}

Units::Units(const Counts& counts) {
  for (const auto& [name, count] : counts)
    stocks_[name].total = count;
}

Units::Counts Units::counts() const {
  Counts counts;
  for (const auto& [name, stock] : stocks_)
    counts.emplace(name, static_cast<std::uint32_t>(stock.total));
  return counts;
}

UnitChanges Units::changes_since(const Counts& counts) const {
  UnitChanges changes;
  for (const auto& [name, stock] : stocks_) {
    const auto before = counts.find(name);
    const std::int64_t change = stock.total - (before == counts.end() ? 1 : before->second);
    if (change != 0) changes.emplace_back(name, change);
  }
  return changes;
}

Units::Stock Units::stock(std::string_view resource) const {
  const auto found = stocks_.find(resource);
  return found == stocks_.end() ? Stock() : found->second;
}

std::optional<std::string> Units::shortage(std::span<const UnitUse> uses) const {
  for (const UnitUse& use : uses) {
    const std::int64_t there = stock(use.resource).total;
    const bool exists = use.operation == ResourceOperation::Exists;
    if ((exists ? std::int64_t{use.count} : taken(uses, use.resource)) > there)
      return shortage_text(use.resource, use.count, static_cast<std::uint64_t>(there));
  }
  return std::nullopt;
}

/// Whether this use, of all `uses` of an execution, need not wait.
bool Units::is_free(const UnitUse& use, std::span<const UnitUse> uses, Limits limits) const {
  const Stock there = stock(use.resource);
  const std::int64_t most = limits == Limits::Passed ? there.total : std::min(there.total, there.limit);
  if (use.operation == ResourceOperation::Exists) return most >= use.count + there.leaving;
  const bool removes =
      use.operation == ResourceOperation::Consume || use.operation == ResourceOperation::Delete;
  const std::int64_t relied_on = there.relied_on.empty() ? 0 : *there.relied_on.rbegin();
  if (removes && there.total < use.count + relied_on) return false;
  const std::int64_t all = taken(uses, use.resource);
  return all == 0 || most - there.held >= all;
}

bool Units::are_free(std::span<const UnitUse> uses, Limits limits) const {
  return std::ranges::all_of(uses, [&](const UnitUse& use) { return is_free(use, uses, limits); });
}

void Units::limit(const std::string& resource, std::uint32_t units) {
  stocks_[resource].limit = units;
}

std::uint32_t Units::limit_of(std::string_view resource) const {
  return static_cast<std::uint32_t>(stock(resource).limit);
}

const UnitUse* Units::limited(std::span<const UnitUse> uses) const {
  const auto found = std::ranges::find_if(uses, [&](const UnitUse& use) {
    return !is_free(use, uses, Limits::Heeded) && is_free(use, uses, Limits::Passed);
  });
  return found == uses.end() ? nullptr : &*found;
}

bool Units::exceed_limits(std::span<const UnitUse> uses) const {
  return std::ranges::any_of(uses, [&](const UnitUse& use) {
    const bool exists = use.operation == ResourceOperation::Exists;
    return (exists ? std::int64_t{use.count} : taken(uses, use.resource)) > stock(use.resource).limit;
  });
}

bool Units::take(std::span<const UnitUse> uses, Limits limits) {
  if (!are_free(uses, limits)) return false;
  for (const UnitUse& use : uses) {
    Stock& there = stocks_[use.resource];
    const std::int64_t count = use.count;
    if (use.operation == ResourceOperation::Consume) there.total -= count;
    if (use.operation == ResourceOperation::Block) there.held += count;
    if (use.operation == ResourceOperation::Exists) there.relied_on.insert(count);
    if (use.operation != ResourceOperation::Delete) continue;
    there.held += count;
    there.leaving += count;
  }
  return true;
}

void Units::lend(const std::string& resource, std::uint32_t count, const std::string& name) {
  stocks_[resource].lent += count;
  stocks_[name] = {count};
}

void Units::take_back(const std::string& resource, std::uint32_t count, const std::string& name) {
  stocks_[resource].lent -= count;
  stocks_.erase(name);
}

bool Units::wait_for_container(std::span<const UnitUse> uses) const {
  return std::ranges::any_of(uses, [&](const UnitUse& use) {
    const Stock there = stock(use.resource);
    return there.lent > 0 && there.total - there.held < taken(uses, use.resource);
  });
}

void Units::give_back(std::span<const UnitUse> uses, bool done) {
  for (const UnitUse& use : uses) {
    Stock& there = stocks_[use.resource];
    const std::int64_t count = use.count;
    if (use.operation == ResourceOperation::Create && done) there.total += count;
    if (use.operation == ResourceOperation::Block) there.held -= count;
    if (use.operation == ResourceOperation::Exists) there.relied_on.erase(there.relied_on.find(count));
    if (use.operation != ResourceOperation::Delete) continue;
    there.held -= count;
    there.leaving -= count;
    if (done) there.total -= count;
  }
}

void Units::undo(std::span<const UnitUse> uses, bool done) {
  for (const UnitUse& use : uses) {
    const bool removed =
        use.operation == ResourceOperation::Consume || (use.operation == ResourceOperation::Delete && done);
    if (removed) stocks_[use.resource].total += use.count;
    if (use.operation == ResourceOperation::Create && done) stocks_[use.resource].total -= use.count;
  }
}

Result<Units::Counts> initial_units(const Mission& mission, const UnitCounts& given) {
  Units::Counts counts;
  for (const Resource& resource : mission.resources) {
    counts[resource.name] = resource.count == Resource::kNoCount ? std::numeric_limits<std::int32_t>::max()
                                                                 : static_cast<std::uint32_t>(resource.count);
  }
  for (const auto& [name, count] : given) {
    const auto names = [&wanted = name](const ResourceUse& use) {
      return matches_glob(resource_pattern(use.resource), wanted);
    };
    const auto uses = [&](const auto& user) { return std::ranges::any_of(user.resources, names); };
    const bool used = std::ranges::any_of(mission.actions, uses) || std::ranges::any_of(mission.states, uses);
    if (!used && !counts.contains(name))
      return fail(ErrorCode::NotFound, "no action uses a resource " + quote(name));
    counts[name] = count;
  }
  return counts;
}

UnitChanges changes_by(std::span<const UnitUse> uses, bool done) {
  UnitChanges changes;
  for (const UnitUse& use : uses) {
    const std::int64_t count = use.count;
    const bool removes =
        use.operation == ResourceOperation::Consume || (use.operation == ResourceOperation::Delete && done);
    if (removes) changes.emplace_back(use.resource, -count);
    if (use.operation == ResourceOperation::Create && done) changes.emplace_back(use.resource, count);
  }
  return changes;
}

std::vector<UnitUse> unit_uses(const Action& action, std::vector<std::string> names) {
  std::vector<UnitUse> uses;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const ResourceUse& use = action.resources[i];
    uses.push_back({use.operation, std::move(names[i]), static_cast<std::uint32_t>(use.count)});
  }
  return uses;
}

std::string resource_pattern(std::string_view resource) {
  std::string pattern;
  for (std::size_t i = 0; i < resource.size(); ++i) {
    const auto close = resource[i] == '{' ? resource.find('}', i) : std::string_view::npos;
    pattern += close == std::string_view::npos ? resource[i] : '*';
    if (close != std::string_view::npos) i = close;
  }
  return pattern;
}

namespace {

/// The names of the resources that the container blocks.
std::vector<std::string> blocked_patterns(const State& container) {
  std::vector<std::string> patterns;
  for (const ResourceUse& use : container.resources) {
    if (use.operation == ResourceOperation::Block) patterns.push_back(resource_pattern(use.resource));
  }
  return patterns;
}

}  // namespace

std::vector<std::string> varying_resources(const Mission& mission) {
  std::vector<std::string> patterns;
  for (const Action& action : mission.actions) {
    for (const ResourceUse& use : action.resources) {
      const bool changes = use.operation == ResourceOperation::Create ||
                           use.operation == ResourceOperation::Consume ||
                           use.operation == ResourceOperation::Delete;
      if (changes) patterns.push_back(resource_pattern(use.resource));
    }
  }
  for (const State& state : mission.states)
    std::ranges::move(blocked_patterns(state), std::back_inserter(patterns));
  std::ranges::sort(patterns);
  patterns.erase(std::unique(patterns.begin(), patterns.end()), patterns.end());
  return patterns;
}

/// Parents come before their children, so what is blocked around each state is known when it is looked at.
std::vector<std::string> resources_blocked_within(const Mission& mission) {
  using Patterns = std::shared_ptr<const std::vector<std::string>>;
  std::vector<std::string> all;
  for (const State& state : mission.states)
    std::ranges::move(blocked_patterns(state), std::back_inserter(all));
  std::vector<std::string> found;
  if (all.size() < 2) return found;
  const auto none = std::make_shared<const std::vector<std::string>>();
  const auto any = std::make_shared<const std::vector<std::string>>(std::move(all));
  std::vector<Patterns> inside;
  for (StateIndex i = 0; i < mission.states.size(); ++i) {
    const StateIndex parent = mission.states[i].parent;
    const Patterns around = parent != kNoState ? inside[parent] : i == 0 ? none : any;
    std::vector<std::string> own = blocked_patterns(mission.states[i]);
    for (const std::string& pattern : own) {
      const auto overlaps = [&](const std::string& other) {
        return matches_glob(pattern, other) || matches_glob(other, pattern);
      };
      if (std::ranges::any_of(*around, overlaps)) found.push_back(pattern);
    }
    if (!own.empty()) own.insert(own.end(), around->begin(), around->end());
    inside.push_back(own.empty() ? around : std::make_shared<const std::vector<std::string>>(std::move(own)));
  }
  return found;
}

}  // namespace segue::mission
