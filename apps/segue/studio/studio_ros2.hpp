// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/base/wait.hpp>
#include <segue/type/value.hpp>
#include <segue/web/ros2_looks.hpp>

namespace segue::cli {

/// As of web::LookAtRos2, by the program that `segue ros2` starts.
Result<type::Value> look_for_pages(const web::Ros2Place& place, const Wait& wait);

/// A look as pages get it: each node with its "text" as a task, and of its process "program" in place of the
/// command line, which may have secrets.
void prepare_for_pages(type::Value& seen);

}  // namespace segue::cli
