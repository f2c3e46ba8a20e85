// SPDX-License-Identifier: Apache-2.0
//
// Repetition for SEGUE_TYPE. Not for users.
#pragma once

/// Scans its arguments again, often enough for 64 repetitions of SEGUE_DETAIL_STEP.
#define SEGUE_DETAIL_SCAN(...) \
  SEGUE_DETAIL_SCAN_4(SEGUE_DETAIL_SCAN_4(SEGUE_DETAIL_SCAN_4(SEGUE_DETAIL_SCAN_4(__VA_ARGS__))))
#define SEGUE_DETAIL_SCAN_4(...) \
  SEGUE_DETAIL_SCAN_3(SEGUE_DETAIL_SCAN_3(SEGUE_DETAIL_SCAN_3(SEGUE_DETAIL_SCAN_3(__VA_ARGS__))))
#define SEGUE_DETAIL_SCAN_3(...) \
  SEGUE_DETAIL_SCAN_2(SEGUE_DETAIL_SCAN_2(SEGUE_DETAIL_SCAN_2(SEGUE_DETAIL_SCAN_2(__VA_ARGS__))))
#define SEGUE_DETAIL_SCAN_2(...) __VA_ARGS__

#define SEGUE_DETAIL_PARENTHESES ()

/// use(a) use(b) use(c) for (a, b, c).
#define SEGUE_DETAIL_EACH(use, ...) __VA_OPT__(SEGUE_DETAIL_SCAN(SEGUE_DETAIL_STEP(use, __VA_ARGS__)))
#define SEGUE_DETAIL_STEP(use, first, ...) \
  use(first) __VA_OPT__(SEGUE_DETAIL_STEP_AGAIN SEGUE_DETAIL_PARENTHESES(use, __VA_ARGS__))
#define SEGUE_DETAIL_STEP_AGAIN() SEGUE_DETAIL_STEP
