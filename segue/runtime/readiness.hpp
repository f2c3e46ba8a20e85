// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/ids.hpp>

#include <cstddef>
#include <string>

namespace segue::runtime {

/// How far a standby controller is prepared.
struct Readiness {
  model::NetworkName controller;
  bool ready = false;        ///< prepared as far as the running controller permits
  std::size_t prepared = 0;  ///< number of its tasks that are configured, running ones included
  std::size_t tasks = 0;
  std::string reason;  ///< why it is not ready
};

}  // namespace segue::runtime
