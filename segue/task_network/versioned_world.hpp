// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/cow_ptr.hpp>
#include <segue/task_network/fact.hpp>
#include <segue/task_network/node_ids.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace segue::task_network {

/// Data that a user attaches to a world, such as a geometric model, and that follows the facts: `changed` is
/// called for every change, on a copy of its own if the data are shared.
class UserData : public CowObject {
 public:
  /// A copy that can change without this one being touched.
  [[nodiscard]] virtual CowPtr<UserData> clone() const = 0;
  /// `literal` has become true. Called on the thread that changes the world.
  virtual void changed(const Literal& literal) = 0;
};

/// The facts that hold, each with the version of the world at which it changed last. A copy is a snapshot in
/// constant time that shares unchanged pages (a persistent tree); a change costs the depth of the tree, at
/// most
/// 7. Copies may be used on different threads at the same time; a single object belongs to one thread.
class VersionedWorld {
 public:
  /// False until it was set.
  [[nodiscard]] bool holds(FactId fact) const { return (cell(fact) & 1U) != 0; }
  [[nodiscard]] bool holds(const Literal& literal) const { return holds(literal.fact) == literal.value; }
  /// Counts the changes of all facts.
  [[nodiscard]] std::uint64_t version() const { return version_; }
  /// The version at which the fact got its present value; 0 if it never changed.
  [[nodiscard]] std::uint64_t version_of(FactId fact) const { return cell(fact) >> 1; }

  /// Changes nothing, the version neither, where the fact has that value already. Returns whether it changed.
  bool set(const Literal& literal);

  /// A number that two copies of one world share if the same changes were made to both since, in the same
  /// order; else hardly ever (one time in 2^64).
  [[nodiscard]] std::uint64_t history() const { return history_; }

  /// Attaches data under a name, in the place of what had that name.
  void attach(std::string name, CowPtr<UserData> data);
  /// Null where nothing has that name. Valid until this world changes.
  [[nodiscard]] const UserData* attached(std::string_view name) const;

  [[nodiscard]] bool has_attachments() const { return !attachments_.empty(); }
  /// Replaces all attached data by that of `other`.
  void take_attachments_of(const VersionedWorld& other) { attachments_ = other.attachments_; }

  /// The facts that hold, in the order of their ids. Linear in the largest id.
  [[nodiscard]] std::vector<FactId> facts() const;
  /// The facts that hold as texts, sorted.
  [[nodiscard]] std::vector<std::string> texts(const FactTable& table) const;

  /// Whether the same facts hold; versions and user data aside. Does not look at what both share.
  friend bool operator==(const VersionedWorld& a, const VersionedWorld& b);

 private:
  static constexpr unsigned kBits = 5;
  static constexpr std::size_t kWidth = std::size_t{1} << kBits;
  struct Page : CowObject {};
  struct Leaf final : Page {
    std::uint64_t cells[kWidth] = {};  ///< version * 2 + value
  };
  struct Inner final : Page {
    CowPtr<Page> children[kWidth];
  };
  struct Attachment {
    std::string name;
    CowPtr<UserData> data;
  };

  [[nodiscard]] std::uint64_t cell(FactId fact) const;
  std::uint64_t& writable_cell(FactId fact);
  static bool same(const Page* a, const Page* b, unsigned depth);
  static void collect(const Page* page, unsigned depth, std::uint32_t first, std::vector<FactId>& facts);
  [[nodiscard]] bool reaches(std::uint32_t number) const;

  CowPtr<Page> root_;
  unsigned depth_ = 0;  ///< inner levels above the leaves
  std::uint64_t version_ = 0;
  std::uint64_t history_ = 0;
  std::vector<Attachment> attachments_;
};

}  // namespace segue::task_network
