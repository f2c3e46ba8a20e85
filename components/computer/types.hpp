// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/describe.hpp>

namespace computer {

/// How busy a computer is.
struct Load {
  double processors = 0;  ///< that are switched on
  double free_processors =
      0;              ///< that were idle in the last period, on average: 1.5 of 2 are busy a quarter of it
  double memory = 0;  ///< bytes
  double free_memory = 0;  ///< bytes that programs can have without swapping
};

SEGUE_TYPE(Load, processors, free_processors, memory, free_memory)

}  // namespace computer
