// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/mission/mission.hpp>
#include <segue/mission_script/script_runner.hpp>

#include <memory>

namespace segue::mission {

/// Has an interpreter compile the Python texts of missions, without executing them. It is started with the
/// first script and kept for the next mission. For one thread, which must outlive this.
class ScriptCompiler {
 public:
  explicit ScriptCompiler(ScriptOptions options = {});
  ~ScriptCompiler();
  ScriptCompiler(const ScriptCompiler&) = delete;
  ScriptCompiler& operator=(const ScriptCompiler&) = delete;

  /// Reports each text that is not Python (`bad-script`) with file, line and column. The warning `no-python`,
  /// once, where there is no interpreter or where it does not answer within ten seconds. Files that cannot be
  /// read are left out. Blocks.
  void check(const Mission& mission, Diagnostics& diagnostics);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace segue::mission
