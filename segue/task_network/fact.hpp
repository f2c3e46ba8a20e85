// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/task_network/name_table.hpp>
#include <segue/task_network/node_ids.hpp>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace segue::task_network {

/// Ground facts, interned: "on(box1,table)". A predicate that was declared has typed parameters, and its
/// facts are checked against the declared constants; others take any arguments. Not thread safe, but several
/// threads may read while none adds.
class FactTable {
 public:
  /// The root of all types.
  static constexpr std::string_view kObject = "object";

  FactTable();

  /// A type below `parent`, which becomes known if it is not. Fails with AlreadyExists if it has another
  /// parent, or InvalidArgument if it would be above itself.
  Result<void> declare_type(std::string_view name, std::string_view parent = kObject);
  /// A constant of one of the `types` (PDDL's "either": all of them). Fails with NotFound for an unknown
  /// type, with AlreadyExists for a constant that is there.
  Result<void> declare_constant(std::string_view name, std::span<const std::string> types);
  /// A predicate whose parameters each take any of the listed types. Fails with NotFound or AlreadyExists.
  Result<void> declare_predicate(std::string_view name, std::vector<std::vector<std::string>> parameters);

  [[nodiscard]] bool has_type(std::string_view name) const { return types_.find(name).has_value(); }
  [[nodiscard]] bool has_predicate(std::string_view name) const;
  /// Whether the constant is of one of the types, or below one. False where either is unknown.
  [[nodiscard]] bool is_a(std::string_view constant, std::span<const std::string> types) const;

  /// "p(a, b)" or "p" as a fact. Fails with ParseError for other text, with NotFound or TypeMismatch where it
  /// contradicts the declarations.
  Result<FactId> intern(std::string_view text);
  Result<FactId> intern(std::string_view predicate, std::span<const std::string> arguments);
  /// A fact like intern(), but its arguments may consist of several words: "at(red box,table)".
  Result<FactId> intern_named(std::string_view text);
  /// "p(a)" or "!p(a)".
  Result<Literal> intern_literal(std::string_view text);
  /// The fact, or nullopt if it is not interned.
  [[nodiscard]] std::optional<FactId> find(std::string_view text) const;

  /// The fact changes by itself: whoever executes nodes compares it with reality, and the network only says
  /// who comes after whom.
  void mark_observed(FactId fact);
  [[nodiscard]] bool is_observed(FactId fact) const {
    return index(fact) < observed_.size() && observed_[index(fact)];
  }

  /// "p(a,b)", "p()".
  [[nodiscard]] const std::string& text(FactId fact) const { return facts_.name(index(fact)); }
  [[nodiscard]] std::string text(const Literal& literal) const;
  [[nodiscard]] std::size_t size() const { return facts_.size(); }

 private:
  struct Predicate {
    bool declared = false;
    std::vector<std::vector<std::string>> parameters;
  };
  [[nodiscard]] Result<void> check(std::string_view predicate, std::span<const std::string> arguments) const;
  [[nodiscard]] bool below(std::uint32_t type, std::uint32_t above) const;

  NameTable types_;
  std::vector<std::uint32_t> parents_;  ///< by type; the root is its own
  NameTable constants_;
  std::vector<std::vector<std::uint32_t>> constant_types_;
  NameTable predicate_names_;
  std::vector<Predicate> predicates_;
  NameTable facts_;
  std::vector<bool> observed_;  ///< by fact; may be shorter
};

}  // namespace segue::task_network
