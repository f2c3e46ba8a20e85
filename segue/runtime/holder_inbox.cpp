// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/holder_inbox.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

namespace segue::runtime::detail {

namespace {

using type::Value;

/// Bytes.
constexpr std::size_t kLongestPath = 1024;

bool is_path(const Value* value) {
  return value != nullptr && value->is_string() && value->as_string().size() <= kLongestPath;
}

bool are_paths(const Value* value) {
  return value != nullptr && value->is_list() && value->as_list().size() <= HolderInbox::kMostBreakpoints &&
         std::ranges::all_of(value->as_list(), [](const Value& one) { return is_path(&one); });
}

bool is_step(const Value* value) {
  static constexpr std::array<std::string_view, 4> kSteps = {"into", "over", "out", "back"};
  return is_path(value) && std::ranges::find(kSteps, value->as_string()) != kSteps.end();
}

/// A question that a holder can be asked.
struct Question {
  std::string_view what;
  int latest_of;  ///< of those with the same number the latest counts; 0: each counts
  std::string_view argument{};
  bool (*fits)(const Value*) = nullptr;
  std::string_view shape{};
};

constexpr std::array<Question, 7> kQuestions = {{
    {"pause", 1},
    {"resume", 1},
    {"stop", 1},
    {"step", 0, "how", is_step, "'into', 'over', 'out' or 'back'"},
    {"break", 2, "at", are_paths, "a list of 200 paths at most"},
    {"go_on_at", 0, "at", is_path, "a path"},
    {"values", 3, "of", is_path, "a path"},
}};

}  // namespace

Result<std::uint64_t> HolderInbox::put(std::string_view what, const Value& arguments) {
  const auto* question = std::ranges::find(kQuestions, what, &Question::what);
  if (question == kQuestions.end()) {
    std::vector<std::string> known;
    for (const Question& one : kQuestions)
      known.emplace_back(one.what);
    return fail(ErrorCode::InvalidArgument,
                "whoever commands the robot can be asked for " + listed(known) + ", not for " + quote(what));
  }
  const bool takes_argument = question->fits != nullptr;
  const Value* argument = takes_argument && arguments.is_map() ? arguments.find(question->argument) : nullptr;
  if (takes_argument && !question->fits(argument)) {
    return fail(ErrorCode::InvalidArgument,
                quote(what) + " needs " + quote(question->argument) + ": " + std::string(question->shape));
  }
  std::erase_if(waiting_, [&](const control::HolderRequest& one) {
    const auto* other = std::ranges::find(kQuestions, one.what, &Question::what);
    return question->latest_of != 0 && other->latest_of == question->latest_of;
  });
  if (waiting_.size() >= kMostWaiting) {
    return fail(ErrorCode::ResourceExhausted,
                "whoever commands the robot has not heard what it was asked before");
  }
  Value kept = argument == nullptr ? Value() : Value::map({{std::string(question->argument), *argument}});
  waiting_.push_back({++asked_, std::string(what), std::move(kept)});
  return asked_;
}

std::vector<control::HolderRequest> HolderInbox::take() {
  return std::exchange(waiting_, {});
}

}  // namespace segue::runtime::detail
