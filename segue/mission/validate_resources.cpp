// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/checks.hpp>
#include <segue/mission/kept_units.hpp>
#include <segue/mission/units.hpp>

#include <algorithm>
#include <limits>
#include <string_view>
#include <unordered_map>

namespace segue::mission::detail {
namespace {

/// Whether both names may stand for the same resource.
bool meets(const std::string& a, const std::string& b) {
  const std::string one = resource_pattern(a);
  const std::string other = resource_pattern(b);
  return matches_glob(one, other) || matches_glob(other, one);
}

/// Finds the resources that can exist: those that exist at the beginning, and repeatedly those that are
/// created by actions whose own needs can be met.
class Creation {
 public:
  Creation(const Mission& mission, Diagnostics& diagnostics) : mission_(mission), diagnostics_(diagnostics) {
    for (const Resource& resource : mission.resources) {
      if (resource.count > 0 || resource.of_robot) there_.push_back(resource.name);
    }
  }

  void run() {
    std::vector<const Action*> waiting;
    for (const Action& action : mission_.actions) {
      if (!action.resources.empty()) waiting.push_back(&action);
    }
    for (std::size_t before = waiting.size() + 1; waiting.size() < before;) {
      before = waiting.size();
      std::erase_if(waiting, [this](const Action* action) { return goes(*action); });
    }
    for (const Action* action : waiting)
      report(*action);
  }

 private:
  bool goes(const Action& action) {
    if (std::ranges::any_of(action.resources, [this](const ResourceUse& use) { return lacks(use); }))
      return false;
    for (const ResourceUse& use : action.resources) {
      if (use.operation == ResourceOperation::Create) there_.push_back(resource_pattern(use.resource));
    }
    return true;
  }

  /// Only a resource that an action creates, or that is declared with count 0, can be missing; any other
  /// exists once.
  [[nodiscard]] bool lacks(const ResourceUse& use) const {
    if (use.operation == ResourceOperation::Create || use.operation == ResourceOperation::Release)
      return false;
    const std::string pattern = resource_pattern(use.resource);
    const bool there =
        std::ranges::any_of(there_, [&](const std::string& known) { return meets(known, pattern); });
    return !there && is_made(use.resource, pattern);
  }

  [[nodiscard]] bool is_made(const std::string& resource, const std::string& pattern) const {
    for (const Resource& known : mission_.resources) {
      if (known.name == resource) return known.count == 0 && !known.of_robot;
    }
    return !creators(pattern).empty();
  }

  [[nodiscard]] std::vector<std::string> creators(const std::string& pattern) const {
    std::vector<std::string> names;
    for (const Action& action : mission_.actions) {
      const bool creates = std::ranges::any_of(action.resources, [&](const ResourceUse& use) {
        return use.operation == ResourceOperation::Create && meets(use.resource, pattern);
      });
      if (creates) names.push_back(action.name.str());
    }
    return names;
  }

  void report(const Action& action) {
    for (const ResourceUse& use : action.resources) {
      if (!lacks(use)) continue;
      const auto makers = creators(resource_pattern(use.resource));
      const std::string why = makers.empty() ? "no action creates one, and none exists at the beginning"
                                             : "it is created only by " + listed(makers) +
                                                   ", which can itself only run once it is there";
      diagnostics_.error("never-created",
                         "action " + quote(action.name.str()) + " needs the resource " + quote(use.resource) +
                             ", but " + why,
                         use.where);
    }
  }

