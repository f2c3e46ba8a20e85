// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/type/type.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace segue::type {

/// A typelib registry (.tlb, XML): numerics, enums, compounds, containers, opaques, aliases, null; arrays and
/// pointers by name; forward references and arrays of size 0 as they occur in real files. /std/string may be
/// declared as an opaque or null, and containers without their size, as in old files. All problems are
/// reported at once; nothing is returned where there are errors.
std::optional<TypeRegistry> read_typelib(std::string_view text, const std::string& file,
                                         Diagnostics& diagnostics);
std::optional<TypeRegistry> load_typelib(const std::filesystem::path& file, Diagnostics& diagnostics);

}  // namespace segue::type
