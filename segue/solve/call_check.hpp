// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/transition.hpp>
#include <segue/type/type.hpp>

namespace segue::solve::detail {

/// Whether a task of this component can be called so: it has the operation, and gets each argument, of its
/// type, by name or in order. Where the model says that it is incomplete, it may lack operations. Fails
/// (InvalidArgument) with the first problem.
Result<> check_call(const model::CallAction& call, const model::ComponentModel& component,
                    const type::TypeRegistry& types);

}  // namespace segue::solve::detail
