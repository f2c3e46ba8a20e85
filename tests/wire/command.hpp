// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "wire/frame_queue.hpp"

namespace segue::wire {

/// Does what one line says, and answers `ok`, or `error: ...` and has changed nothing. A line is one or
/// several settings and, last, the directions that they are for; without these, they are for all:
///
///     delay 20ms jitter 5ms loss 5% duplicate 1% reorder 25% 2ms a>b
///     cut a>*
///     heal
///     clear a<>b
///     count
///
/// `reorder SHARE TIME` holds back that share of frames by a further time. `cut` loses everything, `heal`
/// ends that, `clear` ends every impairment. Times are in us, ms or s. `count` is answered with a line for
/// each direction.
std::string obey(FrameQueue& queue, const std::vector<std::string>& stations, std::string_view line);

}  // namespace segue::wire
