// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace segue {

/// The text as the content or a quoted attribute of an element of XML or HTML; control characters become
/// blanks, but line feeds stay.
std::string escape_markup(std::string_view text);

}  // namespace segue
