// SPDX-License-Identifier: Apache-2.0
#include <segue/base/diagnostic.hpp>

#include <gtest/gtest.h>

#include <string_view>
#include <utility>
#include <vector>

namespace segue {
namespace {

TEST(Error, PrintsPlaceSubjectAndCause) {
  const Error error = fail(ErrorCode::HookFailed, "cannot configure", "camera", {"a.yaml", 3, 5})
                          .because_of(fail(ErrorCode::NotFound, "no such device"));
  EXPECT_EQ(to_string(error), "a.yaml:3:5: camera: cannot configure (no such device)");
}

TEST(Error, EveryCodeHasTheNameThatToolsKnow) {
  using enum ErrorCode;
  const std::vector<std::pair<ErrorCode, std::string_view>> names = {
      {InvalidArgument, "invalid-argument"},
      {NotFound, "not-found"},
      {AlreadyExists, "already-exists"},
      {ParseError, "parse-error"},
      {TypeMismatch, "type-mismatch"},
      {InvalidState, "invalid-state"},
      {Unsupported, "unsupported"},
      {PermissionDenied, "permission-denied"},
      {ResourceExhausted, "resource-exhausted"},
      {DeadlineExceeded, "deadline-exceeded"},
      {Cancelled, "cancelled"},
      {Superseded, "superseded"},
      {Unavailable, "unavailable"},
      {IoError, "io-error"},
      {HookFailed, "hook-failed"},
      {Internal, "internal"},
  };
  for (const auto& [code, name] : names)
    EXPECT_EQ(to_string(code), name);
  EXPECT_EQ(names.size(), static_cast<std::size_t>(Internal) + 1) << "a code is missing here";
}

TEST(Diagnostics, CountsErrorsButNotWarnings) {
  Diagnostics diagnostics;
  diagnostics.warning("odd", "looks odd");
  EXPECT_FALSE(diagnostics.has_errors());
  diagnostics.error("bad", "is bad");
  EXPECT_EQ(diagnostics.error_count(), 1u);
  EXPECT_EQ(diagnostics.items().size(), 2u);
}

TEST(Diagnostics, SortPutsFindingsInTheOrderOfTheFileAndPlacelessOnesLast) {
  Diagnostics diagnostics;
  diagnostics.error("c", "no place");
  diagnostics.error("b", "second", {"f.yaml", 9, 1});
  diagnostics.error("a", "first", {"f.yaml", 2, 7});
  diagnostics.sort();
  EXPECT_EQ(diagnostics.items()[0].code, "a");
  EXPECT_EQ(diagnostics.items()[1].code, "b");
  EXPECT_EQ(diagnostics.items()[2].code, "c");
}

TEST(Diagnostics, AsOneErrorTellsHowManyMoreThereAre) {
  Diagnostics diagnostics;
  diagnostics.warning("w", "never the first error");
  diagnostics.error("a", "unknown task", {"f.yaml", 2, 7});
  diagnostics.error("b", "unknown port");
  EXPECT_EQ(to_string(diagnostics.to_error()), "f.yaml:2:7: unknown task (and 1 more)");
}

TEST(Diagnostics, AreCarriedByTheErrorThatTheyBecome) {
  Diagnostics diagnostics;
  diagnostics.warning("w", "looks odd");
  diagnostics.error("a", "unknown task", {"f.yaml", 2, 7});
  EXPECT_EQ(diagnostics_of(diagnostics.to_error()).items(), diagnostics.items());
}

TEST(Diagnostics, OfAnErrorThatCarriesNoneAreThatError) {
  const Error error = fail(ErrorCode::IoError, "cannot read", {}, {"f.yaml", 2, 7})
                          .because_of(fail(ErrorCode::NotFound, "no such file"));
  EXPECT_EQ(to_string(diagnostics_of(error)), "f.yaml:2:7: error: cannot read (no such file) [io-error]\n");
}

}  // namespace
}  // namespace segue
