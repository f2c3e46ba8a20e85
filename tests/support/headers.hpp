// SPDX-License-Identifier: Apache-2.0
#pragma once

// What most test programs include, precompiled for them (cmake/SegueTargets.cmake). Tests name what they use
// themselves, too: a build without it, and without unity, is a stage of `tools/test nightly`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>
