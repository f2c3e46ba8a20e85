// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/task_network/name_table.hpp>
#include <segue/task_network/node_ids.hpp>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace segue::task_network {

/// System: hardware of the robot. Process: programs. Module: software within them. World: objects in the
/// environment, and copies of its model. Task: resources that only the plan knows.
enum class ResourceClass : std::uint8_t { System, Process, Module, World, Task };
inline constexpr std::array<std::string_view, 5> kResourceClasses{"system", "process", "module", "world",
                                                                  "task"};

/// Create: adds units when the node ends. Consume: removes units when the node starts. Delete: holds units
/// and removes them when the node ends. Block: holds units while the node runs. Release: releases the units
/// that an earlier node blocked, see GroupLock. Exists: at least that many units must exist while the node
/// runs.
enum class ResourceOp : std::uint8_t { Create, Consume, Delete, Block, Release, Exists };
inline constexpr std::array<std::string_view, 6> kResourceOps{"create", "consume", "delete",
                                                              "block",  "release", "exists"};

/// The use of a resource by a node.
struct Claim {
  ResourceId resource{};
  ResourceOp op = ResourceOp::Block;
  std::uint32_t count = 1;
  std::uint32_t group = kNone;  ///< the group lock that the node is a member of, if any
  friend bool operator==(const Claim&, const Claim&) = default;
};

/// Units of one resource that are held from the first start to the last end of a group of nodes: a block on a
/// hierarchy, or from a `block` to its `release`. Members block units out of these.
struct GroupLock {
  ResourceId resource{};
  std::uint32_t count = 1;
  std::uint32_t members = 0;
  std::uint32_t first = kNone;  ///< the first member
};

/// A resource as declared. Its name may carry parameters: "process:planner(fast)".
struct ResourceRecord {
  ResourceClass kind = ResourceClass::Task;
  std::uint32_t count = 1;  ///< units at the beginning
  bool commutes = false;    ///< the order in which nodes use it does not matter
  bool varies = false;      ///< some node creates, consumes or deletes units
  bool grouped = false;     ///< some group lock holds it
  bool lent = false;        ///< its units are part of what group locks hold
  bool observed = false;    ///< a robot shows how many of the units can be had (ResourcePool::limit)
};

/// Resources, interned by name. Not thread safe; reading is, while nobody adds.
class ResourceTable {
 public:
  /// The resource of that name; a new one exists once, of the class that its prefix names
  /// ("process:planner").
  ResourceId intern(std::string_view name);
  [[nodiscard]] std::optional<ResourceId> find(std::string_view name) const;
  [[nodiscard]] const std::string& name(ResourceId id) const { return names_.name(index(id)); }
  [[nodiscard]] const ResourceRecord& operator[](ResourceId id) const { return resources_[index(id)]; }
  [[nodiscard]] ResourceRecord& operator[](ResourceId id) { return resources_[index(id)]; }
  [[nodiscard]] std::size_t size() const { return resources_.size(); }

 private:
  NameTable names_;
  std::vector<ResourceRecord> resources_;
};

}  // namespace segue::task_network
