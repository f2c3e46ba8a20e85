// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/type.hpp>
#include <segue/type/type_info.hpp>
#include <segue/type/value.hpp>

#include <map>
#include <string>

/// Types that are known at run time only, such as those of messages of ROS 2: ports and properties handle
/// their objects as those of described C++ types.
namespace segue::type {

/// The TypeInfo of a compound, number, enum, text, vector or array of these, or a compound with such members.
/// Where the process has a type of that name (a C++ type, or one made earlier), it is that one. Objects lie
/// in memory as those of the C++ struct with the same members (memory_layout.hpp), so that both can be
/// connected. `defaults`, by the name of a compound: a map of its members' default values where they are not
/// zero or empty; a type that was made earlier keeps those that it had. TypeMismatch where the process has
/// the name with another structure or a default does not fit, Unsupported for other kinds, for a type that
/// contains itself, and for members that do not lie as C++ places them. Thread safe.
Result<const TypeInfo*> make_type_info(const Type& type, const std::map<std::string, Value>& defaults = {});

}  // namespace segue::type
