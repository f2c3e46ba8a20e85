// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace segue {

/// Sanitizers make everything many times slower: tests that try many random cases try a part of them there,
/// and all of them in the release build of a night.
#if defined(SEGUE_SANITIZER_ADDRESS) || defined(SEGUE_SANITIZER_THREAD)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace segue
