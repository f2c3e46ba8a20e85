// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/check_transitions.hpp>

#include <segue/base/text.hpp>
#include <segue/model/controller_names.hpp>
#include <segue/solve/combine.hpp>
#include <segue/solve/solve.hpp>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>

namespace segue::solve {

namespace {

class TransitionCheck {
 public:
  TransitionCheck(const model::Transition& transition, const std::vector<model::Network>& controllers,
                  const model::ComponentCatalog& catalog, Diagnostics& diagnostics)
      : transition_(transition), controllers_(controllers), catalog_(catalog), diagnostics_(diagnostics) {}

  void run(model::Depth depth) {
    const auto from = network(transition_.from);
    if (!from) return error("unknown-controller", "'from': " + from.error().message);
    const auto result = predict(*from, transition_, catalog_);
    if (!result)
      return diagnostics_.error("bad-action", about(result.error()), place(result.error().subject));
    const Diagnostics found = model::validate(*result, catalog_, depth);
    if (found.has_errors())
      return error("bad-result", "it leads to a network with errors: " + found.to_error().message);
    const auto to = network(transition_.to);
    if (!to || equivalent(*to, *result)) return;
    const auto what = model::differences(*to, *result, 1);
    diagnostics_.warning(
        "other-result",
        name() + " leads to another network than " +
            (transition_.to.empty() ? "the empty one" : "controller " + quote(transition_.to.str())) +
            (what.empty() ? "" : ": " + what.front()),
        {transition_.file, 0, 0});
  }

 private:
  [[nodiscard]] std::string name() const { return "transition " + quote(transition_.name); }
  [[nodiscard]] std::string about(const Error& why) const { return name() + ": " + why.message; }

  void error(std::string code, const std::string& message) {
    diagnostics_.error(std::move(code), name() + ": " + message, {transition_.file, 0, 0});
  }

  /// Of an action by its id; of the file where it is none.
  [[nodiscard]] SourceLocation place(const std::string& id) const {
    std::size_t number = 0;
    std::from_chars(id.data(), id.data() + id.size(), number);
    const bool is_known = number >= 1 && number <= transition_.places.size();
    return is_known ? transition_.places[number - 1] : SourceLocation{transition_.file, 0, 0};
  }

  [[nodiscard]] Result<model::Network> network(const model::NetworkName& wanted) const {
    std::vector<model::Network> parts;
    std::vector<std::string> names;
    for (const model::Network& controller : controllers_)
      names.push_back(controller.name.str());
    for (const model::NetworkName& part : model::controllers_in(wanted.str())) {
      const auto found = std::ranges::find(controllers_, part, &model::Network::name);
      if (found == controllers_.end()) {
        return fail(ErrorCode::NotFound,
                    "the robot has no controller " + quote(part.str()) + did_you_mean(part.str(), names));
      }
      parts.push_back(*found);
    }
    if (parts.empty()) return model::Network{};
    return parts.size() == 1 ? std::move(parts.front()) : combine(parts, catalog_);
  }

  const model::Transition& transition_;
  const std::vector<model::Network>& controllers_;
  const model::ComponentCatalog& catalog_;
  Diagnostics& diagnostics_;
};

}  // namespace

Diagnostics check_transitions(const std::vector<model::Transition>& transitions,
                              const std::vector<model::Network>& controllers,
                              const model::ComponentCatalog& catalog, model::Depth depth) {
  Diagnostics diagnostics;
  for (const model::Transition& transition : transitions)
    TransitionCheck(transition, controllers, catalog, diagnostics).run(depth);
  diagnostics.sort();
  return diagnostics;
}

}  // namespace segue::solve
