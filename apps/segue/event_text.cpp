// SPDX-License-Identifier: Apache-2.0
#include "event_text.hpp"

#include <fmt/core.h>

#include "output.hpp"

namespace segue::cli {

namespace {

Colour colour_of(const std::string& kind) {
  if (kind.find("failed") != std::string::npos || kind.find("refused") != std::string::npos)
    return Colour::Red;
  if (kind.find("difference") != std::string::npos || kind.find("superseded") != std::string::npos) {
    return Colour::Yellow;
  }
  return kind.find("done") != std::string::npos ? Colour::Green : Colour::Blue;
}

}  // namespace

std::string event_line(const type::Value& event) {
  const std::string kind = text_at(event, "kind");
  const std::string subject = text_at(event, "subject");
  const std::string message = text_at(event, "message");
  const std::string separator = subject.empty() || message.empty() ? "" : ": ";
  return fmt::format("{:>5} {} {} {}{}{}", number_at(event, "number"),
                     coloured(Colour::Dim, text_at(event, "time")),
                     coloured(colour_of(kind), fmt::format("{:<20}", kind)), subject, separator, message);
}

}  // namespace segue::cli
