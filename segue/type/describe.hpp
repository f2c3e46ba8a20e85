// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Descriptions of C++ types: one's own (SEGUE_TYPE), and those of the language and the standard library.
#include <segue/type/describe_own.hpp>
#include <segue/type/describe_standard.hpp>
