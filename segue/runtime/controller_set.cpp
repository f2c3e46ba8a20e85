// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/controller_set.hpp>

#include <array>

namespace segue::runtime {

namespace {

bool is_same(const model::Network& before, const model::Network& after) {
  return before.version == after.version && (!before.version.empty() || before == after);
}

}  // namespace

std::string_view to_string(ControllerChange::Kind kind) {
  static constexpr std::array<std::string_view, 3> kNames = {"added", "changed", "removed"};
  return kNames.at(static_cast<std::size_t>(kind));
}

std::vector<ControllerChange> compare(const Controllers& before, const Controllers& after,
                                      const model::NetworkName& runs) {
  using Kind = ControllerChange::Kind;
  std::map<model::NetworkName, ControllerChange> changes;
  for (const auto& [name, old] : before) {
    const auto found = after.find(name);
    if (found == after.end()) {
      changes[name] = {name, Kind::Removed, false, old.file, old.version, "", {}};
    } else if (const auto& now = found->second; !is_same(old, now)) {
      changes[name] = {name,        Kind::Changed,           false, now.file, old.version,
                       now.version, model::changes(old, now)};
    }
  }
  for (const auto& [name, now] : after) {
    if (!before.contains(name)) changes[name] = {name, Kind::Added, false, now.file, "", now.version, {}};
  }
  std::vector<ControllerChange> list;
  for (auto& [name, change] : changes) {
    change.runs = name == runs;
    list.push_back(std::move(change));
  }
  return list;
}

}  // namespace segue::runtime
