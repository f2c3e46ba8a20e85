// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/network.hpp>
#include <segue/model/reader.hpp>

#include <string>

/// Rock's component network definition (CND). Internal.
namespace segue::model::detail {

/// Told by the keys of its entries; where there are none, by the name of the file.
bool is_cnd(const type::Value& root, const std::string& file);
Network read_cnd(const type::Value& root, const Source& source);

}  // namespace segue::model::detail
