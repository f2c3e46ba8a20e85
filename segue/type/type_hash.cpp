// SPDX-License-Identifier: Apache-2.0
//
// The hash of a type must not depend on where types are shared: a compound that uses one type twice equals
// one that uses two types of equal structure. Types without recursion are hashed from their leaves upward.
// Types that reach themselves get a hash of their own shape, which is then refined by their parts' hashes
// until no refinement tells more types apart; the number of rounds, too, follows from the structure alone.
#include <segue/base/fnv1a.hpp>
#include <segue/type/type.hpp>
#include <segue/type/type_graph.hpp>

#include <algorithm>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

namespace segue::type {
namespace {

/// FNV-1a over bytes in a fixed order, with a final mix.
class Hasher {
 public:
  void add(std::uint64_t number) {
    for (int shift = 0; shift < 64; shift += 8)
      add_byte(static_cast<unsigned char>(number >> shift));
  }
  void add(std::string_view text) {
    add(text.size());
    for (const char c : text)
      add_byte(static_cast<unsigned char>(c));
  }
  [[nodiscard]] std::uint64_t value() const {
    std::uint64_t x = state_;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31);
  }

 private:
  void add_byte(unsigned char byte) { state_ = fnv1a(byte, state_); }
  std::uint64_t state_ = kFnvBasis;
};

/// The type behind names that carry no structure: aliases, and opaques with a marshalling type.
const Type& looked_through(const Type& type) {
  const Type* at = &type;
  while ((at->kind == TypeKind::Alias || at->kind == TypeKind::Opaque) && at->element != nullptr)
    at = at->element;
  return *at;
}

struct Node {
  const Type* type = nullptr;
  std::vector<std::size_t> parts;
  std::vector<std::size_t> users;
  std::size_t open_parts = 0;
  bool fixed_layout = false;  ///< no container, pointer or unknown inside: offsets mean the same everywhere
  bool done = false;
  std::uint64_t hash = 0;
};

void add_symbols(Hasher& hasher, std::vector<EnumSymbol> symbols) {
  std::ranges::sort(symbols, {}, [](const EnumSymbol& s) { return std::pair(s.value, s.name); });
  hasher.add(symbols.size());
  for (const EnumSymbol& symbol : symbols) {
    hasher.add(symbol.name);
    hasher.add(static_cast<std::uint64_t>(symbol.value));
  }
}

class Graph {
 public:
  explicit Graph(const Type& root) {
    collect(root);
    connect();
  }

  std::uint64_t hash() {
    hash_from_leaves();
    if (!nodes_.front().done) refine();
    return nodes_.front().hash;
  }

 private:
  std::size_t index_of(const Type& type) {
    const auto [found, added] = index_.try_emplace(&type, nodes_.size());
    if (added) nodes_.push_back({&type, {}, {}, 0, false, false, 0});
    return found->second;
  }

  void collect(const Type& root) {
    index_of(looked_through(root));
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      for (const Type* part : detail::parts_of(*nodes_[i].type)) {
        const std::size_t index = index_of(looked_through(*part));
        nodes_[i].parts.push_back(index);
      }
    }
  }

  void connect() {
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      nodes_[i].open_parts = nodes_[i].parts.size();
      for (const std::size_t part : nodes_[i].parts)
        nodes_[part].users.push_back(i);
    }
  }

  void hash_from_leaves() {
    std::vector<std::size_t> ready;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (nodes_[i].open_parts == 0) ready.push_back(i);
    }
    while (!ready.empty()) {
      Node& node = nodes_[ready.back()];
      ready.pop_back();
      node.fixed_layout = has_fixed_layout(node);
      node.hash = hash_of(node);
      node.done = true;
      for (const std::size_t user : node.users) {
        if (--nodes_[user].open_parts == 0) ready.push_back(user);
      }
    }
  }

  void refine() {
    std::vector<std::size_t> recursive;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (!nodes_[i].done) recursive.push_back(i);
    }
    std::vector<std::uint64_t> next(recursive.size());
    for (std::size_t told_apart = 0;;) {
      for (std::size_t i = 0; i < recursive.size(); ++i)
        next[i] = hash_of(nodes_[recursive[i]]);
      for (std::size_t i = 0; i < recursive.size(); ++i)
        nodes_[recursive[i]].hash = next[i];
      const std::size_t classes = std::unordered_set<std::uint64_t>(next.begin(), next.end()).size();
      if (classes == told_apart) return;
      told_apart = classes;
    }
  }

  [[nodiscard]] bool has_fixed_layout(const Node& node) const {
    switch (node.type->kind) {
      case TypeKind::Numeric:
      case TypeKind::Enum:
        return true;
      case TypeKind::Array:
      case TypeKind::Compound:
        return std::ranges::all_of(node.parts, [&](std::size_t part) { return nodes_[part].fixed_layout; });
      default:
        return false;
    }
  }

  [[nodiscard]] std::uint64_t hash_of(const Node& node) const {
    const Type& type = *node.type;
    Hasher hasher;
    hasher.add(static_cast<std::uint64_t>(type.kind));
    if (node.fixed_layout) hasher.add(type.size);
    add_own_shape(hasher, type);
    for (std::size_t i = 0; i < type.fields.size(); ++i) {
      hasher.add(type.fields[i].name);
      if (node.fixed_layout) hasher.add(type.fields[i].offset);
    }
    for (const std::size_t part : node.parts)
      hasher.add(nodes_[part].hash);
    return hasher.value();
  }

  static void add_own_shape(Hasher& hasher, const Type& type) {
    hasher.add(type.fields.size());
    switch (type.kind) {
      case TypeKind::Numeric:
        hasher.add(static_cast<std::uint64_t>(type.category));
        hasher.add(static_cast<std::uint64_t>(type.nanoseconds_per_tick));
        break;
      case TypeKind::Enum:
        add_symbols(hasher, type.symbols);
        break;
      case TypeKind::Container:
        hasher.add(type.container_kind);
        break;
      case TypeKind::Array:
        hasher.add(type.count);
        break;
      case TypeKind::Opaque:
        hasher.add(type.name);
        break;
      default:
        break;
    }
  }

  std::vector<Node> nodes_;
  std::unordered_map<const Type*, std::size_t> index_;
};

}  // namespace

std::uint64_t structural_hash(const Type& type) {
  return Graph(type).hash();
}

}  // namespace segue::type
