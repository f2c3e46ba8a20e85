// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/declared_data.hpp>
#include <segue/mission/world_view.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace segue::mission {

struct Mission;

/// Data that follow the facts of a run by functions in Python. Changes of facts are only noted, in constant
/// time; a script that looks at the data has them computed, in its own process, from the last computed value.
/// So the engine never waits for a process, a process that ends takes no data along, and a prediction that
/// was wrong is forgotten with its notes. Copies share the notes that they have in common, and what was
/// computed of them.
class ScriptedData final : public WorldData {
 public:
  /// The functions, and the script that has them.
  struct Functions {
    DeclaredData declared;
    std::filesystem::path file;  ///< of the script, or where its text stands
  };
  struct Change {
    std::string fact;  ///< "holding(box)"
    bool holds = false;
  };
  /// A change after all those before it; null: none.
  struct Step;
  using StepPtr = std::shared_ptr<const Step>;
  /// The next computation: `changes`, oldest first, made to `base`.
  struct Task {
    std::shared_ptr<const type::Value> base;
    std::vector<Change> changes;
    StepPtr until;         ///< the last of the changes; null: there are none
    bool is_last = false;  ///< the data are up to date then
  };

  explicit ScriptedData(std::shared_ptr<const Functions> functions);
  ~ScriptedData() override;
  ScriptedData(const ScriptedData& other);
  ScriptedData& operator=(const ScriptedData&) = delete;

  [[nodiscard]] std::shared_ptr<WorldData> clone() const override;
  /// Notes the change if there is a function for it.
  void changed(const std::string& fact, bool holds) override;

  [[nodiscard]] const Functions& functions() const { return *functions_; }
  /// The next changes to compute, `most` at most. From any thread, also while others note changes in copies.
  [[nodiscard]] Task next(std::size_t most) const;
  /// The outcome of a task; the changes that led to it are forgotten. From any thread.
  void computed(const Task& task, type::Value value) const;

 private:
  const std::shared_ptr<const Functions> functions_;
  const std::shared_ptr<Mutex> mutex_;  ///< of all copies; protects what steps have been computed to
  const std::shared_ptr<const type::Value> initial_;
  StepPtr last_;
};

/// Adds the data that the mission declares. InvalidArgument where something of that name is attached already.
[[nodiscard]] Result<void> attach_declared(const Mission& mission, AttachedData& data);

}  // namespace segue::mission
