// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/mission/footprint.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace segue::mission {

/// One execution's use of units of a resource, whose name is complete.
struct UnitUse {
  ResourceOperation operation = ResourceOperation::Block;
  std::string resource;
  std::uint32_t count = 1;
  friend bool operator==(const UnitUse&, const UnitUse&) = default;
};

/// How many units there are of some resources.
using UnitCounts = std::vector<std::pair<std::string, std::uint32_t>>;
/// How many more units of some resources there are than before, or fewer.
using UnitChanges = std::vector<std::pair<std::string, std::int64_t>>;

/// Changes as a map, as journals have them: the change by the resource; entries that are not numbers are left
/// out.
type::Value to_value(const UnitChanges& changes);
UnitChanges unit_changes(const type::ValueMap& map);

/// How many units of each resource there are while a mission runs sequentially, and which of them executions
/// hold. A resource that is not counted has one unit. An execution gets all that it asks for or nothing. The
/// same rules as those of task_network::ResourcePool. Not thread safe.
class Units {
 public:
  using Counts = std::map<std::string, std::uint32_t, std::less<>>;

  explicit Units(const Counts& counts = {});

  /// The existing units, held or not, of all resources that are counted or have been used.
  [[nodiscard]] Counts counts() const;
  /// The changes since the counts were these.
  [[nodiscard]] UnitChanges changes_since(const Counts& counts) const;
  /// Why these uses cannot be had even if every execution gave back what it holds; nothing if they can.
  [[nodiscard]] std::optional<std::string> shortage(std::span<const UnitUse> uses) const;
  /// Whether limits of what can be taken matter (limit()): not to who had begun in an earlier run.
  enum class Limits : std::uint8_t { Heeded, Passed };
  /// Whether nobody holds so many that these uses must wait, and the limits permit them.
  [[nodiscard]] bool are_free(std::span<const UnitUse> uses, Limits limits = Limits::Heeded) const;
  /// Takes them for an execution that begins, unless others hold some of them (false), there is a shortage,
  /// or a limit does not permit it.
  bool take(std::span<const UnitUse> uses, Limits limits = Limits::Heeded);
  /// From now on that many units of the resource can be taken at most, with those that are held; kAllUnits:
  /// all. Who holds more keeps them. All units count as existing nevertheless.
  void limit(const std::string& resource, std::uint32_t units);
  /// The first of these uses that could be had if there were no limits, as far as its own resource is
  /// concerned; null: limits keep nobody waiting.
  [[nodiscard]] const UnitUse* limited(std::span<const UnitUse> uses) const;
  /// Whether a limit is below what these uses need, even if nobody held any units.
  [[nodiscard]] bool exceed_limits(std::span<const UnitUse> uses) const;
  /// The units of the resource that can be taken at most.
  [[nodiscard]] std::uint32_t limit_of(std::string_view resource) const;
  /// A container that has taken units of the resource lends them to what is in it: they exist as units of
  /// `name`.
  void lend(const std::string& resource, std::uint32_t count, const std::string& name);
  /// Ends the loan: these units of `name` do not exist any more.
  void take_back(const std::string& resource, std::uint32_t count, const std::string& name);
  /// Whether containers hold units that these uses must wait for: not only what runs now.
  [[nodiscard]] bool wait_for_container(std::span<const UnitUse> uses) const;
  /// The execution that took them has ended. `done`: as expected, so that it has created and deleted what it
  /// declares; what it consumed is gone in either case.
  void give_back(std::span<const UnitUse> uses, bool done);
  /// Undoes an execution that has given them back: the units are as if it had never been.
  void undo(std::span<const UnitUse> uses, bool done);

 private:
  struct Stock {
    std::int64_t total = 1;
    std::int64_t held = 0;
    std::int64_t leaving = 0;                 ///< held by executions that delete them
    std::int64_t lent = 0;                    ///< held by containers
    std::int64_t limit = kAllUnits;           ///< how many can be taken
    std::multiset<std::int64_t> relied_on{};  ///< by running executions to which they must exist
  };
  [[nodiscard]] Stock stock(std::string_view resource) const;
  [[nodiscard]] bool is_free(const UnitUse& use, std::span<const UnitUse> uses, Limits limits) const;

  std::map<std::string, Stock, std::less<>> stocks_;
};

/// The units that there are when a run begins: those of the mission, overridden by `given`; plenty, of a
/// robot's resource without a number. NotFound for a resource that the mission neither declares nor uses.
Result<Units::Counts> initial_units(const Mission& mission, const UnitCounts& given);

/// The changes by an execution with these uses, of which several may concern one resource. `done`: as of
/// Units::give_back().
UnitChanges changes_by(std::span<const UnitUse> uses, bool done);

/// The uses of an execution: those that the action declares, with these names (Footprint::resources).
std::vector<UnitUse> unit_uses(const Action& action, std::vector<std::string> names);

/// The name of a resource with "*" in place of each input: "cup_{n}" as "cup_*".
std::string resource_pattern(std::string_view resource);

/// Patterns of the resources of which some action creates, consumes or deletes units, or which a container
/// blocks. Those who use one take their units in program order, also side by side.
std::vector<std::string> varying_resources(const Mission& mission);

/// Patterns of the resources that a container blocks inside another one that blocks them too. A library may
/// be inside any container.
std::vector<std::string> resources_blocked_within(const Mission& mission);

}  // namespace segue::mission
