// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/robot_request.hpp>
#include <segue/model/ids.hpp>

#include <cstdint>
#include <string>
#include <string_view>

/// Options of a request beside its network, and its progress.
namespace segue::runtime {

using control::PropertySetting;
using control::RequestOptions;
using control::Sender;

/// A request that has not ended.
struct OpenRequest {
  std::uint64_t request = 0;
  model::NetworkName to;
  std::string who;
  std::string_view state;    ///< "waiting", "planning", "prepare", "commit", "retire", "undo"
  std::string cancelled_by;  ///< empty: nobody
};

}  // namespace segue::runtime
