// SPDX-License-Identifier: Apache-2.0
#include <segue/base/diagnostic.hpp>

#include <algorithm>
#include <memory>
#include <tuple>
#include <utility>

namespace segue {

std::string_view to_string(Severity severity) {
  switch (severity) {
    case Severity::Hint:
      return "hint";
    case Severity::Warning:
      return "warning";
    case Severity::Error:
      break;
  }
  return "error";
}

std::string to_string(const Diagnostic& diagnostic) {
  std::string text;
  if (diagnostic.where.known()) text += to_string(diagnostic.where) + ": ";
  text += std::string(to_string(diagnostic.severity)) + ": " + diagnostic.message;
  if (!diagnostic.code.empty()) text += " [" + diagnostic.code + "]";
  return text;
}

void Diagnostics::error(std::string code, std::string message, SourceLocation where) {
  add({Severity::Error, std::move(code), std::move(message), std::move(where)});
}

void Diagnostics::warning(std::string code, std::string message, SourceLocation where) {
  add({Severity::Warning, std::move(code), std::move(message), std::move(where)});
}

void Diagnostics::add(Diagnostic diagnostic) {
  if (diagnostic.severity == Severity::Error) ++errors_;
  items_.push_back(std::move(diagnostic));
}

void Diagnostics::append(const Diagnostics& other) {
  for (const Diagnostic& item : other.items_)
    add(item);
}

void Diagnostics::sort() {
  auto key = [](const Diagnostic& d) {
    return std::tuple(!d.where.known(), std::string_view(d.where.file), d.where.line, d.where.column);
  };
  std::ranges::stable_sort(items_, [&](const auto& a, const auto& b) { return key(a) < key(b); });
}

Error Diagnostics::to_error(ErrorCode code) const {
  auto first = std::ranges::find(items_, Severity::Error, &Diagnostic::severity);
  if (first == items_.end()) return fail(ErrorCode::Internal, "to_error() without an error");
  std::string message = first->message;
  if (errors_ > 1) message += " (and " + std::to_string(errors_ - 1) + " more)";
  return Error{
      code, std::move(message), first->where, {}, nullptr, std::make_shared<const Diagnostics>(*this)};
}

std::string to_string(const Diagnostics& diagnostics) {
  std::string text;
  for (const Diagnostic& item : diagnostics.items())
    text += to_string(item) + '\n';
  return text;
}

Diagnostics diagnostics_of(const Error& error) {
  if (error.diagnostics != nullptr) return *error.diagnostics;
  Error said = error;
  said.where = {};  // in its own field
  Diagnostics diagnostics;
  diagnostics.error(std::string(to_string(error.code)), to_string(said), error.where);
  return diagnostics;
}

}  // namespace segue
