// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/mission/globals.hpp>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace segue::mission::detail {

/// The objects of one Python process that global variables hold. The process itself has them, by number; it
/// is told which ones no variable holds any more. Thread safe; nothing blocks.
class ScriptObjects {
 public:
  /// The content of a variable that refers to the object which the process keeps under `number`, and that
  /// shows `shown`.
  static std::shared_ptr<const GlobalObject> hold(const std::shared_ptr<ScriptObjects>& objects,
                                                  std::uint64_t number, type::Value shown);
  /// Nothing if the object is none of this process, or if the process has ended.
  [[nodiscard]] std::optional<std::uint64_t> number_of(const GlobalObject& object) const;
  /// Sets the value that an object shows from now on. No effect if no variable holds it.
  void show(std::uint64_t number, type::Value shown);
  /// The numbers of objects that no variable holds any more, since the last call.
  std::vector<std::uint64_t> take_released();
  /// The process has ended, and with it all objects.
  void end();

 private:
  class Held;

  mutable Mutex mutex_;  ///< guards all
  std::map<std::uint64_t, type::Value> shown_ SEGUE_GUARDED_BY(mutex_);
  std::vector<std::uint64_t> released_ SEGUE_GUARDED_BY(mutex_);
  bool ended_ SEGUE_GUARDED_BY(mutex_) = false;
};

}  // namespace segue::mission::detail
