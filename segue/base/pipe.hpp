// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>
#include <segue/base/wait.hpp>

#include <cstddef>
#include <limits>
#include <string>

namespace segue {

/// Both ends of a pipe, close-on-exec.
struct Pipe {
  Descriptor read;
  Descriptor write;
};

/// IoError or ResourceExhausted where the system makes none.
Result<Pipe> make_pipe();

/// All that comes until nobody can write to it any more. DeadlineExceeded, or Cancelled where it is not
/// wanted any longer; ResourceExhausted where more than `most` bytes come; else the error of the system.
Result<std::string> read_to_end(const Descriptor& source, const Wait& wait,
                                std::size_t most = std::numeric_limits<std::size_t>::max());

}  // namespace segue
