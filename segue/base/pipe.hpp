// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>

namespace segue {

/// Both ends of a pipe, close-on-exec.
struct Pipe {
  Descriptor read;
  Descriptor write;
};

/// IoError or ResourceExhausted where the system makes none.
Result<Pipe> make_pipe();

}  // namespace segue
