// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/planning.hpp>

#include <segue/base/text.hpp>
#include <segue/model/validate.hpp>

#include <array>
#include <set>

namespace segue::runtime::detail {

namespace {

std::string counted(std::size_t count, std::string_view what) {
  return std::to_string(count) + ' ' + std::string(what) + (count == 1 ? "" : "s");
}

Refusal refuse(Error error) {
  return {std::move(error), {}};
}

std::optional<Refusal> refusal_for(const model::Network& network, const host::TaskHost& host,
                                   const model::ComponentCatalog& catalog) {
  Diagnostics findings = check_runnable(network, host, catalog);
  if (!findings.has_errors()) {
    return std::nullopt;
  }
  Error error = findings.to_error();
  error.subject = network.name.str();
  return Refusal{std::move(error), std::move(findings)};
}

}  // namespace

Diagnostics check_runnable(const model::Network& network, const host::TaskHost& host,
                           const model::ComponentCatalog& catalog) {
  Diagnostics findings = model::validate(network, catalog, host.validation_depth());
  std::set<model::ComponentName> seen;
  for (const auto& task : network.tasks) {
    if (!seen.insert(task.component).second || catalog.find(task.component) == nullptr) {
      continue;  // a component that nobody knows has its finding already, where that matters
    }
    if (auto possible = host.can_make(task.component); !possible) {
      findings.error("not-installed", possible.error().message, task.where);
    }
  }
  findings.append(host.check(network));
  findings.sort();
  return findings;
}

tl::expected<Plan, Refusal> plan_network(const model::Network& current, model::Network target,
                                         const host::TaskHost& host, const model::ComponentCatalog& catalog,
                                         model::Order order) {
  if (auto refusal = refusal_for(target, host, catalog)) {
    return tl::unexpected(std::move(*refusal));
  }
  auto transition = solve::diff(current, target, catalog, {order});
  if (!transition) {
    return tl::unexpected(refuse(std::move(transition.error())));
  }
  return Plan{std::move(target), std::move(*transition)};
}

tl::expected<Plan, Refusal> plan_transition(const model::Network& current, model::Transition transition,
                                            const host::TaskHost& host,
                                            const model::ComponentCatalog& catalog) {
  auto target = solve::predict(current, transition, catalog);
  if (!target) {
    return tl::unexpected(refuse(
        fail(ErrorCode::InvalidArgument,
             "the transition cannot be applied to what runs (" + summary(current) + ")", transition.to.str())
            .because_of(std::move(target.error()))));
  }
  target->name = transition.to;
  if (auto refusal = refusal_for(*target, host, catalog)) {
    return tl::unexpected(std::move(*refusal));
  }
  return Plan{std::move(*target), std::move(transition)};
}

std::string summary(const model::Network& network) {
  if (network.empty()) {
    return "nothing";
  }
  std::array<std::size_t, kTaskStateNames.size()> by_state{};
  for (const auto& task : network.tasks) {
    ++by_state.at(static_cast<std::size_t>(task.state));
  }
  std::vector<std::string> states;
  for (std::size_t state = 0; state < by_state.size(); ++state) {
    if (by_state.at(state) > 0) {
      states.push_back(std::to_string(by_state.at(state)) + ' ' + std::string(kTaskStateNames.at(state)));
    }
  }
  std::string text = counted(network.tasks.size(), "task");
  if (!states.empty()) {
    text += " (" + listed(states) + ")";
  }
  return text + ", " + counted(network.connections.size(), "connection") + ", " +
         counted(network.deployments.size(), "deployment");
}

}  // namespace segue::runtime::detail
