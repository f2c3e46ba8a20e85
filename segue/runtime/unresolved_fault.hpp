// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/ids.hpp>

#include <optional>
#include <string>
#include <vector>

namespace segue::runtime {

/// A part of what should run that does not, or something that should not and does, after as many attempts to
/// mend it as the policies permit, which may be none.
struct UnresolvedFault {
  std::string sentence;
  /// The running controllers that lack the part; none: something is left over.
  std::vector<model::NetworkName> controllers{};
  std::optional<model::TaskId> task{};  ///< that is not in its state, while its process runs
};

}  // namespace segue::runtime
