// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/task_network/flat_file.hpp>
#include <segue/type/value.hpp>

#include <initializer_list>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace segue::task_network::detail {

/// Reads the tree of a flat task network into a network. Internal to read_flat_network.
class FlatReader {
 public:
  FlatReader(FlatNetwork& flat, std::string file, Diagnostics& diagnostics)
      : flat_(flat), network_(flat.network), file_(std::move(file)), diagnostics_(diagnostics) {}
  void read(const type::Value& root);

 private:
  struct Entry {
    const type::Value* value = nullptr;
    NodeSpec spec;
    Trial trial;
  };
  void error(std::string code, std::string message, const type::Value& at);
  void refuse_unknown(const type::Value& map, const std::string& what,
                      std::initializer_list<std::string_view> known);
  const type::Value* find(const type::Value& map, std::string_view key, type::Value::Kind kind);
  const type::Value::List& list(const type::Value& map, std::string_view key);
  std::string text(const type::Value& map, std::string_view key);
  bool flag(const type::Value& map, std::string_view key, bool fallback);
  std::uint32_t count(const type::Value& map, std::string_view key, std::uint32_t fallback);

  void read_world(const type::Value& root);
  void read_resources(const type::Value& root);
  void order_nodes(const type::Value& root);
  void read_node(Entry& entry);
  void read_class(Entry& entry);
  void read_duration(Entry& entry);
  void read_facts(Entry& entry);
  void read_claims(Entry& entry);
  void read_flows(const Entry& entry);
  void read_conditions(Entry& entry);
  void read_likelihood(const type::Value& value, Condition& condition);
  void read_trial(Entry& entry);
  void join_releases();
  std::optional<Literal> literal(const type::Value& value);
  std::optional<Literal> effect(const type::Value& value);
  std::optional<std::uint32_t> node_named(const type::Value& name, std::uint32_t before);

  FlatNetwork& flat_;
  TaskNetwork& network_;
  std::string file_;
  Diagnostics& diagnostics_;
  std::vector<Entry> entries_;
  std::unordered_map<std::string, std::uint32_t> numbers_;
};

}  // namespace segue::task_network::detail
