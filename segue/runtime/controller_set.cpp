// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/controller_names.hpp>
#include <segue/runtime/controller_set.hpp>
#include <segue/solve/combine.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace segue::runtime {

namespace {

bool is_same(const model::Network& before, const model::Network& after) {
  return before.version == after.version && (!before.version.empty() || before == after);
}

Error no_controller(const Controllers& controllers, const model::NetworkName& wanted) {
  std::vector<std::string> names;
  for (const auto& [known, network] : controllers) {
    names.push_back(known.str());
  }
  return fail(ErrorCode::NotFound,
              "no controller " + quote(wanted.str()) + did_you_mean(wanted.str(), names));
}

}  // namespace

Result<model::Network> find_controller(const Controllers& controllers, const model::NetworkName& name,
                                       const model::ComponentCatalog& catalog) {
  std::vector<model::Network> networks;
  for (const auto& part : model::controllers_in(name.str())) {
    const auto found = controllers.find(part);
    if (found == controllers.end()) {
      return no_controller(controllers, part);
    }
    networks.push_back(found->second);
  }
  if (networks.empty()) {
    return model::Network{};
  }
  return networks.size() == 1 ? std::move(networks.front()) : solve::combine(networks, catalog);
}

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
  const auto running = model::controllers_in(runs.str());
  std::vector<ControllerChange> list;
  for (auto& [name, change] : changes) {
    change.runs = std::ranges::find(running, name) != running.end();
    list.push_back(std::move(change));
  }
  return list;
}

}  // namespace segue::runtime
