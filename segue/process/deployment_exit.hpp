// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace segue::process {

/// How the program segue-deployment ends. The last line of its log says more.
enum DeploymentExit : int {
  kOrderly = 0,       ///< it was asked to go
  kWrongUse = 2,      ///< it was started by hand, or handed nonsense
  kNotPermitted = 3,  ///< the system does not permit its scheduler, processors or limits
  kNoLibrary = 4,     ///< a component library, a model or the stand-in file cannot be loaded
  kNoMemory = 5,      ///< no shared memory, or no socket to serve
  kHanging = 6,       ///< asked to go, it went although a hook of a task had not returned
  kDefect = 70        ///< of Segue
};

}  // namespace segue::process