  const Mission& mission_;
  Diagnostics& diagnostics_;
  std::vector<std::string> there_;
};

bool is_created(const Mission& mission, const std::string& resource) {
  return std::ranges::any_of(mission.actions, [&](const Action& action) {
    return std::ranges::any_of(action.resources, [&](const ResourceUse& use) {
      return use.operation == ResourceOperation::Create &&
             matches_glob(resource_pattern(use.resource), resource);
    });
  });
}

/// The units that this use and others of the action take together; 0 if this is not the first of several, or
/// one of them takes more than there are by itself.
std::int64_t taken_with(const Action& action, const ResourceUse& use, int there) {
  std::int64_t sum = 0;
  const ResourceUse* first = nullptr;
  for (const ResourceUse& each : action.resources) {
    const bool takes = each.operation == ResourceOperation::Block ||
                       each.operation == ResourceOperation::Consume ||
                       each.operation == ResourceOperation::Delete;
    if (!takes || each.resource != use.resource) continue;
    if (each.count > there) return 0;
    if (first == nullptr) first = &each;
    sum += each.count;
  }
  return first == &use && sum > use.count ? sum : 0;
}

/// Checks the use of a resource whose name is known; `declared` is null if it is not declared.
void check_use(const Action& action, const ResourceUse& use, const Resource* declared, const Mission& mission,
               const std::string& what, Diagnostics& diagnostics) {
  const int there = declared == nullptr  ? 1
                    : declared->of_robot ? std::numeric_limits<int>::max()
                                         : declared->count;
  const bool needs =
      use.operation != ResourceOperation::Create && use.operation != ResourceOperation::Release;
  if (needs && there > 0 && use.count > there && !is_created(mission, use.resource)) {
    diagnostics.error("too-few",
                      what + "it needs " + std::to_string(use.count) + " of the resource " +
                          quote(use.resource) + ", but there " + (there == 1 ? "is " : "are ") +
                          std::to_string(there) + " at the beginning, and no action creates more",
                      use.where);
  } else if (const std::int64_t all = taken_with(action, use, there);
             there > 0 && all > there && !is_created(mission, use.resource)) {
    diagnostics.error("too-few",
                      what + "with its other uses it needs " + std::to_string(all) + " of the resource " +
                          quote(use.resource) + ", but there " + (there == 1 ? "is " : "are ") +
                          std::to_string(there) + " at the beginning, and no action creates more",
                      use.where);
  }
  for (const auto& [key, parameter] : use.parameters.as_map()) {
    const type::Value* own = declared == nullptr ? nullptr : declared->parameters.find(key);
    if (own == nullptr) {
      diagnostics.error("unknown-parameter",
                        what + "the resource " + quote(use.resource) + " has no parameter " + quote(key) +
                            (declared == nullptr ? "; declare it under 'resources'" : ""),
                        use.where);
    } else if (!parameter_input(parameter) && !(parameter == *own)) {
      diagnostics.error("parameter-mismatch",
                        what + "the parameter " + quote(key) + " of the resource " + quote(use.resource) +
                            " is " + type::describe(*own) + ", not " + type::describe(parameter),
                        use.where);
    }
  }
}

/// Whether some action keeps units that this use may release.
bool is_kept(const Mission& mission, const ResourceUse& use) {
  return std::ranges::any_of(mission.actions, [&](const Action& other) {
    return std::ranges::any_of(other.resources, [&](const ResourceUse& other_use) {
      return other_use.keep && meets(other_use.resource, use.resource);
    });
  });
}

/// Units that are kept must be of a declared resource, and what is released must be kept by some action.
void check_kept(const Mission& mission, Diagnostics& diagnostics) {
  for (const Action& action : mission.actions) {
    for (const ResourceUse& use : action.resources) {
      const auto kept = kept_resource(use);
      if (!kept) continue;
      const std::string what = "action " + quote(action.name.str()) + ": ";
      const auto declares = [&](const Resource& known) { return meets(*kept, known.name); };
      if (std::ranges::none_of(mission.resources, declares)) {
        diagnostics.error(
            "undeclared-resource",
            what + "units of " + quote(*kept) + " can be kept only if it is declared under 'resources'",
            use.where);
      }
      if (use.operation != ResourceOperation::Release || is_kept(mission, use)) continue;
      diagnostics.warning("release-without-keep",
                          what + "it releases " + quote(use.resource) +
                              ", which no action keeps: one must have it with {block: " + use.resource +
                              ", keep: true}; other blocks end with their action",
                          use.where);
    }
  }
}

/// How many units there are of an observed resource, the robot says alone.
void check_observed_units(const Mission& mission, Diagnostics& diagnostics) {
  for (const Resource& resource : mission.resources) {
    if (!resource.observe) continue;
    if (resource.of_robot) {
      diagnostics.error("observed-units",
                        "resource " + quote(resource.name) +
                            ": the robot either shows how many units there are ('observe') or keeps count of "
                            "them ('of: robot')",
                        resource.where);
    } else if (resource.count < 1) {
      diagnostics.error("observed-units",
                        "resource " + quote(resource.name) +
                            ": the robot shows at most 'count' units, which must be 1 or more",
                        resource.where);
    }
    for (const Action& action : mission.actions) {
      for (const ResourceUse& use : action.resources) {
        const bool only_uses =
            use.operation == ResourceOperation::Block || use.operation == ResourceOperation::Exists;
        if ((only_uses && !use.keep) || !meets(use.resource, resource.name)) continue;
        diagnostics.error("observed-units",
                          "action " + quote(action.name.str()) + ": the resource " + quote(resource.name) +
                              " is observed, so the robot says how many units there are; an action can only "
                              "block units and require that they exist",
                          use.where);
      }
    }
  }
}

/// A container only holds and requires units.
void check_container(const ResourceUse& use, const std::string& what, Diagnostics& diagnostics) {
  const bool fits =
      !use.keep && (use.operation == ResourceOperation::Block || use.operation == ResourceOperation::Exists);
  if (fits) return;
  diagnostics.error("container-resource",
                    what +
                        "what has states can only block units and require that they exist; an action in it " +
                        "can create, use up, keep and release them",
                    use.where);
}

}  // namespace

void check_resources(const Mission& mission, Diagnostics& diagnostics) {
  Creation(mission, diagnostics).run();
  check_kept(mission, diagnostics);
  check_observed_units(mission, diagnostics);
  std::unordered_map<std::string_view, const Resource*> resources;
  for (const Resource& resource : mission.resources)
    resources.try_emplace(resource.name, &resource);
  const auto check = [&](const Action& user, const std::string& what) {
    for (const ResourceUse& use : user.resources) {
      if (!placeholders(use.resource).empty()) continue;
      const auto found = resources.find(use.resource);
      check_use(user, use, found == resources.end() ? nullptr : found->second, mission, what, diagnostics);
    }
  };
  for (const Action& action : mission.actions)
    check(action, "action " + quote(action.name.str()) + ": ");
  for (StateIndex i = 0; i < mission.states.size(); ++i) {
    const std::string what = state_text(mission, i) + ": ";
    for (const ResourceUse& use : mission.states[i].resources)
      check_container(use, what, diagnostics);
    if (const auto declared = declared_by(mission.states[i])) check(*declared, what);
  }
}

}  // namespace segue::mission::detail
